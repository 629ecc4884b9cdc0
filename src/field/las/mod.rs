//! Local average subdivision (Fenton and Vanmarcke 1990) on a lattice of any size.
//!
//! Stage 0 is exact on few cells. Each later stage splits every cell into 2 x 2 cells that have the right
//! covariance among themselves and with the neighbourhood of their parent, and whose mean is the parent.
//! A stage has half the cells of the next, rounded up: what lies outside the next one is not made.
//! Neighbourhoods have 9 parents, 6 at sides, 4 at corners, fewer in lattices of one row or column.

mod row;
mod split;
#[cfg(test)]
mod tests;

use self::{
    row::{Row, gather, kind},
    split::{DRAWN, Split},
};
use super::{
    exact::Factor,
    map::{Map, Scratch, first},
    normals::Source,
    table::Table,
};
use crate::math::simd::FpPath;

/// Cells of stage 0 in Fenton's program.
pub const FENTON: usize = 256;

/// From one stage to the next.
struct Stage {
    parents: [usize; 2],
    children: [usize; 2],
    /// By kind along the vertical, then along x.
    splits: [[Split; 4]; 4],
}

/// A generator by subdivision.
pub struct Las {
    root: Factor,
    stages: Vec<Stage>,
    cells: [usize; 2],
    normals: usize,
}

/// Cells of each stage, the first with at most `limit` (at least 1) and as many as that allows.
pub fn plan(cells: [usize; 2], limit: usize) -> Vec<[usize; 2]> {
    let mut stages = vec![cells];
    let mut first = cells;
    while first[0] * first[1] > limit.max(1) {
        first = first.map(|n| n.div_ceil(2));
        stages.push(first);
    }
    stages.reverse();
    stages
}

/// Lags that the table of the finest cells must have for these stages: those of the first stage, and
/// those between a child and the neighbours of its parent.
pub fn lags(plan: &[[usize; 2]]) -> [usize; 2] {
    let first = plan.first().copied().unwrap_or_default();
    first.map(|n| n.max(3) << (plan.len().max(1) - 1))
}

impl Las {
    /// For a lattice of `cells`, with at most `limit` cells in stage 0. The table must have the [`lags`] of
    /// the [`plan`]. `None` if a covariance has no factor.
    pub fn new(table: &Table, cells: [usize; 2], limit: usize) -> Option<Las> {
        let plan = plan(cells, limit);
        let mut stages = Vec::with_capacity(plan.len());
        let mut fine = table.clone();
        for pair in plan.windows(2).rev() {
            let coarse = fine.coarser();
            stages.push(Stage::new(&coarse, &fine, pair[0], pair[1])?);
            fine = coarse;
        }
        stages.reverse();
        let root = plan.first().copied().unwrap_or_default();
        let drawn: usize = stages.iter().map(|s| DRAWN * s.parents[0] * s.parents[1]).sum();
        let normals = root[0] * root[1] + drawn;
        Some(Las { root: Factor::of_lattice(&fine, root)?, stages, cells, normals })
    }

    /// A realisation and the same one a stage earlier, on half the cells (rounded up): where all four
    /// children lie in the lattice, a cell of `coarse` is their mean to rounding. Without stages, `coarse` is empty.
    pub fn sample_pair(&self, source: &mut dyn Source, scratch: &mut Scratch, coarse: &mut Vec<f64>, fine: &mut [f64]) {
        self.apply(source, scratch, fine);
        let n = self.stages.last().map_or(0, |s| s.parents[0] * s.parents[1]);
        coarse.clear();
        coarse.extend_from_slice(&scratch.stages[0][..n]);
    }

    fn root_cells(&self) -> usize {
        self.stages.first().map_or(self.cells, |s| s.parents).iter().product()
    }
}

impl Stage {
    fn new(coarse: &Table, fine: &Table, parents: [usize; 2], children: [usize; 2]) -> Option<Stage> {
        let sides = |kind: usize| [kind & 1 != 0, kind & 2 != 0];
        let mut splits = [[Split { a: Default::default(), c: Default::default() }; 4]; 4];
        for (z, row) in splits.iter_mut().enumerate() {
            for (x, split) in row.iter_mut().enumerate() {
                *split = Split::new(coarse, fine, [sides(x), sides(z)])?;
            }
        }
        Some(Stage { parents, children, splits })
    }

    /// The rows around row `j` of the parents; at a side the row itself stands for the one that is not there.
    fn around(&self, j: usize) -> [usize; 3] {
        [j.saturating_sub(1), j, (j + 1).min(self.parents[1] - 1)]
    }

    fn split(
        &self,
        source: &mut dyn Source,
        normals: &mut Vec<f64>,
        spare: &mut Vec<f64>,
        parents: &[f64],
        out: &mut [f64],
    ) {
        let [n, rows] = self.parents;
        let width = self.children[0];
        let path = FpPath::best();
        let (normals, spare) = (first(normals, DRAWN * n), first(spare, width));
        for (j, pair) in out.chunks_mut(2 * width).enumerate() {
            source.fill(normals);
            let (low, high) = pair.split_at_mut(width);
            path.run(Row {
                splits: &self.splits[kind(j, rows)],
                parents: self.around(j).map(|r| &parents[r * n..(r + 1) * n]),
                normals: [0, 1, 2].map(|k| &normals[k * n..(k + 1) * n]),
                children: [low, if high.is_empty() { spare } else { high }],
            });
        }
    }

    /// From what children get to what parents (added to) and normals get.
    fn adjoint(&self, children: &[f64], parents: &mut [f64], normals: &mut [f64]) {
        let [n, rows] = self.parents;
        for j in 0..rows {
            let around = self.around(j);
            for i in 0..n {
                let columns = [i.saturating_sub(1), i, (i + 1).min(n - 1)];
                let split = &self.splits[kind(j, rows)][kind(i, n)];
                let add = |q: usize, value: f64| parents[around[q / 3] * n + columns[q % 3]] += value;
                let u = gather(split, self.four(children, i, j), add);
                (0..DRAWN).for_each(|k| normals[(DRAWN * j + k) * n + i] = u[k]);
            }
        }
    }

    /// The children of a parent; 0 for those outside the lattice.
    fn four(&self, children: &[f64], i: usize, j: usize) -> [f64; 4] {
        let [width, height] = self.children;
        std::array::from_fn(|k| {
            let (x, z) = (2 * i + k % 2, 2 * j + k / 2);
            if x < width && z < height { children[z * width + x] } else { 0.0 }
        })
    }
}

impl Map for Las {
    fn cells(&self) -> usize {
        self.cells[0] * self.cells[1]
    }

    fn normals(&self) -> usize {
        self.normals
    }

    fn apply(&self, source: &mut dyn Source, scratch: &mut Scratch, z: &mut [f64]) {
        let n = self.root_cells();
        let Scratch { normals, stages: [now, next], row, .. } = scratch;
        source.fill(first(normals, n));
        let Some((last, earlier)) = self.stages.split_last() else {
            return self.root.apply(normals, z);
        };
        self.root.apply(normals, first(now, n));
        for stage in earlier {
            stage.split(source, normals, row, now, first(next, stage.children[0] * stage.children[1]));
            std::mem::swap(now, next);
        }
        last.split(source, normals, row, now, &mut z[..last.children[0] * last.children[1]]);
    }

    fn adjoint(&self, z: &[f64], scratch: &mut Scratch, u: &mut [f64]) {
        let [now, next] = &mut scratch.stages;
        first(now, z.len()).copy_from_slice(z);
        let mut end = self.normals;
        for stage in self.stages.iter().rev() {
            let parents = stage.parents[0] * stage.parents[1];
            let start = end - DRAWN * parents;
            let next_part = first(next, parents);
            next_part.fill(0.0);
            stage.adjoint(now, next_part, &mut u[start..end]);
            std::mem::swap(now, next);
            end = start;
        }
        self.root.adjoint(now, &mut u[..end]);
    }

    /// An axis along which a stage is cut at its end has a near and a far side.
    fn mirrors(&self) -> [bool; 2] {
        [0, 1].map(|k| self.stages.iter().all(|s| s.children[k] == 2 * s.parents[k] || s.children[k] == 1))
    }
}
