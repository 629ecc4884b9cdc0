//! Fields by the Cholesky factor of the covariance of all cells.

use faer::{
    Mat, Par, Spec,
    dyn_stack::{MemBuffer, MemStack},
    linalg::cholesky::llt::factor::{LltParams, LltRegularization, cholesky_in_place, cholesky_in_place_scratch},
};

use super::{
    map::{Map, Scratch, first},
    normals::Source,
    table::Table,
};
use crate::math::simd::{FpPath, Kernel};

/// Shares of the variance that are added to the diagonal, in turn, until the factor exists: a smooth
/// correlation over many cells is singular to rounding.
const RIDGES: [f64; 4] = [0.0, 1e-12, 1e-10, 1e-8];
/// Sums that a dot product runs side by side.
const LANES: usize = 8;

/// The lower triangle L of a covariance L L^T, row by row.
pub(super) struct Factor {
    order: usize,
    rows: Vec<f64>,
}

impl Factor {
    /// Factor of a covariance; `None` if it has none, even with 1e-8 of its variance added to the diagonal.
    pub fn new(order: usize, covariance: impl Fn(usize, usize) -> f64) -> Option<Factor> {
        let variance = if order > 0 { covariance(0, 0) } else { 0.0 };
        let full = RIDGES.iter().find_map(|ridge| {
            let ridge = ridge * variance;
            factorise(Mat::from_fn(order, order, |i, j| covariance(i, j) + if i == j { ridge } else { 0.0 }))
        })?;
        let rows: Vec<f64> = (0..order).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| full[(i, j)]).collect();
        rows.iter().all(|v| v.is_finite()).then_some(Factor { order, rows })
    }

    /// The factor of the covariance of all cells of a lattice of `cells`.
    pub fn of_lattice(table: &Table, cells: [usize; 2]) -> Option<Factor> {
        let place = |c: usize| [c % cells[0], c / cells[0]];
        Factor::new(cells[0] * cells[1], |a, b| {
            let ([i, j], [k, l]) = (place(a), place(b));
            table.at(i.abs_diff(k), j.abs_diff(l))
        })
    }

    /// z = L u.
    pub fn apply(&self, u: &[f64], z: &mut [f64]) {
        FpPath::best().run(Product { rows: &self.rows, u, z: &mut z[..self.order] });
    }

    /// u = L^T z.
    pub fn adjoint(&self, z: &[f64], u: &mut [f64]) {
        u[..self.order].fill(0.0);
        let mut rest = &self.rows[..];
        for (i, z) in z[..self.order].iter().enumerate() {
            let (row, later) = rest.split_at(i + 1);
            u.iter_mut().zip(row).for_each(|(u, l)| *u += l * z);
            rest = later;
        }
    }
}

fn factorise(mut full: Mat<f64>) -> Option<Mat<f64>> {
    let params = Spec::<LltParams, f64>::default();
    let mut memory = MemBuffer::try_new(cholesky_in_place_scratch::<f64>(full.nrows(), Par::Seq, params)).ok()?;
    let stack = MemStack::new(&mut memory);
    cholesky_in_place(full.as_mut(), LltRegularization::default(), Par::Seq, stack, params).ok()?;
    Some(full)
}

/// Dot products of packed rows with the leading part of a vector.
struct Product<'a> {
    rows: &'a [f64],
    u: &'a [f64],
    z: &'a mut [f64],
}

impl Kernel for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let mut rest = self.rows;
        for (i, z) in self.z.iter_mut().enumerate() {
            let (row, later) = rest.split_at(i + 1);
            *z = dot(row, self.u);
            rest = later;
        }
    }
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let b = &b[..a.len()];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let tail: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; LANES];
    for (a, b) in a.zip(b) {
        for k in 0..LANES {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + tail
}

/// All cells at once: no error but that of a ridge of at most 1e-8.
pub struct Exact {
    factor: Factor,
}

impl Exact {
    /// For a lattice of `cells`, whose covariances `table` must hold at all lags; `None` if they have no factor.
    pub fn new(table: &Table, cells: [usize; 2]) -> Option<Exact> {
        Some(Exact { factor: Factor::of_lattice(table, cells)? })
    }
}

impl Map for Exact {
    fn cells(&self) -> usize {
        self.factor.order
    }

    fn normals(&self) -> usize {
        self.factor.order
    }

    fn apply(&self, source: &mut dyn Source, scratch: &mut Scratch, z: &mut [f64]) {
        let u = first(&mut scratch.normals, self.factor.order);
        source.fill(u);
        self.factor.apply(u, z);
    }

    fn adjoint(&self, z: &[f64], _: &mut Scratch, u: &mut [f64]) {
        self.factor.adjoint(z, u);
    }

    fn mirrors(&self) -> [bool; 2] {
        [true; 2]
    }
}
