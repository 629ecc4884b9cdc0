//! The penalty against its definition.

use super::*;
use crate::{
    block::PointLaw,
    body::{GroupSeed, Seedling},
    effect::{Inertia, TimeScheme},
    kinematics::{Hencky, StrengthMeasure},
    material::{Columns, Elastic, Elasticity},
};

const YOUNG: f64 = 1000.0;
const H: f64 = 0.5;
const CLOCK: Clock = Clock { time: 0.0, dt: 0.1 };

fn noise(k: usize) -> f64 {
    2.0 * ((k as f64 * 12.9898 + 4.1).sin() * 43758.5453).fract().abs() - 1.0
}

/// A penalty (0.3, 0.2) on a body with one point in each of some cells; density 2 t/m3.
struct Scene {
    ghost: Ghost,
    nodes: Nodes,
    system: System,
}

impl Scene {
    fn new(cells: [u32; 2], filled: &[[u32; 2]]) -> Self {
        let grid = Grid { origin: [1.0, -2.0], h: H, cells };
        let point = |&[x, y]: &[u32; 2]| Seedling {
            x: [1.0 + H * (f64::from(x) + 0.5), -2.0 + H * (f64::from(y) + 0.5)],
            mass: 0.5,
            volume: 0.25,
            ..Seedling::default()
        };
        let elasticity = Elasticity::from_young(YOUNG, 0.3);
        let mut params = vec![Column::Uniform(0.0); 2];
        elasticity.write(|k, v| params[k] = Column::Uniform(v));
        let law = Box::new(PointLaw::<Elastic, Hencky>::new(Elastic, StrengthMeasure::Cauchy));
        let points = filled.iter().map(point).collect();
        let body = Body::new(vec![GroupSeed { material: 0, law, params, points }]);
        let mut s = Scene { ghost: Ghost::new(0.3, 0.2), nodes: Nodes::new(grid), system: System::default() };
        let row = grid.row();
        for [x, y] in filled {
            s.nodes.patch(y * row + x, &[0, 1, row, row + 1]);
        }
        s.system.begin(s.nodes.count);
        s.ghost.couple(&body, &s.nodes, &mut s.system);
        s.system.adopt(row, &s.nodes.id[..s.nodes.count], true);
        s
    }

    fn block(n: u32) -> Self {
        let filled: Vec<_> = (0..n * n).map(|k| [1 + k % n, 1 + k / n]).collect();
        Scene::new([n + 2; 2], &filled)
    }

    fn set(&mut self, du: impl Fn(usize, usize, [f64; 2]) -> f64) {
        for slot in 0..self.nodes.count {
            let x = self.nodes.grid.node_position(self.nodes.id[slot]);
            (0..2).for_each(|axis| self.system.du[axis][slot] = du(axis, slot, x));
        }
    }

    /// Residual by rank and axis, and the dense tangent.
    fn equations(&mut self, motion: Option<Motion<'_>>) -> (Vec<f64>, Vec<Vec<f64>>) {
        self.system.clear(true);
        self.ghost.residual(&self.nodes, CLOCK, motion, &mut self.system);
        let (rhs, dense) = self.system.free_equations();
        (rhs.iter().map(|r| -r).collect(), dense)
    }
}

#[test]
fn faces_of_boundary_cells_and_no_others() {
    // 5 x 5 cells have 40 inner faces, 12 of which lie between two of the inner 3 x 3 cells
    assert_eq!(Scene::block(5).ghost.faces(), 28);
    // a full grid has no empty cell
    let all: Vec<_> = (0..9).map(|k| [k % 3, k / 3]).collect();
    assert_eq!(Scene::new([3, 3], &all).ghost.faces(), 0);
    // a hole has four cells around it
    let hole: Vec<_> = all.into_iter().filter(|c| *c != [1, 1]).collect();
    assert_eq!(Scene::new([3, 3], &hole).ghost.faces(), 8);
}

#[test]
fn a_linear_field_is_free_of_force() {
    let mut s = Scene::block(4);
    s.set(|axis, _, [x, y]| [0.3 + 0.2 * x - 0.1 * y, -0.2 + 0.4 * x + 0.7 * y][axis]);
    let (r, k) = s.equations(None);
    let largest = k.iter().flatten().fold(0.0, |a: f64, v| a.max(v.abs()));
    assert!(r.iter().all(|r| r.abs() < 1e-14 * largest), "{r:?}");
    // rows sum to zero on each axis: rigid motions, and by symmetry momentum
    for row in &k {
        for axis in 0..2 {
            assert!(row.iter().skip(axis).step_by(2).sum::<f64>().abs() < 1e-14 * largest);
        }
    }
}

#[test]
fn it_is_symmetric_and_nowhere_negative() {
    let mut s = Scene::block(4);
    let (_, k) = s.equations(None);
    let n = k.len();
    for r in 0..n {
        for c in 0..r {
            assert_eq!(k[r][c], k[c][r]);
        }
    }
    for trial in 0..50 {
        let x: Vec<f64> = (0..n).map(|i| noise(97 * trial + i)).collect();
        let product = |row: &Vec<f64>| row.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>();
        assert!(k.iter().zip(&x).map(|(row, x)| x * product(row)).sum::<f64>() > 0.0);
    }
}

/// One face: du . K du is the integral, taken by Gauss's rule from the gradients of the two cells.
#[test]
fn the_closed_form_is_the_integral() {
    for (axis, cells) in [[[1, 1], [2, 1]], [[1, 1], [1, 2]]].into_iter().enumerate() {
        let mut s = Scene::new([4, 4], &cells);
        assert_eq!(s.ghost.faces(), 1);
        s.set(|axis, slot, _| noise(17 * slot + axis));
        let (r, _) = s.equations(None);
        let mut integral = 0.0;
        let at = |component: usize, a: u32, b: u32| {
            let place = if axis == 0 { [1 + a, 1 + b] } else { [1 + b, 1 + a] };
            s.system.du[component][s.nodes.slot_at(place).expect("an active node") as usize]
        };
        for component in 0..2 {
            for t in [0.5 - 0.5 / 3f64.sqrt(), 0.5 + 0.5 / 3f64.sqrt()] {
                let along = |a: u32| (1.0 - t) * at(component, a, 0) + t * at(component, a, 1);
                let jump = (along(2) - along(1)) / H - (along(1) - along(0)) / H;
                integral += 0.5 * H * jump * jump;
            }
        }
        let mut energy = 0.0;
        for component in 0..2 {
            for slot in 0..s.nodes.count {
                energy += s.system.du[component][slot] * r[2 * s.system.pattern.rank(slot) + component];
            }
        }
        let exact = 0.3 * YOUNG * H / 3.0 * integral;
        assert!((energy / exact - 1.0).abs() < 1e-13, "{energy} {exact}");
    }
}

/// With velocities and increments that belong to one acceleration field a, the force is M a.
#[test]
fn the_mass_acts_on_the_acceleration() {
    let mut s = Scene::block(3);
    let w = TimeScheme::Newmark.weights(CLOCK.dt);
    let inertia = Inertia::new(TimeScheme::Newmark);
    let motion = Some(Motion { inertia: &inertia, weights: &w });
    s.ghost.faces.iter_mut().for_each(|f| f.stiffness = 0.0);
    s.set(|axis, slot, _| noise(3 * slot + axis));
    let (r, k) = s.equations(motion);
    let product = |row: &Vec<f64>| {
        let x = (0..s.nodes.count)
            .flat_map(|slot| [0, 1].map(|a| (2 * s.system.pattern.rank(slot) + a, s.system.du[a][slot])));
        x.map(|(column, x)| row[column] * x).sum::<f64>()
    };
    let largest = k.iter().flatten().fold(0.0, |a: f64, v| a.max(v.abs()));
    for (row, r) in k.iter().zip(&r) {
        assert!((product(row) - r).abs() < 1e-13 * largest);
    }
    // gamma_M rho h^2 / 3 c0 x the largest entry of s s m, that of a node on one face alone at least
    assert!(largest >= 0.2 * 2.0 * H * H / 3.0 * w.c0 * 4.0 / 3.0 * (1.0 - 1e-12));
    // a free flight at any velocity field is no acceleration
    for slot in 0..s.nodes.count {
        for axis in 0..2 {
            s.nodes.old_velocity[axis][slot] = noise(slot + 40 * axis);
            s.system.du[axis][slot] = CLOCK.dt * noise(slot + 40 * axis);
        }
    }
    let (r, _) = s.equations(motion);
    assert!(r.iter().all(|r| r.abs() < 1e-13 * largest));
}
