//! From the grid to the points: what FLIP, APIC and XPIC(m) keep.

mod support;

use rmpm::{
    sim::Simulation,
    space::{BSpline, Grid, Linear, Shape, Stencil, stencil::LANES},
};

const DISC: &str = include_str!("../validation/rigid/case.toml");

/// A disc that is free of stress, with the keys.
fn disc(keys: &[&str]) -> (Simulation, Grid) {
    let scene = support::scene(DISC, &[&["region.disc.velocity=[0.3, -0.2]", "points.layout=even"], keys].concat());
    (scene.simulation, scene.grid)
}

/// Velocities in (-1, 1) that look random.
fn shake(sim: &mut Simulation) {
    for (axis, column) in sim.body.committed.v.iter_mut().enumerate() {
        let noise = |i: usize| 2.0 * ((i as f64 * 12.9898 + 4.1 * axis as f64).sin() * 43_758.545).fract().abs() - 1.0;
        column.iter_mut().enumerate().for_each(|(i, v)| *v = noise(i));
    }
}

/// Weights of each point: (node, N).
fn weights<S: Shape<N>, const N: usize>(sim: &Simulation, grid: &Grid) -> Vec<Vec<(usize, f64)>> {
    let x = &sim.body.committed.x;
    let of = |i: usize| {
        let mut s = Box::<Stencil<N>>::default();
        S::fill(grid, &[x[0][i]; LANES], &[x[1][i]; LANES], &[[0.0; LANES]; 2], &mut s);
        let nodes = S::offsets(grid.row()).map(|o| (s.base[0] + o) as usize);
        (0..N).map(|k| (nodes[k], s.weight(k, 0))).collect()
    };
    (0..sim.body.len()).map(of).collect()
}

/// S S+ V: to the nodes by mass, and back.
fn there_and_back(sim: &Simulation, weights: &[Vec<(usize, f64)>], nodes: usize, v: &[f64]) -> Vec<f64> {
    let (mut mass, mut momentum) = (vec![0.0; nodes], vec![0.0; nodes]);
    for (p, near) in weights.iter().enumerate() {
        for &(i, w) in near {
            mass[i] += w * sim.body.mass[p];
            momentum[i] += w * sim.body.mass[p] * v[p];
        }
    }
    let at = |&(i, w): &(usize, f64)| if w > 0.0 { w * momentum[i] / mass[i] } else { 0.0 };
    weights.iter().map(|near| near.iter().map(at).sum()).collect()
}

/// Without stress a step is V' = (I - (I - S S+)^m) V, to the letter of Hammerquist & Nairn.
fn filtered<S: Shape<N>, const N: usize>(order: u32) -> f64 {
    let keys = [format!("solver.shape={}", S::NAME), format!("solver.xpic_order={order}")];
    let set = ["solver.transfer=xpic", "explicit.time_step=1e-9", &keys[0], &keys[1]];
    let (mut sim, grid) = disc(&set);
    shake(&mut sim);
    let near = weights::<S, N>(&sim, &grid);
    let before = [0, 1].map(|a| sim.body.committed.v[a].to_vec());
    let exact = before.map(|v| {
        let mut rest = v.clone();
        for _ in 0..order {
            let seen = there_and_back(&sim, &near, grid.nodes(), &rest);
            rest.iter_mut().zip(seen).for_each(|(r, s)| *r -= s);
        }
        v.iter().zip(rest).map(|(v, r)| v - r).collect::<Vec<_>>()
    });
    support::advance(&mut sim, 1);
    let gap = |a: usize| sim.body.committed.v[a].iter().zip(&exact[a]).map(|(v, e)| (v - e).abs()).fold(0.0, f64::max);
    gap(0).max(gap(1))
}

/// Rounding of some ten maps, each of a hundred terms.
#[test]
fn xpic_is_its_formula() {
    for order in [1, 2, 5, 10] {
        let gaps = [filtered::<Linear, 4>(order), filtered::<BSpline, 9>(order)];
        assert!(gaps.iter().all(|g| *g < 1e-13), "{order}: {gaps:?}");
    }
}

#[test]
fn xpic_of_order_one_is_pic() {
    let run = |keys: &[&str]| {
        let (mut sim, _) = disc(keys);
        shake(&mut sim);
        support::advance(&mut sim, 50);
        sim.snapshot().velocity
    };
    let xpic = run(&["solver.transfer=xpic", "solver.xpic_order=1"]);
    let pic = run(&["explicit.pic_rate=1e6"]);
    let gap = xpic.iter().zip(&pic).flat_map(|(a, b)| [0, 1].map(|k| (a[k] - b[k]).abs())).fold(0.0, f64::max);
    // rounding of 50 steps that damp
    assert!(gap < 1e-12, "{gap:e}");
}

/// A spinning disc: angular momentum with the affine part, which for splines away from the sides is
/// (C_yx - C_xy) h^2 / 4 a point; and the largest relative change over the steps.
fn angular_drift(keys: &[&str], steps: usize) -> f64 {
    let spin = "region.disc.spin={ rate = 1.0, center = [0.0, 0.0] }";
    let (mut sim, grid) = disc(&[&[spin], keys].concat());
    let momentum = |sim: &Simulation| -> f64 {
        let (m, s) = (&sim.body.mass, &sim.body.committed);
        let of = |i: usize| {
            let spin = s.affine.get(2).map_or(0.0, |yx| yx[i] - s.affine[1][i]);
            m[i] * (s.x[0][i] * s.v[1][i] - s.x[1][i] * s.v[0][i] + 0.25 * grid.h * grid.h * spin)
        };
        (0..m.len()).map(of).sum()
    };
    let (start, mut drift) = (momentum(&sim), 0.0f64);
    for _ in 0..steps {
        support::advance(&mut sim, 1);
        drift = drift.max((momentum(&sim) / start - 1.0).abs());
    }
    drift
}

/// Internal forces have no moment (the mass floor, which withholds some of them, is off), and what points take from the nodes is what they give back: rounding,
/// with MUSL too, whose second map goes nowhere but into the strain. PIC loses.
#[test]
fn apic_keeps_angular_momentum_with_splines() {
    let shape = "solver.shape=bspline";
    for update in ["explicit.stress_update=usl", "explicit.stress_update=musl"] {
        // 400 steps of sums over 10^3 points
        let apic = angular_drift(&[shape, update, "solver.transfer=apic", "explicit.mass_floor=0"], 400);
        assert!(apic < 1e-12, "{update}: {apic:e}");
    }
    let pic = angular_drift(&[shape, "solver.transfer=xpic", "solver.xpic_order=1"], 400);
    assert!(pic > 1e-3, "{pic:e}");
}

/// A field that is linear in space goes to the nodes and back whole; FLIP without PIC leaves it to the points.
#[test]
fn apic_reproduces_a_linear_field() {
    for shape in ["linear", "gimp", "bspline"] {
        let spin = "region.disc.spin={ rate = 1.0, center = [0.0, 0.0] }";
        let keys = [spin, "solver.transfer=apic", "explicit.time_step=1e-9", &format!("solver.shape={shape}")];
        let (mut sim, _) = disc(&keys);
        let before = sim.snapshot();
        support::advance(&mut sim, 1);
        let after = sim.snapshot();
        let gap = |i: usize| (0..2).map(|a| (after.velocity[i][a] - before.velocity[i][a]).abs()).fold(0.0, f64::max);
        // points within 1e-10 cells of a node count as there
        assert!((0..after.len()).all(|i| gap(i) < 1e-9), "{shape}");
    }
}

/// Free bodies keep their momentum in the implicit scheme too, whatever the transfer, and a disc that flies
/// keeps its velocity at every point.
#[test]
fn implicit_steps_carry_momentum() {
    for (transfer, shape) in [("apic", "linear"), ("apic", "bspline"), ("xpic", "gimp"), ("xpic", "linear")] {
        let keys = [
            "solver.scheme=implicit",
            "implicit.regime=newmark",
            "implicit.time_step=0.02",
            &format!("solver.transfer={transfer}"),
            &format!("solver.shape={shape}"),
        ];
        let (mut sim, _) = disc(&keys);
        support::advance(&mut sim, 20);
        let flat = sim.snapshot().velocity;
        // the residual of Newton's method is 1e-9 of the forces, which are rounding
        assert!(flat.iter().all(|v| (v[0] - 0.3).abs() < 1e-9 && (v[1] + 0.2).abs() < 1e-9), "{transfer} {shape}");
        shake(&mut sim);
        let before = sim.body.momentum();
        support::advance(&mut sim, 20);
        let (after, scale) = (sim.body.momentum(), sim.initial_mass);
        assert!(
            (0..2).all(|a| (after[a] - before[a]).abs() < 1e-7 * scale),
            "{transfer} {shape}: {before:?} {after:?}"
        );
    }
}
