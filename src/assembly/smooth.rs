//! Mean dilatation over each cell (B-bar), against volumetric locking: the response of the body
//! with one dilatation and one mean stress a cell.
//!
//! With theta the dilatation of the step at a point (ln det F, or tr e in small strain) and
//! <.> the mean over the points of a cell, weighted with their initial volumes, the trial strain is
//! ```text
//! e' = e + 1/2 (<theta> - theta) I    in the plane, where a step can change the volume
//! ```
//! The forces are the derivative of the energy of e' and so balance it:
//! ```text
//! t' = t - 1/2 tr t I + 1/2 <tr t> I,   f_i = sum V0 t' grad N_i
//! ```
//! with both traces in the plane (Nagtegaal, Parks & Rice 1974; Simo, Taylor & Pister 1985; for
//! material points with cell means, Coombs et al. 2018). With M = d t / d l at e', Q = (. - 1/2 tr .
//! I), and over the points of a cell
//! ```text
//! b_j = sum V0 grad N_j / W,   a_i = sum V0 grad N_i . Q M (I / 2),   c_j = sum V0 tr M Q grad N_j,
//! s = sum V0 tr M (I / 2)
//! ```
//! the tangent is that of the points with Q M Q and t', plus a (x) b + 1/2 b (x) c + 1/2 s b (x) b in
//! each cell. It is symmetric where M is.

use super::{
    Scratch,
    response::{Kept, Pass, inverse, kirchhoff, respond, strain, update},
};
use crate::{
    block::Moduli3,
    body::{Body, chunks, set_uniform},
    domain,
    fault::{Fault, FaultKind},
    math::{simd::Kernel, sparse::offset_bit},
    nodes::Nodes,
    space::{
        Grid, Shape, Stencil,
        stencil::{LANES, Lane},
    },
    system::System,
};

/// Most nodes that the points of a cell reach.
const REACH: usize = 16;

/// Sums over the points of a cell.
#[derive(Clone, Copy)]
struct Cell {
    slots: [u32; REACH],
    nodes: usize,
    /// W, and the sums of V0 theta and V0 tr t.
    volume: f64,
    dilatation: f64,
    trace: f64,
    /// W b, a, c by node and axis, and s.
    b: [[f64; 2]; REACH],
    a: [[f64; 2]; REACH],
    c: [[f64; 2]; REACH],
    s: f64,
}

impl Cell {
    const EMPTY: Cell = Cell {
        slots: [0; REACH],
        nodes: 0,
        volume: 0.0,
        dilatation: 0.0,
        trace: 0.0,
        b: [[0.0; 2]; REACH],
        a: [[0.0; 2]; REACH],
        c: [[0.0; 2]; REACH],
        s: 0.0,
    };

    fn clear(&mut self) {
        *self = Cell { slots: self.slots, nodes: self.nodes, ..Cell::EMPTY };
    }

    /// Place of a node in the lists; it is entered if it is new.
    fn enter(&mut self, slot: u32) -> usize {
        match self.slots[..self.nodes].iter().position(|s| *s == slot) {
            Some(k) => k,
            None if self.nodes < REACH => {
                self.slots[self.nodes] = slot;
                self.nodes += 1;
                self.nodes - 1
            }
            // the points of a cell reach 4 x 4 nodes at most, whatever the shape (space::shape)
            None => {
                debug_assert!(false, "a cell reaches more than {REACH} nodes");
                REACH - 1
            }
        }
    }
}

/// The cells with points, and what the passes leave for each other.
#[derive(Default)]
pub struct Cells {
    cells: Vec<Cell>,
    /// Number of the cell of each point.
    of_point: Vec<u32>,
    /// Number of each grid cell, or none.
    number: Vec<u32>,
    seen: Vec<u32>,
    /// J sigma and moduli of each block.
    stress: Vec<[Lane; 3]>,
    moduli: Vec<Moduli3>,
}

const NONE: u32 = u32::MAX;

impl Cells {
    /// Forgets the cells of the last step.
    pub fn begin(&mut self, grid: &Grid, points: usize) {
        let all = grid.cells[0] as usize * grid.cells[1] as usize;
        self.number.resize(all, NONE);
        self.seen.drain(..).for_each(|c| self.number[c as usize] = NONE);
        self.cells.clear();
        self.of_point.clear();
        self.of_point.resize(points, 0);
    }

    /// Notes the cell of a point at `x`, and the nodes that it reaches.
    pub fn place(&mut self, grid: &Grid, point: usize, x: [f64; 2], slots: &[u32]) {
        let [cx, cy] = [0, 1].map(|a| (((x[a] - grid.origin[a]) / grid.h) as u32).min(grid.cells[a] - 1));
        let id = cy as usize * grid.cells[0] as usize + cx as usize;
        if self.number[id] == NONE {
            self.number[id] = self.cells.len() as u32;
            self.seen.push(id as u32);
            self.cells.push(Cell::EMPTY);
        }
        self.of_point[point] = self.number[id];
        let cell = &mut self.cells[self.number[id] as usize];
        for slot in slots {
            cell.enter(*slot);
        }
    }

    /// All nodes of a cell are coupled.
    pub fn couple(&self, nodes: &Nodes, system: &mut System) {
        for cell in &self.cells {
            let slots = &cell.slots[..cell.nodes];
            for &j in slots {
                let from = nodes.grid.node_place(nodes.id[j as usize]);
                let bit = |i: &u32| {
                    let to = nodes.grid.node_place(nodes.id[*i as usize]);
                    1u64 << offset_bit(to[0] as i32 - from[0] as i32, to[1] as i32 - from[1] as i32)
                };
                system.couple(j as usize, slots.iter().map(bit).fold(0, |m, b| m | b));
            }
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.cells.capacity() * size_of::<Cell>()
            + 4 * (self.of_point.capacity() + self.number.capacity())
            + self.stress.capacity() * size_of::<[Lane; 3]>()
            + self.moduli.capacity() * size_of::<Moduli3>()
    }
}

/// As [`super::response::Respond`], with the dilatation smoothed over cells: three walks over the
/// blocks, for the mean dilatation, the mean stress, and the forces.
pub struct RespondSmoothed<'a, S, const N: usize> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a mut Body,
    pub kept: &'a mut Kept<N>,
    pub cells: &'a mut Cells,
    pub system: &'a mut System,
    pub tangent: bool,
    pub shape: S,
}

impl<S: Shape<N>, const N: usize> Kernel for RespondSmoothed<'_, S, N> {
    type Output = Result<f64, Fault>;

    #[inline(always)]
    fn run(mut self) -> Self::Output {
        self.cells.cells.iter_mut().for_each(Cell::clear);
        self.dilatations()?;
        let plastic = self.stresses()?;
        self.forces();
        if self.tangent {
            self.cells.cells.iter().for_each(|c| add(self.system, c));
        }
        Ok(plastic)
    }
}

impl<S: Shape<N>, const N: usize> RespondSmoothed<'_, S, N> {
    fn dilatations(&mut self) -> Result<(), Fault> {
        let RespondSmoothed { scratch: s, body, kept, cells, system, .. } = self;
        let mut theta = [0.0; LANES];
        let mut block = 0;
        for group in &body.groups {
            for range in chunks(group.range.clone()) {
                s.block.len = range.len();
                strain(s, &kept.stencils[block], system, block);
                group.law.dilatation(&s.block, &mut theta);
                for (lane, i) in range.clone().enumerate() {
                    if !theta[lane].is_finite() {
                        // its mean would blame another point
                        return Err(
                            body.blame(Fault::new(FaultKind::Inverted).at(lane as u32, [f64::NAN; 2]), range.start)
                        );
                    }
                    let cell = &mut cells.cells[cells.of_point[i] as usize];
                    cell.volume += body.volume[i];
                    cell.dilatation += body.volume[i] * theta[lane];
                }
                block += 1;
            }
        }
        Ok(())
    }

    fn stresses(&mut self) -> Result<f64, Fault> {
        let RespondSmoothed { scratch: s, body, kept, cells, system, tangent, .. } = self;
        let (mut plastic, mut block) = (0.0, 0);
        let mut by = [0.0; LANES];
        for g in 0..body.groups.len() {
            set_uniform(&mut s.block, &body.groups[g]);
            let finite = body.groups[g].law.finite();
            for range in chunks(body.groups[g].range.clone()) {
                strain(s, &kept.stencils[block], system, block);
                if S::DOMAIN && finite {
                    domain::deform(body, &s.block.du, &range);
                }
                s.block.len = range.len();
                body.groups[g].law.dilatation(&s.block, &mut by);
                for (lane, i) in range.clone().enumerate() {
                    let cell = &cells.cells[cells.of_point[i] as usize];
                    by[lane] = cell.dilatation / cell.volume - by[lane];
                }
                body.groups[g].law.dilate(&mut s.block, &by);
                update(s, body, g, &range)?;
                if block == cells.stress.len() {
                    cells.stress.push([[0.0; LANES]; 3]);
                    cells.moduli.push([[[0.0; LANES]; 4]; 3]);
                }
                kirchhoff(&s.block, &mut cells.stress[block]);
                if *tangent {
                    system.symmetric &= body.groups[g].law.linearise(&s.block, &mut cells.moduli[block]);
                }
                for (lane, i) in range.enumerate() {
                    plastic += body.volume[i] * s.block.dissipation[lane];
                    let t = &cells.stress[block];
                    cells.cells[cells.of_point[i] as usize].trace += body.volume[i] * (t[0][lane] + t[1][lane]);
                }
                block += 1;
            }
        }
        Ok(plastic)
    }

    fn forces(&mut self) {
        let RespondSmoothed { scratch: s, body, kept, cells, system, tangent, .. } = self;
        let mut block = 0;
        for g in 0..body.groups.len() {
            let finite = body.groups[g].law.finite();
            for range in chunks(body.groups[g].range.clone()) {
                let stencil = &kept.stencils[block];
                strain(s, stencil, system, block);
                crate::body::load(&mut s.volume.0, &body.volume, &range);
                let points = kept.points.as_mut();
                points.kirchhoff = cells.stress[block];
                for (lane, i) in range.clone().enumerate() {
                    let cell = &cells.cells[cells.of_point[i] as usize];
                    let t = &mut points.kirchhoff;
                    let shift = 0.5 * (cell.trace / cell.volume - t[0][lane] - t[1][lane]);
                    t[0][lane] += shift;
                    t[1][lane] += shift;
                }
                if *tangent {
                    points.moduli = cells.moduli[block];
                    for run in s.runs.of(block) {
                        for lane in run.start as usize..run.end as usize {
                            let cell = &mut cells.cells[cells.of_point[range.start + lane] as usize];
                            gather(
                                cell,
                                stencil,
                                &points.moduli,
                                &inverse(&s.block, lane, finite),
                                [lane, range.start],
                                &run.slots,
                                body,
                            );
                        }
                    }
                    project(&mut points.moduli);
                }
                respond(s, stencil, &kept.bits, points, system, Pass { block, finite, tangent: *tangent });
                block += 1;
            }
        }
    }
}

/// Adds a point to the sums of its cell.
fn gather<const N: usize>(
    cell: &mut Cell,
    stencil: &Stencil<N>,
    m: &Moduli3,
    inverse: &[[f64; 2]; 2],
    [lane, start]: [usize; 2],
    slots: &[u32; N],
    body: &Body,
) {
    let volume = body.volume[start + lane];
    let at = |row: usize, k: usize| volume * m[row][k][lane];
    // M (I / 2): xx, yy, xy; its trace, and the deviator
    let half = [0, 1, 2].map(|row| 0.5 * (at(row, 0) + at(row, 3)));
    let trace = half[0] + half[1];
    let dev = [half[0] - 0.5 * trace, half[1] - 0.5 * trace, half[2]];
    // tr M, then tr M Q: by l_xx, l_xy, l_yx, l_yy
    let mut row = [0, 1, 2, 3].map(|k| at(0, k) + at(1, k));
    let mean = 0.5 * (row[0] + row[3]);
    row[0] -= mean;
    row[3] -= mean;
    for k in 0..N {
        let [gx, gy] = stencil.grad(k, lane);
        let g = [gx * inverse[0][0] + gy * inverse[1][0], gx * inverse[0][1] + gy * inverse[1][1]];
        let place = cell.enter(slots[k]);
        for axis in 0..2 {
            cell.b[place][axis] += volume * g[axis];
            cell.c[place][axis] += row[2 * axis] * g[0] + row[2 * axis + 1] * g[1];
        }
        cell.a[place][0] += dev[0] * g[0] + dev[2] * g[1];
        cell.a[place][1] += dev[2] * g[0] + dev[1] * g[1];
    }
    cell.s += trace;
}

/// M -> Q M Q.
fn project(m: &mut Moduli3) {
    for i in 0..LANES {
        for row in m.iter_mut() {
            let mean = 0.5 * (row[0][i] + row[3][i]);
            row[0][i] -= mean;
            row[3][i] -= mean;
        }
        for k in 0..4 {
            let mean = 0.5 * (m[0][k][i] + m[1][k][i]);
            m[0][k][i] -= mean;
            m[1][k][i] -= mean;
        }
    }
}

/// a (x) b + 1/2 b (x) c + 1/2 s b (x) b into the tangent.
fn add(system: &mut System, cell: &Cell) {
    let w = 1.0 / cell.volume;
    for j in 0..cell.nodes {
        for i in 0..cell.nodes {
            let at = system.block(cell.slots[i] as usize, cell.slots[j] as usize);
            for column in 0..2 {
                let bj = w * cell.b[j][column];
                for row in 0..2 {
                    let bi = w * cell.b[i][row];
                    let value = cell.a[i][row] * bj + 0.5 * bi * (cell.c[j][column] + cell.s * bj);
                    system.values[at.0 + row + column * at.1] += value;
                }
            }
        }
    }
}
