//! The material points: columns in cell order, one stretch per material.
//!
//! Committed and trial state are two things: a step reads the committed columns and writes the
//! trial columns, and [`Body::commit`] exchanges them. A step that fails leaves nothing behind.

pub mod part;

use std::ops::Range;

pub use part::Part;

use crate::{
    block::{Block, Law},
    fault::Fault,
    math::{strip::Strip, tensor::Voigt},
    snapshot::{Snapshot, Stage},
    space::{
        Grid,
        stencil::{LANES, Lane},
    },
};

/// What changes in a step, one entry a point.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// Position (m).
    pub x: [Strip; 2],
    /// Velocity (m/s).
    pub v: [Strip; 2],
    /// Elastic strain: xx, yy, zz, xy.
    pub strain: [Strip; 4],
    /// Current volume over initial volume.
    pub jacobian: Strip,
    /// History columns of the laws.
    pub history: Vec<Strip>,
    /// Acceleration (m/s2); no column unless a time scheme remembers it.
    pub acceleration: Vec<Strip>,
    /// Total deformation gradient: xx, xy, yx, yy; no column unless domains are tracked.
    pub deformation: Vec<Strip>,
    /// C, the gradient of the velocity that a point carries (1/s): xx, xy, yx, yy; no column unless the
    /// transfer is affine.
    pub affine: Vec<Strip>,
}

impl State {
    fn columns(&mut self) -> impl Iterator<Item = &mut Strip> {
        self.x
            .iter_mut()
            .chain(&mut self.v)
            .chain(&mut self.strain)
            .chain(std::iter::once(&mut self.jacobian))
            .chain(&mut self.history)
            .chain(&mut self.acceleration)
            .chain(&mut self.deformation)
            .chain(&mut self.affine)
    }

    /// Zeros for `n` points; the columns are numbered from `first`.
    fn with_len(n: usize, histories: usize, first: usize) -> Self {
        let mut s = State { history: vec![Strip::default(); histories], ..State::default() };
        s.columns().enumerate().for_each(|(k, c)| *c = Strip::new(n, 0.0, first + k));
        s.jacobian.fill(1.0);
        s
    }

    /// Columns of F, the identity, numbered from `first`.
    fn identity(n: usize, first: usize) -> Vec<Strip> {
        [1.0, 0.0, 0.0, 1.0].iter().enumerate().map(|(k, &f)| Strip::new(n, f, first + k)).collect()
    }
}

/// A parameter of a law over the points of a group.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// The same for all points: nothing is stored.
    Uniform(f64),
    /// One value a point, in the group's order.
    Varying(Vec<f64>),
}

/// The points of one material.
pub struct Group {
    /// Its stretch of the body's columns.
    pub range: Range<usize>,
    /// Index of the material.
    pub material: u16,
    pub law: Box<dyn Law>,
    /// Parameters in the order of `law.params()`.
    pub params: Vec<Column>,
}

/// A point as it is seeded.
#[derive(Clone, Debug, Default)]
pub struct Seedling {
    pub x: [f64; 2],
    pub v: [f64; 2],
    pub mass: f64,
    pub volume: f64,
    /// Initial Cauchy stress (kPa).
    pub stress: Voigt,
}

/// A material with its points, as the body is made.
pub struct GroupSeed {
    pub material: u16,
    pub law: Box<dyn Law>,
    pub params: Vec<Column>,
    pub points: Vec<Seedling>,
}

/// All material points.
pub struct Body {
    pub groups: Vec<Group>,
    /// Identity of each point; the reference columns below are in this order.
    pub id: Vec<u32>,
    /// Mass (t/m).
    pub mass: Strip,
    /// Initial volume (m3/m).
    pub volume: Strip,
    pub committed: State,
    pub trial: State,
    reference: Vec<[f64; 2]>,
    /// Room for the order of a sort.
    order: Vec<u32>,
}

impl Body {
    /// Assembles a body; identities count up in the order given.
    pub fn new(seeds: Vec<GroupSeed>) -> Self {
        let n = seeds.iter().map(|s| s.points.len()).sum();
        let histories = seeds.iter().map(|s| s.law.states().len()).max().unwrap_or(0);
        let mut body = Body {
            groups: Vec::with_capacity(seeds.len()),
            id: (0..n as u32).collect(),
            mass: Strip::new(n, 0.0, 0),
            volume: Strip::new(n, 0.0, 1),
            committed: State::with_len(n, histories, 2),
            trial: State::with_len(n, histories, 11 + histories),
            reference: Vec::with_capacity(n),
            order: Vec::with_capacity(n),
        };
        for seed in seeds {
            body.push_group(seed);
        }
        body
    }

    /// Keeps F from now on, starting from the identity: shape functions with domains need it.
    pub fn track_domains(&mut self) {
        let (n, columns) = (self.len(), 9 + self.committed.history.len());
        self.committed.deformation = State::identity(n, 2 + 2 * columns);
        self.trial.deformation = State::identity(n, 6 + 2 * columns);
    }

    /// Keeps accelerations from now on, starting from rest.
    pub fn track_accelerations(&mut self) {
        let n = self.len();
        for (state, first) in [(&mut self.committed, 5), (&mut self.trial, 7)] {
            state.acceleration = (0..2).map(|k| Strip::new(n, 0.0, first + k)).collect();
        }
    }

    /// Keeps C from now on, starting from one a point, in the order of the identities.
    pub fn track_affine(&mut self, start: &[[f64; 4]]) {
        let n = self.len();
        for (state, first) in [(&mut self.committed, 3), (&mut self.trial, 7)] {
            state.affine = (0..4).map(|k| Strip::new(n, 0.0, first + k)).collect();
        }
        for (i, &id) in self.id.iter().enumerate() {
            for (column, c) in self.committed.affine.iter_mut().zip(start[id as usize]) {
                column[i] = c;
            }
        }
    }

    fn push_group(&mut self, seed: GroupSeed) {
        let start = self.reference.len();
        for (k, p) in seed.points.iter().enumerate() {
            self.mass[start + k] = p.mass;
            self.volume[start + k] = p.volume;
            self.reference.push(p.x);
            for axis in 0..2 {
                self.committed.x[axis][start + k] = p.x[axis];
                self.committed.v[axis][start + k] = p.v[axis];
            }
        }
        let range = start..self.reference.len();
        self.groups.push(Group { range, material: seed.material, law: seed.law, params: seed.params });
        self.set_stress(self.groups.len() - 1, |k| seed.points[k].stress);
    }

    /// Elastic strain of group `g` from a Cauchy stress for each of its points.
    fn set_stress(&mut self, g: usize, stress: impl Fn(usize) -> Voigt) {
        let mut block = Box::<Block>::default();
        for range in chunks(self.groups[g].range.clone()) {
            load_law(&mut block, &self.groups[g], &self.committed, range.clone());
            for (lane, i) in range.enumerate() {
                let s = stress(i - self.groups[g].range.start);
                let e = self.groups[g].law.strain_of(&block, lane, s).to_array();
                for (column, value) in self.committed.strain.iter_mut().zip(e) {
                    column[i] = value;
                }
            }
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// Lends out the trial state, all of it as one part, beside the rest.
    pub fn apart<R>(&mut self, work: impl FnOnce(&Body, Part<'_>) -> R) -> R {
        let mut trial = std::mem::take(&mut self.trial);
        let result = work(self, Part::whole(&mut trial));
        self.trial = trial;
        result
    }

    /// Makes the trial state the committed one.
    pub fn commit(&mut self) {
        std::mem::swap(&mut self.committed, &mut self.trial);
    }

    /// Starts a new phase from here: velocities to zero, displacements counted from now.
    pub fn restart_from_here(&mut self) {
        self.committed.v.iter_mut().chain(&mut self.committed.affine).for_each(|v| v.fill(0.0));
        self.committed.acceleration.clear();
        for (i, &id) in self.id.iter().enumerate() {
            self.reference[id as usize] = [self.committed.x[0][i], self.committed.x[1][i]];
        }
    }

    /// Where the point at place `i` of the columns started (m).
    pub fn reference(&self, i: usize) -> [f64; 2] {
        self.reference[self.id[i] as usize]
    }

    /// Displacement since the start, by identity (m).
    pub fn displacements(&self, out: &mut [[f64; 2]]) {
        let [x, y] = &self.committed.x;
        for (i, &id) in self.id.iter().enumerate() {
            let x0 = self.reference[id as usize];
            out[id as usize] = [x[i] - x0[0], y[i] - x0[1]];
        }
    }

    /// Sum of m v (kN s/m).
    pub fn momentum(&self) -> [f64; 2] {
        [0, 1].map(|a| self.mass.iter().zip(self.committed.v[a].iter()).map(|(m, v)| m * v).sum())
    }

    /// Sum of m (t/m).
    pub fn total_mass(&self) -> f64 {
        self.mass.iter().sum()
    }

    /// Sum of 1/2 m v^2 over the points (kJ/m).
    pub fn kinetic_energy(&self) -> f64 {
        let [vx, vy] = &self.committed.v;
        self.mass.iter().zip(vx.iter().zip(vy.iter())).map(|(m, (x, y))| 0.5 * m * (x * x + y * y)).sum()
    }

    /// Elastic energy (kJ/m).
    pub fn strain_energy(&self) -> f64 {
        let mut sum = 0.0;
        self.for_each(|group, block, lane, i| {
            sum += self.volume[i] * group.law.strain_energy(block, lane);
        });
        sum
    }

    /// Visits every point with its group, its block, its lane and its index.
    pub fn for_each(&self, mut visit: impl FnMut(&Group, &Block, usize, usize)) {
        let mut block = Box::<Block>::default();
        for group in &self.groups {
            for range in chunks(group.range.clone()) {
                load_law(&mut block, group, &self.committed, range.clone());
                group.law.stress(&mut block);
                for (lane, i) in range.enumerate() {
                    visit(group, &block, lane, i);
                }
            }
        }
    }

    /// Puts the points of each group in the order of their cells. Identities go with them. The trial positions, which
    /// mean nothing between two steps, are the buffers.
    pub fn sort(&mut self, grid: &Grid) {
        for g in 0..self.groups.len() {
            let range = self.groups[g].range.clone();
            let Body { committed, trial, order, .. } = self;
            let (x, y) = (&committed.x[0][range.clone()], &committed.x[1][range.clone()]);
            let cells = &mut trial.x[0][range];
            cells.iter_mut().zip(x.iter().zip(y)).for_each(|(cell, (&x, &y))| *cell = cell_key(grid, x, y));
            order.clear();
            order.extend(0..cells.len() as u32);
            order.sort_unstable_by(|&a, &b| cells[a as usize].total_cmp(&cells[b as usize]).then(a.cmp(&b)));
            self.apply_order(g);
        }
    }

    /// Reorders every column of group `g`: `self.order` gives the old place of each point.
    fn apply_order(&mut self, g: usize) {
        let range = self.groups[g].range.clone();
        let Body { groups, order, committed, trial, mass, volume, id, .. } = self;
        let old = &mut trial.x[1][range.clone()];
        let mut reorder = |column: &mut [f64]| {
            old.copy_from_slice(column);
            column.iter_mut().zip(order.iter()).for_each(|(to, from)| *to = old[*from as usize]);
        };
        committed.columns().for_each(|c| reorder(&mut c[range.clone()]));
        reorder(&mut mass[range.clone()]);
        reorder(&mut volume[range.clone()]);
        for column in &mut groups[g].params {
            if let Column::Varying(values) = column {
                reorder(values);
            }
        }
        old.iter_mut().zip(&id[range.clone()]).for_each(|(to, &from)| *to = f64::from(from));
        id[range].iter_mut().zip(order.iter()).for_each(|(to, from)| *to = old[*from as usize] as u32);
    }

    /// The state in the order of the identities.
    pub fn snapshot(&self, time: f64, step: u64) -> Snapshot {
        let n = self.len();
        let mut s = Snapshot {
            time,
            step,
            position: vec![[0.0; 2]; n],
            reference: self.reference.clone(),
            velocity: vec![[0.0; 2]; n],
            mass: vec![0.0; n],
            initial_volume: vec![0.0; n],
            jacobian: vec![0.0; n],
            stress: vec![Voigt::default(); n],
            plastic_strain: vec![0.0; n],
            strength: vec![0.0; n],
            peak_strength: vec![0.0; n],
            stage: vec![Stage::Elastic; n],
            material: vec![0; n],
            strain_energy: vec![0.0; n],
        };
        self.for_each(|group, block, lane, i| self.describe(&mut s, group, block, lane, i));
        s
    }

    fn describe(&self, s: &mut Snapshot, group: &Group, block: &Block, lane: usize, i: usize) {
        let k = self.id[i] as usize;
        let standing = group.law.standing(block, lane);
        let c = &self.committed;
        s.position[k] = [c.x[0][i], c.x[1][i]];
        s.velocity[k] = [c.v[0][i], c.v[1][i]];
        s.mass[k] = self.mass[i];
        s.initial_volume[k] = self.volume[i];
        s.jacobian[k] = c.jacobian[i];
        s.stress[k] = Voigt::from_array(std::array::from_fn(|a| block.stress[a][lane]));
        s.plastic_strain[k] = standing.plastic_strain;
        s.strength[k] = standing.strength;
        s.peak_strength[k] = standing.peak_strength;
        s.stage[k] = match (standing.plastic_strain > 0.0, standing.yielding, standing.residual) {
            (false, ..) => Stage::Elastic,
            (true, false, _) => Stage::Unloading,
            (true, true, false) => Stage::Softening,
            (true, true, true) => Stage::Residual,
        };
        s.material[k] = group.material;
        s.strain_energy[k] = self.volume[i] * group.law.strain_energy(block, lane);
    }

    /// Bytes held for each point.
    pub fn bytes_per_point(&self) -> f64 {
        let varying: usize = self
            .groups
            .iter()
            .flat_map(|g| g.params.iter().map(|c| if let Column::Varying(v) = c { v.len() } else { 0 }))
            .sum();
        let c = &self.committed;
        let state = 9 + [&c.history, &c.acceleration, &c.deformation, &c.affine].map(Vec::len).iter().sum::<usize>();
        // mass and volume, identity, order of a sort, reference
        let fixed = (2 * state + 2) * 8 + 4 + 4 + 16;
        fixed as f64 + varying as f64 * 8.0 / self.len().max(1) as f64
    }

    /// Names the point of lane `lane` of the block that starts at `start`, and its place.
    pub fn blame(&self, fault: Fault, start: usize) -> Fault {
        let i = start + fault.point.unwrap_or(0) as usize;
        fault.at(self.id[i], [self.committed.x[0][i], self.committed.x[1][i]])
    }
}

/// Cell of a position, row by row; positions outside go to the last key. A whole number of at most 32 bits.
fn cell_key(grid: &Grid, x: f64, y: f64) -> f64 {
    let cx = ((x - grid.origin[0]) / grid.h) as u64;
    let cy = ((y - grid.origin[1]) / grid.h) as u64;
    (cy.saturating_mul(u64::from(grid.cells[0])).saturating_add(cx)).min(u64::from(u32::MAX)) as f64
}

/// A stretch cut into blocks.
#[inline(always)]
pub fn chunks(range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let end = range.end;
    range.step_by(LANES).map(move |a| a..(a + LANES).min(end))
}

/// Copies a stretch of a column into a lane.
#[inline(always)]
pub fn load(lane: &mut Lane, column: &[f64], range: &Range<usize>) {
    let from = &column[range.start..range.end];
    if let Ok(full) = <&Lane>::try_from(from) {
        *lane = *full;
    } else {
        lane[..from.len()].copy_from_slice(from);
    }
}

/// Copies a lane into a stretch of a column.
#[inline(always)]
pub fn store(lane: &Lane, column: &mut [f64], range: &Range<usize>) {
    let to = &mut column[range.start..range.end];
    if let Ok(full) = <&mut Lane>::try_from(&mut *to) {
        *full = *lane;
    } else {
        let n = to.len();
        to.copy_from_slice(&lane[..n]);
    }
}

/// Loads what the law reads: strain, J, history, and the parameters that vary. Uniform
/// parameters are written by [`set_uniform`] once a group.
#[inline(always)]
pub fn load_state(block: &mut Block, group: &Group, state: &State, range: &Range<usize>) {
    block.len = range.len();
    for (lane, column) in block.strain.iter_mut().zip(&state.strain) {
        load(lane, column, range);
    }
    load(&mut block.jacobian, &state.jacobian, range);
    load_varying(block, group, range);
}

/// Loads the parameters that vary over the group.
#[inline(always)]
pub fn load_varying(block: &mut Block, group: &Group, range: &Range<usize>) {
    let local = range.start - group.range.start..range.end - group.range.start;
    for (lane, column) in block.param.iter_mut().zip(&group.params) {
        if let Column::Varying(values) = column {
            load(lane, values, &local);
        }
    }
}

/// Writes the uniform parameters of a group into the block.
#[inline(always)]
pub fn set_uniform(block: &mut Block, group: &Group) {
    for (lane, column) in block.param.iter_mut().zip(&group.params) {
        if let Column::Uniform(value) = column {
            lane.fill(*value);
        }
    }
}

/// Everything the law reads, for the cold paths.
fn load_law(block: &mut Block, group: &Group, state: &State, range: Range<usize>) {
    set_uniform(block, group);
    load_state(block, group, state, &range);
    for (lane, column) in block.state.iter_mut().zip(&state.history) {
        load(lane, column, &range);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{
        block::PointLaw,
        kinematics::{Hencky, StrengthMeasure},
        material::Elastic,
    };

    /// A few elastic points in a row, of 1/4 m3/m each, with domains.
    pub fn points(n: usize) -> Body {
        let point = |i: usize| Seedling { x: [i as f64, 0.0], mass: 1.0, volume: 0.25, ..Seedling::default() };
        let law = Box::new(PointLaw::<Elastic, Hencky>::new(Elastic, StrengthMeasure::Cauchy));
        let params = vec![Column::Uniform(100.0), Column::Uniform(0.3)];
        let mut body =
            Body::new(vec![GroupSeed { material: 0, law, params, points: (0..n).rev().map(point).collect() }]);
        body.track_domains();
        body
    }

    #[test]
    fn domains_go_with_their_points() {
        let mut body = points(5);
        let bare = body.bytes_per_point() - 64.0;
        assert_eq!(body.committed.deformation.len(), 4);
        for i in 0..5 {
            body.committed.deformation[1][i] = body.committed.x[0][i];
        }
        body.sort(&Grid { origin: [-0.5, -0.5], h: 1.0, cells: [5, 1] });
        assert_eq!(&body.committed.deformation[1][..], &[0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(&body.committed.x[0][..], &body.committed.deformation[1][..]);
        body.committed.deformation.clear();
        assert_eq!(body.bytes_per_point(), bare);
    }
}
