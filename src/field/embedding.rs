//! Circulant embedding: the covariances of the lattice as a corner of those of a periodic plane, whose
//! eigenvectors are known.
//!
//! The plane has M1 x M2 cells; two of its cells, i and j columns and rows apart, have the covariance of
//! local averages at the lag (min(i, M1 - i), min(j, M2 - j)). That is a circulant matrix; its eigenvalues are
//! the discrete Fourier transform of its first row,
//! ```text
//! lambda_k = sum_x C_x exp(-2 pi i k.x / M),        M = M1 M2,  k.x / M = k1 x1 / M1 + k2 x2 / M2
//! ```
//! and, as `lambda_k = lambda_-k`, the real functions cas = cos + sin serve as eigenvectors beside the complex ones. So
//! ```text
//! Z_x = sum_k sqrt(lambda_k / M) u_k cas(2 pi k.x / M) = Re F - Im F,    F = transform of sqrt(lambda / M) u
//! ```
//! has that covariance exactly. One transform takes M real normals and gives one field: the real and the
//! imaginary part, usually two fields of 2 M normals, are both used, and a realisation has a stream of its own.
//!
//! Where an eigenvalue is negative there is no such field. What is negative is left out, and what this does to the
//! covariance follows from the spectrum that is left; the plane grows until it does nothing that counts.
//!
//! Source: Dietrich & Newsam (1997), SIAM J. Sci. Comput. 18, 1088-1107; Wood & Chan (1994), J. Comput. Graph.
//! Stat. 3, 409-432; cas: Bracewell (1983), J. Opt. Soc. Am. 73, 1832-1835.

use std::sync::Arc;

use rustfft::{Fft, FftPlanner, num_complex::Complex};

use super::{
    correlation::Correlation,
    generator::Accuracy,
    map::{Map, Scratch, first},
    normals::Source,
    table::{Lattice, Table},
};

/// Half a period in scales of fluctuation: what is tried, one after the other. At 0 it is the size of the lattice.
const REACH: [f64; 10] = [0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0];

/// Most cells of the smallest plane; its transform then takes some 300 MB.
const MOST_CELLS: usize = 1 << 24;

/// Most cells of a larger plane: half a second for a field.
const MOST_BESIDE: usize = 1 << 22;

/// Errors of correlation and variance that need no larger plane: the standard error of a statistic over 10^10 fields.
const NEGLIGIBLE: f64 = 1e-5;

/// A field by circulant embedding: a linear map of [`Embedding::normals`] normals to the cells of a lattice.
pub struct Embedding {
    lattice: Lattice,
    plane: Plane,
    /// sqrt(lambda / M) for the wave numbers 0..=M1/2 and 0..=M2/2, x fastest.
    amplitude: Vec<f64>,
    fit: Fit,
}

/// How well the covariances of an [`Embedding`] agree with those asked for; exact, not sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Sum of the eigenvalues left out over that of all.
    pub clipped: f64,
    /// Largest error of a correlation between two cells.
    pub correlation_error: f64,
    /// Its lag (cells).
    pub at_lag: [usize; 2],
    /// Relative error of the variance.
    pub variance_error: f64,
}

impl Fit {
    /// The larger of both errors.
    fn worst(&self) -> f64 {
        self.correlation_error.max(self.variance_error)
    }
}

impl Embedding {
    /// The embedding of local averages over a lattice: in the smallest plane whose errors are below 1e-5, or else in the
    /// best that is not too large.
    ///
    /// # Errors
    /// Cells of the smallest plane, if these are more than 2^24.
    pub fn new(correlation: &Correlation, lattice: &Lattice) -> Result<Embedding, f64> {
        let mut best: Option<Embedding> = None;
        let most = |reach: f64| if reach == 0.0 { MOST_CELLS } else { MOST_BESIDE };
        let plane = |reach: &f64| periods(correlation, lattice, *reach, most(*reach));
        let mut planes: Vec<_> = REACH.iter().map_while(plane).collect();
        planes.dedup();
        for plane in planes {
            let found = Embedding::with_periods(correlation, lattice, plane);
            if best.as_ref().is_none_or(|b| found.fit.worst() < b.fit.worst()) {
                best = Some(found);
            }
            if best.as_ref().is_some_and(|b| b.fit.worst() <= NEGLIGIBLE) {
                break;
            }
        }
        best.ok_or_else(|| [0, 1].map(|k| wanted(correlation, lattice, REACH[0], k)).iter().product())
    }

    fn with_periods(correlation: &Correlation, lattice: &Lattice, periods: [usize; 2]) -> Embedding {
        let table = Table::new(correlation, lattice.cell, periods.map(|m| m / 2 + 1));
        let plane = Plane::new(periods);
        let mut room = Room::default();
        let mut spectrum = plane.even(&mut room, |i, j| table.at(i, j));
        let (mut kept, mut clipped) = (0.0, 0.0);
        for (k, lambda) in spectrum.iter_mut().enumerate() {
            let share = plane.copies(k) * *lambda;
            if share > 0.0 {
                kept += share
            } else {
                clipped -= share
            }
            *lambda = lambda.max(0.0);
        }
        let implied = plane.even(&mut room, |i, j| spectrum[plane.at(i, j)]);
        let fit = plane.compare(&table, &implied, lattice.cells, clipped / (kept + clipped));
        let amplitude = spectrum.iter().map(|lambda| (lambda / plane.cells()).sqrt()).collect();
        Embedding { lattice: *lattice, plane, amplitude, fit }
    }

    /// How well the covariances agree.
    pub fn fit(&self) -> &Fit {
        &self.fit
    }

    /// The same as the accuracy of a generator.
    pub fn accuracy(&self) -> Accuracy {
        Accuracy {
            correlation_error: self.fit.correlation_error,
            at_lag_m: [0, 1].map(|k| self.fit.at_lag[k] as f64 * self.lattice.cell[k]),
            variance_error: self.fit.variance_error,
            exact: true,
            checked: self.lattice.len(),
        }
    }

    /// One sentence on what it is.
    pub fn words(&self) -> String {
        let [wide, high] = self.plane.periods;
        let [x, z] = [0, 1].map(|k| self.plane.periods[k] as f64 * self.lattice.cell[k]);
        let fit = if self.fit.worst() <= NEGLIGIBLE {
            "the smallest that is exact to 1e-5"
        } else {
            "the best that is not too large"
        };
        format!("circulant embedding in a periodic plane of {wide} x {high} cells ({x} x {z} m), {fit}")
    }

    /// Cells of the periodic plane along x and the vertical.
    pub fn periods(&self) -> [usize; 2] {
        self.plane.periods
    }
}

impl Map for Embedding {
    fn cells(&self) -> usize {
        self.lattice.len()
    }

    fn normals(&self) -> usize {
        self.plane.periods[0] * self.plane.periods[1]
    }

    fn apply(&self, source: &mut dyn Source, scratch: &mut Scratch, z: &mut [f64]) {
        let [wide, high] = self.plane.periods;
        let Scratch { normals, plane: room, .. } = scratch;
        let normals = first(normals, wide);
        self.plane.transform(room, self.lattice.cells[0].min(wide), |j, row| {
            source.fill(normals);
            for (i, (value, u)) in row.iter_mut().zip(normals.iter()).enumerate() {
                *value = Complex::new(u * self.amplitude[self.plane.at(i, j)], 0.0);
            }
        });
        for (j, row) in z.chunks_mut(self.lattice.cells[0].max(1)).take(self.lattice.cells[1]).enumerate() {
            for (i, value) in row.iter_mut().enumerate() {
                *value = cas(room.columns[(i % wide) * high + j % high]);
            }
        }
    }

    fn adjoint(&self, z: &[f64], scratch: &mut Scratch, u: &mut [f64]) {
        let [wide, high] = self.plane.periods;
        let room = &mut scratch.plane;
        self.plane.transform(room, wide, |j, row| {
            row.fill(Complex::new(0.0, 0.0));
            // more than one row and one value only where a period is a single cell
            for values in z.chunks(self.lattice.cells[0].max(1)).skip(j).step_by(high) {
                values.iter().enumerate().for_each(|(i, value)| row[i % wide].re += value);
            }
        });
        for (j, row) in u.chunks_mut(wide).take(high).enumerate() {
            for (i, u) in row.iter_mut().enumerate() {
                *u = self.amplitude[self.plane.at(i, j)] * cas(room.columns[i * high + j]);
            }
        }
    }

    fn mirrors(&self) -> [bool; 2] {
        [true, true]
    }
}

/// The sum with cas = cos + sin in place of exp(-i ...), of real numbers; -k in place of k, which is the same.
fn cas(transform: Complex<f64>) -> f64 {
    transform.re - transform.im
}

/// Cells of a period along axis `k` for half a period of `reach` scales, at least twice the lattice.
fn wanted(correlation: &Correlation, lattice: &Lattice, reach: f64, k: usize) -> f64 {
    // one cell needs no period, and serves all where the field is constant along the axis
    if lattice.cells[k] == 1 || correlation.theta[k].is_infinite() {
        return 1.0;
    }
    (2.0 * lattice.cells[k] as f64 - 1.0).max(2.0 * reach * correlation.theta[k] / lattice.cell[k])
}

/// Periods along both axes that a transform likes; `None` for more than `most` cells.
fn periods(correlation: &Correlation, lattice: &Lattice, reach: f64, most: usize) -> Option<[usize; 2]> {
    let wanted = [0, 1].map(|k| wanted(correlation, lattice, reach, k).ceil());
    let small = wanted[0] * wanted[1] <= most as f64;
    let periods = small.then(|| wanted.map(|m| smooth(m as usize)))?;
    (periods[0] * periods[1] <= most).then_some(periods)
}

/// The smallest number from `least` on with no prime factor above 5.
fn smooth(least: usize) -> usize {
    let without = |n: usize, p: usize| std::iter::successors(Some(n), |n| n.is_multiple_of(p).then(|| n / p)).last();
    let rough = |n: usize| [2, 3, 5].into_iter().fold(n, |n, p| without(n, p).unwrap_or(n));
    (least.max(1)..).find(|&n| rough(n) == 1).unwrap_or(least)
}

/// Transforms of a periodic plane.
struct Plane {
    periods: [usize; 2],
    rows: Arc<dyn Fft<f64>>,
    columns: Arc<dyn Fft<f64>>,
}

/// What a transform works in; it grows with the first and is kept.
#[derive(Default)]
pub(super) struct Room {
    row: Vec<Complex<f64>>,
    /// Column by column: the value of column i and row j at `i M2 + j`.
    columns: Vec<Complex<f64>>,
    work: Vec<Complex<f64>>,
}

impl Plane {
    fn new(periods: [usize; 2]) -> Self {
        let mut planner = FftPlanner::new();
        let [rows, columns] = periods.map(|m| planner.plan_fft_forward(m));
        Plane { periods, rows, columns }
    }

    fn cells(&self) -> f64 {
        self.periods[0] as f64 * self.periods[1] as f64
    }

    /// Place of a cell or wave number in a table of the quarter 0..=M1/2, 0..=M2/2 of an even function.
    fn at(&self, i: usize, j: usize) -> usize {
        let [i, j] = [i.min(self.periods[0] - i), j.min(self.periods[1] - j)];
        j * (self.periods[0] / 2 + 1) + i
    }

    /// Times that entry `k` of such a table stands in the plane.
    fn copies(&self, k: usize) -> f64 {
        let width = self.periods[0] / 2 + 1;
        let once = |i: usize, period: usize| i == 0 || 2 * i == period;
        let times = |i: usize, period: usize| if once(i, period) { 1.0 } else { 2.0 };
        times(k % width, self.periods[0]) * times(k / width, self.periods[1])
    }

    /// The transform of the rows that `fill` writes; of its columns the first `keep` are left in `room.columns`.
    fn transform(&self, room: &mut Room, keep: usize, mut fill: impl FnMut(usize, &mut [Complex<f64>])) {
        let [wide, high] = self.periods;
        let zero = Complex::new(0.0, 0.0);
        room.row.resize(wide, zero);
        room.columns.resize(keep * high, zero);
        let work = self.rows.get_inplace_scratch_len().max(self.columns.get_inplace_scratch_len());
        room.work.resize(work, zero);
        for j in 0..high {
            fill(j, &mut room.row);
            self.rows.process_with_scratch(&mut room.row, &mut room.work);
            room.row.iter().take(keep).enumerate().for_each(|(i, z)| room.columns[i * high + j] = *z);
        }
        self.columns.process_with_scratch(&mut room.columns, &mut room.work);
    }

    /// The transform of an even function given on the quarter, again on the quarter: real and even too.
    fn even(&self, room: &mut Room, value: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let [wide, high] = self.periods;
        let width = wide / 2 + 1;
        self.transform(room, width, |j, row| {
            let j = j.min(high - j);
            row.iter_mut().enumerate().for_each(|(i, z)| *z = Complex::new(value(i.min(wide - i), j), 0.0));
        });
        let rows = 0..=high / 2;
        rows.flat_map(|j| (0..width).map(move |i| (i, j))).map(|(i, j)| room.columns[i * high + j].re).collect()
    }

    /// The covariances that a spectrum implies, `implied` over M, against those of the table, for all pairs of cells.
    fn compare(&self, table: &Table, implied: &[f64], cells: [usize; 2], clipped: f64) -> Fit {
        let (variance, exact) = (implied[0] / self.cells(), table.at(0, 0));
        let mut fit =
            Fit { clipped, correlation_error: 0.0, at_lag: [0, 0], variance_error: (variance / exact - 1.0).abs() };
        let lags = [0, 1].map(|k| cells[k].min(self.periods[k]));
        for (i, j) in (0..lags[1]).flat_map(|j| (0..lags[0]).map(move |i| (i, j))) {
            let error = (implied[self.at(i, j)] / implied[0] - table.at(i, j) / exact).abs();
            // a NaN enters, and stays
            if error.is_nan() || error > fit.correlation_error {
                (fit.correlation_error, fit.at_lag) = (error, [i, j]);
            }
        }
        fit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{
        correlation::Family,
        normals::{Given, Normals},
    };

    const FAMILIES: [Family; 4] = [Family::Markov, Family::MarkovSeparable, Family::Gaussian, Family::Spherical];

    fn embedding(family: Family, theta: [f64; 2], cells: [usize; 2]) -> (Embedding, Table) {
        let (correlation, lattice) = (Correlation { family, theta }, Lattice { cell: [0.25, 0.25], cells });
        (Embedding::new(&correlation, &lattice).unwrap(), Table::new(&correlation, lattice.cell, cells))
    }

    /// The map as a matrix, a row for each cell: the fields of all unit vectors.
    fn matrix(embedding: &Embedding, cells: usize) -> Vec<Vec<f64>> {
        let (mut rows, mut out) = (vec![Vec::new(); cells], vec![0.0; cells]);
        let mut scratch = Scratch::default();
        for k in 0..embedding.normals() {
            let mut unit = vec![0.0; embedding.normals()];
            unit[k] = 1.0;
            embedding.apply(&mut Given(&unit), &mut scratch, &mut out);
            rows.iter_mut().zip(&out).for_each(|(row, value)| row.push(*value));
        }
        rows
    }

    /// M M^T is the table, but for what the fit says was left out; rounding of some hundred terms.
    #[test]
    fn the_map_has_the_covariances_of_the_table() {
        for family in FAMILIES {
            for theta in [[1.0, 1.0], [0.4, 3.0], [f64::INFINITY, 1.0]] {
                let cells = [5, 3];
                let (embedding, table) = embedding(family, theta, cells);
                let rows = matrix(&embedding, 15);
                let bound = 1e-12 + 2.0 * embedding.fit().worst();
                for (a, b) in (0..15).flat_map(|a| (0..15).map(move |b| (a, b))) {
                    let implied: f64 = rows[a].iter().zip(&rows[b]).map(|(x, y)| x * y).sum();
                    let target = table.at((a % 5_usize).abs_diff(b % 5), (a / 5_usize).abs_diff(b / 5));
                    assert!((implied - target).abs() < bound, "{family:?} {theta:?} {a} {b}: {implied} {target}");
                }
            }
        }
    }

    /// (W u) . z = u . (W^T z) to rounding.
    #[test]
    fn the_adjoint_is_the_transpose() {
        for theta in [[6.0, 0.7], [f64::INFINITY, 1.0]] {
            let (embedding, _) = embedding(Family::Markov, theta, [7, 5]);
            let (mut scratch, mut field) = (Scratch::default(), vec![0.0; 35]);
            let (mut u, mut z, mut back) =
                (vec![0.0; embedding.normals()], vec![0.0; 35], vec![0.0; embedding.normals()]);
            Normals::new(1, 0, "u", false).fill(&mut u);
            Normals::new(1, 0, "z", false).fill(&mut z);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            embedding.apply(&mut Given(&u), &mut scratch, &mut field);
            embedding.adjoint(&z, &mut scratch, &mut back);
            assert!((dot(&field, &z) - dot(&u, &back)).abs() < 1e-12 * dot(&u, &u), "{theta:?}");
        }
    }

    /// The slope of the paper: exact where theta is short, and to 1e-5 with a period of 288 m at theta = 48 m.
    #[test]
    fn the_box_of_the_slope() {
        for (theta, bound) in [(1.0, 1e-12), (6.0, 1e-12), (48.0, NEGLIGIBLE)] {
            let (embedding, _) = embedding(Family::Markov, [theta, 1.0], [100, 20]);
            let fit = embedding.fit();
            assert!(fit.worst() <= bound, "theta {theta}: {fit:?}");
            assert!(embedding.normals() <= 1152 * 40, "{:?}", embedding.periods());
        }
    }

    /// One row, one cell, scales far above and far below a cell.
    #[test]
    fn any_lattice() {
        for family in FAMILIES {
            for (cells, theta) in
                [([1, 1], [1.0, 1.0]), ([1, 37], [6.0, 0.3]), ([50, 1], [1e4, 1e4]), ([13, 7], [1e-3, 5.0])]
            {
                let (embedding, _) = embedding(family, theta, cells);
                assert!(embedding.fit().worst() <= NEGLIGIBLE, "{family:?} {cells:?} {theta:?}: {:?}", embedding.fit());
            }
        }
    }

    /// A scale of a hundred times the slope, far too large for a plane that holds it: the errors are found and stated.
    #[test]
    fn a_scale_beyond_any_plane_has_small_errors_that_are_known() {
        let (embedding, _) = embedding(Family::Markov, [500.0, 500.0], [100, 20]);
        let fit = embedding.fit();
        assert!(fit.worst() > NEGLIGIBLE && fit.worst() < 0.01 && fit.clipped > 0.0, "{fit:?}");
    }

    #[test]
    fn a_plane_that_is_too_large_is_refused_with_its_cells() {
        let correlation = Correlation { family: Family::Markov, theta: [1.0, 1.0] };
        let found = Embedding::new(&correlation, &Lattice { cell: [0.1, 0.1], cells: [4000, 4000] });
        assert_eq!(found.err(), Some(7999.0 * 7999.0));
    }

    /// 4000 fields: variance and two correlations within four standard errors, which are those of sums of products of
    /// normals, sqrt((1 + rho^2) / n), for one pair of cells a field.
    #[test]
    fn fields_have_the_statistics_of_the_table() {
        const FIELDS: u32 = 4000;
        let (embedding, table) = embedding(Family::Markov, [6.0, 1.0], [40, 20]);
        let (mut scratch, mut out) = (Scratch::default(), vec![0.0; 800]);
        let pairs: [([usize; 2], usize); 4] = [([0, 0], 0), ([8, 0], 8), ([0, 2], 80), ([39, 19], 799)];
        let (mut sums, mut mean) = ([0.0; 4], 0.0);
        for k in 0..FIELDS {
            embedding.apply(&mut Normals::new(5, u64::from(k), "c", false), &mut scratch, &mut out);
            mean += out[400] / f64::from(FIELDS);
            pairs.iter().zip(&mut sums).for_each(|((_, cell), sum)| *sum += out[0] * out[*cell] / f64::from(FIELDS));
        }
        let (variance, n) = (table.at(0, 0), f64::from(FIELDS).sqrt());
        assert!(mean.abs() < 4.0 * variance.sqrt() / n, "{mean}");
        for (([i, j], _), sum) in pairs.iter().zip(sums) {
            let rho = table.at(*i, *j) / variance;
            let error = variance * (1.0 + rho * rho).sqrt() / n;
            assert!((sum - table.at(*i, *j)).abs() < 4.0 * error, "lag {i} {j}: {sum} of {}", table.at(*i, *j));
        }
    }
}
