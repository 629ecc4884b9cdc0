//! Subdivision on finer rows or columns, which are then averaged.
//!
//! Where one scale of fluctuation is much longer than the other, square cells lose correlation along it:
//! a neighbourhood of 3 x 3 parents is then short. Cells that are finer along the short scale are
//! alike in the scaled lag, and their means are the local averages that are asked for.

use super::{
    correlation::Correlation,
    las::{self, Las},
    map::{Map, Scratch, first},
    normals::Source,
    table::{Lattice, Table},
};

/// Local average subdivision of a lattice with `finer` times as many cells along each axis.
pub struct Squash {
    las: Las,
    /// Cells asked for.
    cells: [usize; 2],
    finer: [usize; 2],
}

impl Squash {
    /// Cells `finer` times finer along each axis, at most `limit` of them in stage 0; `None` if a covariance
    /// has no factor.
    pub fn new(c: &Correlation, lattice: &Lattice, finer: [usize; 2], limit: usize) -> Option<Squash> {
        let cells = [0, 1].map(|k| lattice.cells[k] * finer[k]);
        let cell = [0, 1].map(|k| lattice.cell[k] / finer[k] as f64);
        let table = Table::new(c, cell, las::lags(&las::plan(cells, limit)));
        Some(Squash { las: Las::new(&table, cells, limit)?, cells: lattice.cells, finer })
    }

    fn share(&self) -> f64 {
        1.0 / (self.finer[0] * self.finer[1]) as f64
    }
}

impl Map for Squash {
    fn cells(&self) -> usize {
        self.cells[0] * self.cells[1]
    }

    fn normals(&self) -> usize {
        self.las.normals()
    }

    fn apply(&self, source: &mut dyn Source, scratch: &mut Scratch, z: &mut [f64]) {
        if self.finer == [1, 1] {
            return self.las.apply(source, scratch, z);
        }
        let mut fine = std::mem::take(&mut scratch.fine);
        self.las.apply(source, scratch, first(&mut fine, self.las.cells()));
        let width = self.cells[0] * self.finer[0];
        for (z, rows) in z.chunks_mut(self.cells[0]).zip(fine.chunks(width * self.finer[1])) {
            z.fill(0.0);
            for row in rows.chunks(width) {
                z.iter_mut().zip(row.chunks(self.finer[0])).for_each(|(z, part)| *z += part.iter().sum::<f64>());
            }
            z.iter_mut().for_each(|z| *z *= self.share());
        }
        scratch.fine = fine;
    }

    fn adjoint(&self, z: &[f64], scratch: &mut Scratch, u: &mut [f64]) {
        let mut fine = std::mem::take(&mut scratch.fine);
        let width = self.cells[0] * self.finer[0];
        let cells = first(&mut fine, self.las.cells());
        for (z, rows) in z.chunks(self.cells[0]).zip(cells.chunks_mut(width * self.finer[1])) {
            for row in rows.chunks_mut(width) {
                row.chunks_mut(self.finer[0]).zip(z).for_each(|(part, z)| part.fill(z * self.share()));
            }
        }
        self.las.adjoint(cells, scratch, u);
        scratch.fine = fine;
    }

    fn mirrors(&self) -> [bool; 2] {
        self.las.mirrors()
    }
}
