//! Means over the cells of the grid, against volumetric locking in the explicit scheme.
//!
//! With <.> the mean over the points of a cell, weighted with their initial volumes, theta the dilatation of a
//! step and t = J sigma,
//! ```text
//! e' = e + 1/2 (<theta> - theta) I,   sigma' = sigma + 1/2 (<tr t> / J - tr sigma) I
//! ```
//! in the plane: strain and internal force are those of [`super::smooth`], in which the forces derive from the
//! energy of e'. Points count to the cells of their committed places in both passes of a step.

use std::ops::Range;

use crate::{
    block::{Block, Law},
    body::Body,
    space::{
        Grid,
        stencil::{LANES, Lane},
    },
};

/// One mean over each cell that holds points.
#[derive(Default)]
pub struct CellMeans {
    /// Sums of V0 and of V0 times the quantity, by cell.
    sums: Vec<[f64; 2]>,
    seen: Vec<u32>,
    /// Cell of each point of a block.
    cell: [u32; LANES],
}

impl CellMeans {
    /// For a grid; 16 bytes a cell.
    pub fn new(grid: &Grid) -> Self {
        let cells = grid.cells[0] as usize * grid.cells[1] as usize;
        CellMeans { sums: vec![[0.0; 2]; cells], seen: Vec::with_capacity(cells), cell: [0; LANES] }
    }

    /// Forgets the last quantity.
    pub fn begin(&mut self) {
        self.seen.drain(..).for_each(|c| self.sums[c as usize] = [0.0; 2]);
    }

    /// Finds the cells of the points of a block.
    fn locate(&mut self, grid: &Grid, [x, y]: &[Lane; 2], len: usize) {
        for i in 0..len {
            let [cx, cy] = [(0, x[i]), (1, y[i])]
                .map(|(a, x)| (((x - grid.origin[a]) / grid.h) as u32).min(grid.cells[a].saturating_sub(1)));
            self.cell[i] = cy * grid.cells[0] + cx;
        }
    }

    /// Adds a quantity of the points of a block; `range` is their stretch of the body's columns.
    pub fn add(&mut self, grid: &Grid, x: &[Lane; 2], body: &Body, range: &Range<usize>, quantity: &Lane) {
        self.locate(grid, x, range.len());
        for (lane, i) in range.clone().enumerate() {
            let sum = &mut self.sums[self.cell[lane] as usize];
            if sum[0] == 0.0 {
                self.seen.push(self.cell[lane]);
            }
            sum[0] += body.volume[i];
            sum[1] += body.volume[i] * quantity[lane];
        }
    }

    /// The mean of the cell of each point of a block.
    fn means(&mut self, grid: &Grid, x: &[Lane; 2], len: usize) -> Lane {
        self.locate(grid, x, len);
        let mut means = [0.0; LANES];
        for (mean, cell) in means[..len].iter_mut().zip(&self.cell) {
            let [volume, sum] = self.sums[*cell as usize];
            *mean = sum / volume;
        }
        means
    }

    /// Gives each point of the block the mean dilatation of its cell.
    pub fn level_strain(&mut self, grid: &Grid, x: &[Lane; 2], law: &dyn Law, block: &mut Block, len: usize) {
        let mut by = self.means(grid, x, len);
        let mut own = [0.0; LANES];
        block.len = len;
        law.dilatation(block, &mut own);
        by.iter_mut().zip(own).for_each(|(mean, own)| *mean -= own);
        law.dilate(block, &by);
    }

    /// Gives each point of the block the mean of tr(J sigma) of its cell.
    pub fn level_stress(&mut self, grid: &Grid, x: &[Lane; 2], block: &mut Block, len: usize) {
        let means = self.means(grid, x, len);
        for i in 0..len {
            let shift = 0.5 * (means[i] / block.jacobian[i] - block.stress[0][i] - block.stress[1][i]);
            block.stress[0][i] += shift;
            block.stress[1][i] += shift;
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        16 * self.sums.capacity() + 4 * self.seen.capacity()
    }
}

/// tr(J sigma) in the plane, of the stress in the block (kPa).
pub fn trace(block: &Block) -> Lane {
    std::array::from_fn(|i| block.jacobian[i] * (block.stress[0][i] + block.stress[1][i]))
}
