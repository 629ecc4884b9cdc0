//! The loop over blocks: fill, gather, law, scatter.
//!
//! Each pass walks the points block by block. The stages of a pass meet only in buffers that
//! stay in the first-level cache ([`Scratch`]); a pass is instantiated once per shape function,
//! and the law sits behind one virtual call a block.

pub mod affine;
pub mod cells;
pub mod nonlocal;
pub mod response;
pub mod smooth;

use std::ops::Range;

use cells::CellMeans;

use crate::{
    block::Block,
    body::{
        Body, Group, Part, chunks, load, load_state,
        part::{common, store_all},
        set_uniform, store,
    },
    domain,
    fault::{Fault, FaultKind},
    math::simd::Kernel,
    nodes::Nodes,
    space::{
        Grid, Shape, Stencil,
        stencil::{LANES, Lane},
    },
};

/// Buffers of the stages, for shapes with `N` nodes a point.
#[derive(Default)]
pub struct Scratch<const N: usize> {
    pub block: Block,
    pub stencil: Stencil<N>,
    pub x: Columns2,
    pub v: Columns2,
    pub mass: Lanes,
    pub volume: Lanes,
    /// Nodal values spread to the points: component, node of the patch, point.
    pub nodal: [Spread<N>; 4],
    /// The runs of the body in this step.
    pub runs: BodyRuns<N>,
    /// Contributions of the points: component, node of the patch, point.
    pub shares: [Patch<N>; 5],
}

/// The runs of equal nodes of a whole body: found once a step, by [`Scatter`], and read by every
/// later pass of it.
#[derive(Default)]
pub struct BodyRuns<const N: usize> {
    runs: Vec<RunPatch<N>>,
    /// One past the last run of each block.
    ends: Vec<u32>,
}

/// A run of points with equal nodes, and the active numbers of these nodes.
#[derive(Clone, Copy, Debug)]
pub struct RunPatch<const N: usize> {
    /// First lane, and one past the last.
    pub start: u32,
    pub end: u32,
    pub slots: [u32; N],
}

impl<const N: usize> BodyRuns<N> {
    /// Forgets the runs of the last step. There is room for the worst case, which costs no
    /// memory until it is used.
    fn begin(&mut self, points: usize) {
        self.runs.clear();
        self.ends.clear();
        self.runs.reserve(points);
        self.ends.reserve(points);
    }

    /// Runs in all.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        size_of::<RunPatch<N>>() * self.runs.len() + 4 * self.ends.len()
    }

    /// The runs of block `b`.
    #[inline(always)]
    pub fn of(&self, b: usize) -> &[RunPatch<N>] {
        let first = if b == 0 { 0 } else { self.ends[b - 1] };
        &self.runs[first as usize..self.ends[b] as usize]
    }
}

/// One lane, aligned.
#[repr(align(64))]
pub struct Lanes(pub Lane);

/// Two lanes, aligned.
#[repr(align(64))]
pub struct Columns2(pub [Lane; 2]);

/// One lane for each node of a patch, aligned.
#[repr(align(64))]
pub struct Patch<const N: usize>(pub [Lane; N]);

/// Points written at a time when nodal values are spread.
const STRIP: usize = 4;

/// A patch with room for one strip more.
#[repr(align(64))]
pub struct Spread<const N: usize>(pub [[f64; LANES + STRIP]; N]);

impl<const N: usize> Default for Spread<N> {
    fn default() -> Self {
        Spread([[0.0; LANES + STRIP]; N])
    }
}

impl Default for Lanes {
    fn default() -> Self {
        Lanes([0.0; LANES])
    }
}

impl Default for Columns2 {
    fn default() -> Self {
        Columns2([[0.0; LANES]; 2])
    }
}

impl<const N: usize> Default for Patch<N> {
    fn default() -> Self {
        Patch([[0.0; LANES]; N])
    }
}

/// Loads the committed positions of a block and fills its stencil.
#[inline(always)]
pub fn place<S: Shape<N>, const N: usize>(s: &mut Scratch<N>, body: &Body, nodes: &Nodes, range: &Range<usize>) {
    load_places(s, body, range);
    let [x, y] = &s.x.0;
    if S::DOMAIN {
        S::fill(&nodes.grid, x, y, &domain::half_lengths(body, range), &mut s.stencil);
    } else {
        S::fill(&nodes.grid, x, y, &[[0.0; LANES]; 2], &mut s.stencil);
    }
}

#[inline(always)]
fn load_places<const N: usize>(s: &mut Scratch<N>, body: &Body, range: &Range<usize>) {
    for axis in 0..2 {
        load(&mut s.x.0[axis], &body.committed.x[axis], range);
    }
}

/// Spreads nodal columns to the points of the block, in whole vectors: what is written past a run belongs to
/// the next one, which follows.
#[inline(always)]
pub fn spread<const N: usize, const C: usize>(
    patches: &[RunPatch<N>],
    nodal: &mut [Spread<N>; 4],
    columns: [&[f64]; C],
) {
    // of one length: a slot is checked once for all columns
    let shortest = columns.iter().map(|c| c.len()).fold(usize::MAX, usize::min);
    let columns = columns.map(|c| &c[..shortest]);
    for run in patches {
        let (start, end) = (run.start as usize, (run.end as usize).min(LANES));
        if C * N > 16 {
            // more values than registers: one component after the other
            for (nodal, column) in nodal.iter_mut().zip(columns) {
                fan_out(nodal, start..end, run.slots.map(|slot| column[slot as usize]));
            }
            continue;
        }
        let slots = run.slots.map(|s| s as usize);
        // plain loops: closures of arrays were compiled apart, as calls for each run
        let mut values = [[0.0; N]; C];
        for c in 0..C {
            for k in 0..N {
                values[c][k] = columns[c][slots[k]];
            }
        }
        let mut i = start;
        while i < end {
            for c in 0..C {
                for k in 0..N {
                    nodal[c].0[k][i..i + STRIP].copy_from_slice(&[values[c][k]; STRIP]);
                }
            }
            i += STRIP;
        }
    }
}

/// Writes the nodal values of one component to the points of a run.
#[inline(always)]
fn fan_out<const N: usize>(nodal: &mut Spread<N>, run: Range<usize>, values: [f64; N]) {
    let mut i = run.start;
    while i < run.end {
        for k in 0..N {
            nodal.0[k][i..i + STRIP].copy_from_slice(&[values[k]; STRIP]);
        }
        i += STRIP;
    }
}

/// Adds the shares of the points of a run, component by node of the patch: one loop for all
/// components, since its length is hard to predict.
#[inline(always)]
pub fn collect<const N: usize, const C: usize>(shares: &[Patch<N>], run: &RunPatch<N>) -> [[f64; N]; C] {
    let (start, end) = (run.start as usize % LANES, (run.end as usize).min(LANES));
    let mut sum = [[0.0; N]; C];
    for c in 0..C {
        for k in 0..N {
            sum[c][k] = shares[c].0[k][start];
        }
    }
    for i in start + 1..end {
        for c in 0..C {
            for k in 0..N {
                sum[c][k] += shares[c].0[k][i];
            }
        }
    }
    sum
}

/// Adds the sums of a run to the nodal columns. They are cut to one length, so that a slot is
/// checked once for all of them.
#[inline(always)]
pub fn deposit<const N: usize, const C: usize>(columns: [&mut [f64]; C], slots: &[usize; N], sums: [[f64; N]; C]) {
    let shortest = columns.iter().map(|c| c.len()).fold(usize::MAX, usize::min);
    let columns = columns.map(|c| &mut c[..shortest]);
    for k in 0..N {
        for c in 0..C {
            columns[c][slots[k]] += sums[c][k];
        }
    }
}

/// Mass, momentum and internal force of the committed body, onto nodes that become active:
/// ```text
/// m_i = sum N_i m_p,   (m v)_i = sum N_i m_p v_p,   f_i = - sum sigma_p grad N_i J_p V0_p
/// ```
/// Where points carry an affine velocity, its momentum is added (see [`affine`]).
pub struct Scatter<'a, S, const N: usize> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a Body,
    pub nodes: &'a mut Nodes,
    /// Where the mean stress is smoothed over cells; the stretch is then the whole body.
    pub cells: Option<&'a mut CellMeans>,
    /// The points of the pass: whole blocks.
    pub stretch: Range<usize>,
    pub shape: S,
}

impl<S: Shape<N>, const N: usize> Kernel for Scatter<'_, S, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Scatter { scratch: s, body, nodes, mut cells, stretch, .. } = self;
        let offsets = S::offsets(nodes.grid.row());
        s.runs.begin(stretch.len());
        if let Some(cells) = &mut cells {
            mean_stresses(s, body, &nodes.grid, cells);
        }
        for group in &body.groups {
            set_uniform(&mut s.block, group);
            for range in chunks(common(&group.range, &stretch)) {
                place::<S, N>(s, body, nodes, &range);
                load_state(&mut s.block, group, &body.committed, &range);
                group.law.stress(&mut s.block);
                if let Some(cells) = &mut cells {
                    cells.level_stress(&nodes.grid, &s.x.0, &mut s.block, range.len());
                }
                load_motion(s, body, &range);
                shares(s);
                if !body.committed.affine.is_empty() {
                    let [_, px, py, ..] = &mut s.shares;
                    let c = affine::committed(body, &range);
                    affine::add::<S, N>([px, py], &s.stencil, &s.mass.0, &c, nodes.grid.h);
                }
                s.stencil.find_runs(range.len());
                for run in s.stencil.runs() {
                    let slots = nodes.patch(run.base, &offsets);
                    let run = RunPatch { start: run.start, end: run.end, slots: slots.map(|s| s as u32) };
                    s.runs.runs.push(run);
                    let Nodes { mass, momentum: [px, py], force: [fx, fy], .. } = &mut *nodes;
                    deposit([mass, px, py, fx, fy], &slots, collect(&s.shares, &run));
                }
                s.runs.ends.push(s.runs.runs.len() as u32);
            }
        }
    }
}

/// The sums of tr(J sigma) over the cells.
fn mean_stresses<const N: usize>(s: &mut Scratch<N>, body: &Body, grid: &Grid, cells: &mut CellMeans) {
    cells.begin();
    for group in &body.groups {
        set_uniform(&mut s.block, group);
        for range in chunks(group.range.clone()) {
            load_places(s, body, &range);
            load_state(&mut s.block, group, &body.committed, &range);
            group.law.stress(&mut s.block);
            cells.add(grid, &s.x.0, body, &range, &cells::trace(&s.block));
        }
    }
}

#[inline(always)]
fn load_motion<const N: usize>(s: &mut Scratch<N>, body: &Body, range: &Range<usize>) {
    for axis in 0..2 {
        load(&mut s.v.0[axis], &body.committed.v[axis], range);
    }
    load(&mut s.mass.0, &body.mass, range);
    load(&mut s.volume.0, &body.volume, range);
}

/// What each point gives to each of its nodes.
#[inline(always)]
fn shares<const N: usize>(s: &mut Scratch<N>) {
    let [m, px, py, fx, fy] = &mut s.shares;
    let b = &s.block;
    for i in 0..LANES {
        let volume = -(s.volume.0[i] * b.jacobian[i]);
        let (sxx, syy, sxy) = (volume * b.stress[0][i], volume * b.stress[1][i], volume * b.stress[3][i]);
        let mass = s.mass.0[i];
        let (mvx, mvy) = (mass * s.v.0[0][i], mass * s.v.0[1][i]);
        for k in 0..N {
            let (w, [gx, gy]) = (s.stencil.weight(k, i), s.stencil.grad(k, i));
            m.0[k][i] = w * mass;
            px.0[k][i] = w * mvx;
            py.0[k][i] = w * mvy;
            fx.0[k][i] = sxx * gx + sxy * gy;
            fy.0[k][i] = sxy * gx + syy * gy;
        }
    }
}

/// Strains a part of the body with the nodes' strain velocity over `dt` and applies the laws; trial
/// strain, J and history are written, and the plastic work of the step (kJ/m) is returned.
pub struct Strain<'a, S, const N: usize> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a Body,
    pub part: Part<'a>,
    pub nodes: &'a Nodes,
    /// Where the dilatation is smoothed over cells; the part is then the whole body.
    pub cells: Option<&'a mut CellMeans>,
    pub dt: f64,
    pub shape: S,
}

impl<S: Shape<N>, const N: usize> Kernel for Strain<'_, S, N> {
    type Output = Result<f64, Fault>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Strain { scratch: s, body, mut part, nodes, mut cells, dt, .. } = self;
        let [vx, vy] = &nodes.strain_velocity;
        let (mut plastic_work, mut block) = (0.0, 0);
        if let Some(cells) = &mut cells {
            mean_dilatations::<S, N>(s, body, nodes, cells, dt)?;
        }
        for group in &body.groups {
            set_uniform(&mut s.block, group);
            for range in chunks(common(&group.range, &part.range)) {
                // first, so that what it writes is in the cache when it is read
                spread(s.runs.of(block), &mut s.nodal, [vx, vy]);
                place::<S, N>(s, body, nodes, &range);
                block += 1;
                gradient(s, dt);
                if S::DOMAIN {
                    let new = domain::deformed(body, &s.block.du, &range);
                    let local = part.local(&range);
                    store_all(&new, &mut part.deformation, &local);
                }
                if let Some(cells) = &mut cells {
                    cells.level_strain(&nodes.grid, &s.x.0, group.law.as_ref(), &mut s.block, range.len());
                }
                load_point_state(&mut s.block, group, body, &range);
                if let Err(fault) = group.law.advance(&mut s.block) {
                    return Err(body.blame(fault, range.start));
                }
                part.store_point_state(&s.block, &range);
                load(&mut s.volume.0, &body.volume, &range);
                plastic_work += dot(&s.block.dissipation, &s.volume.0, range.len());
            }
        }
        Ok(plastic_work)
    }
}

/// The sums of the dilatation of the step over the cells.
fn mean_dilatations<S: Shape<N>, const N: usize>(
    s: &mut Scratch<N>,
    body: &Body,
    nodes: &Nodes,
    cells: &mut CellMeans,
    dt: f64,
) -> Result<(), Fault> {
    let [vx, vy] = &nodes.strain_velocity;
    let (mut block, mut theta) = (0, [0.0; LANES]);
    cells.begin();
    for group in &body.groups {
        for range in chunks(group.range.clone()) {
            place::<S, N>(s, body, nodes, &range);
            spread(s.runs.of(block), &mut s.nodal, [vx, vy]);
            gradient(s, dt);
            s.block.len = range.len();
            group.law.dilatation(&s.block, &mut theta);
            if let Some(lane) = theta[..range.len()].iter().position(|t| !t.is_finite()) {
                // its mean would blame another point
                return Err(body.blame(Fault::new(FaultKind::Inverted).at(lane as u32, [f64::NAN; 2]), range.start));
            }
            cells.add(&nodes.grid, &s.x.0, body, &range, &theta);
            block += 1;
        }
    }
    Ok(())
}

/// grad du = dt sum v_i (x) grad N_i.
#[inline(always)]
fn gradient<const N: usize>(s: &mut Scratch<N>, dt: f64) {
    let [vx, vy, ..] = &s.nodal;
    for i in 0..LANES {
        let mut du = [0.0; 4];
        for k in 0..N {
            let [gx, gy] = s.stencil.grad(k, i);
            du[0] += vx.0[k][i] * gx;
            du[1] += vx.0[k][i] * gy;
            du[2] += vy.0[k][i] * gx;
            du[3] += vy.0[k][i] * gy;
        }
        for c in 0..4 {
            s.block.du[c][i] = dt * du[c];
        }
    }
}

#[inline(always)]
fn load_point_state(block: &mut Block, group: &Group, body: &Body, range: &Range<usize>) {
    load_state(block, group, &body.committed, range);
    for (lane, column) in block.state.iter_mut().zip(&body.committed.history) {
        load(lane, column, range);
    }
}

#[inline(always)]
fn store_point_state(block: &Block, body: &mut Body, range: &Range<usize>) {
    for (lane, column) in block.trial_strain.iter().zip(&mut body.trial.strain) {
        store(lane, column, range);
    }
    store(&block.trial_jacobian, &mut body.trial.jacobian, range);
    for (lane, column) in block.trial_state.iter().zip(&mut body.trial.history) {
        store(lane, column, range);
    }
}

/// Sum of a_i b_i over the first `len` lanes, in four running sums: a fixed order.
#[inline(always)]
fn dot(a: &Lane, b: &Lane, len: usize) -> f64 {
    let mut terms: Lane = std::array::from_fn(|i| a[i] * b[i]);
    terms[len.min(LANES)..].fill(0.0);
    let mut sums = [0.0; 4];
    for four in terms.chunks_exact(4) {
        for (sum, term) in sums.iter_mut().zip(four) {
            *sum += term;
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
