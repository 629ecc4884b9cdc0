//! The covariance that a map implies, against the target: computed, not sampled.
//!
//! A map W of independent normals implies W W^T. Its column for a cell is W (W^T e), an adjoint and a map, so
//! that no matrix is stored and any lattice can be looked at, in all columns or in some.

use super::{
    generator::Accuracy,
    map::{Map, Scratch},
    normals::Given,
    table::{Lattice, Table},
};

/// Columns of W W^T, one at a time.
pub struct Columns<'a> {
    map: &'a dyn Map,
    scratch: Scratch,
    unit: Vec<f64>,
    normals: Vec<f64>,
    column: Vec<f64>,
}

impl<'a> Columns<'a> {
    pub fn new(map: &'a dyn Map) -> Self {
        let (unit, column) = (vec![0.0; map.cells()], vec![0.0; map.cells()]);
        Columns { map, scratch: Scratch::default(), unit, normals: vec![0.0; map.normals()], column }
    }

    /// Covariances of a cell with all cells.
    pub fn covariances(&mut self, cell: usize) -> &[f64] {
        self.unit[cell] = 1.0;
        self.map.adjoint(&self.unit, &mut self.scratch, &mut self.normals);
        self.unit[cell] = 0.0;
        self.map.apply(&mut Given(&self.normals), &mut self.scratch, &mut self.column);
        &self.column
    }

    /// Variance of a cell.
    pub fn variance(&mut self, cell: usize) -> f64 {
        self.unit[cell] = 1.0;
        self.map.adjoint(&self.unit, &mut self.scratch, &mut self.normals);
        self.unit[cell] = 0.0;
        self.normals.iter().map(|w| w * w).sum()
    }
}

/// Errors of the implied covariance in at most `most` columns, spread over the lattice; `target` must have
/// all its lags.
///
/// Implied covariances are divided by the target's variance, so that an error counts for what it does to a field
/// that is scaled by the target's deviation.
pub fn accuracy(map: &dyn Map, target: &Table, lattice: &Lattice, most: usize) -> Accuracy {
    let distinct = distinct(map, lattice);
    let columns = spread(&distinct, most);
    let mut implied = Columns::new(map);
    let mut worst = Accuracy {
        correlation_error: 0.0,
        at_lag_m: [0.0; 2],
        variance_error: 0.0,
        exact: true,
        checked: columns.len(),
    };
    for &cell in &columns {
        compare(implied.covariances(cell), cell, target, lattice, &mut worst);
    }
    if columns.len() == distinct.len() {
        worst.checked = lattice.len();
    }
    worst
}

/// Cells whose pairs [`correlations`] looks at, most; and cells times columns, beyond the first two.
const PAIRED: usize = 16;
const PAIRS: usize = 4_000_000;

/// Lowest and highest implied correlation at each lag (cells), less than the lattice, over the pairs that hold the
/// first cell or one of the others looked at.
pub fn correlations(map: &dyn Map, lattice: &Lattice, lags: &[[usize; 2]]) -> Vec<[f64; 2]> {
    let mut implied = Columns::new(map);
    let mut variances = vec![None; lattice.len()];
    let mut found = vec![[f64::INFINITY, f64::NEG_INFINITY]; lags.len()];
    let most = (PAIRS / lattice.len().max(1)).clamp(2, PAIRED);
    for cell in std::iter::once(0).chain(spread(&distinct(map, lattice), most)) {
        let column = implied.covariances(cell).to_vec();
        for (lag, extremes) in lags.iter().zip(&mut found) {
            let Some(other) = partner(cell, *lag, lattice) else { continue };
            let variance = *variances[other].get_or_insert_with(|| implied.variance(other));
            let correlation = column[other] / (column[cell] * variance).sqrt();
            *extremes = [extremes[0].min(correlation), extremes[1].max(correlation)];
        }
    }
    found
}

/// The cell at a lag to the right and above, or else to the left or below, if there is one.
fn partner(cell: usize, lag: [usize; 2], lattice: &Lattice) -> Option<usize> {
    let [x, z] = [cell % lattice.cells[0], cell / lattice.cells[0]];
    let at = |x: usize, k: usize| {
        let beyond = x.checked_add(lag[k]).filter(|x| *x < lattice.cells[k]);
        beyond.or_else(|| x.checked_sub(lag[k]))
    };
    Some(at(z, 1)? * lattice.cells[0] + at(x, 0)?)
}

/// Compares one column.
fn compare(column: &[f64], cell: usize, target: &Table, lattice: &Lattice, worst: &mut Accuracy) {
    let width = lattice.cells[0];
    let [x, z] = [cell % width, cell / width];
    for (j, row) in column.chunks(width).enumerate() {
        for (i, covariance) in row.iter().enumerate() {
            let lag = [i.abs_diff(x), j.abs_diff(z)];
            let error = ((covariance - target.at(lag[0], lag[1])) / target.at(0, 0)).abs();
            // what is no number counts as the largest error
            let error = if error.is_nan() { f64::INFINITY } else { error };
            if lag == [0, 0] {
                worst.variance_error = worst.variance_error.max(error);
            } else if error > worst.correlation_error {
                worst.correlation_error = error;
                worst.at_lag_m = [0, 1].map(|k| lag[k] as f64 * lattice.cell[k]);
            }
        }
    }
}

/// The cells that are not mirror images of others.
fn distinct(map: &dyn Map, lattice: &Lattice) -> Vec<usize> {
    let mirrors = map.mirrors();
    let [nx, nz] = [0, 1].map(|k| if mirrors[k] { lattice.cells[k].div_ceil(2) } else { lattice.cells[k] });
    (0..nz).flat_map(|j| (0..nx).map(move |i| j * lattice.cells[0] + i)).collect()
}

/// At most `most` of the cells, from the last one back in strides of about the golden section: the last
/// distinct cell is in the middle, beside the border between cells of all stages.
fn spread(cells: &[usize], most: usize) -> Vec<usize> {
    let n = cells.len();
    let count = most.min(n);
    let mut stride = ((n as f64 * 0.618_033_988_75) as usize).max(1);
    while gcd(stride, n) > 1 {
        stride += 1;
    }
    (0..count).map(|k| cells[n - 1 - (k * stride) % n]).collect()
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{
        correlation::{Correlation, Family},
        exact::Exact,
        las::Las,
        squash::Squash,
    };

    const PAPER: Lattice = Lattice { cell: [0.25, 0.25], cells: [100, 20] };

    fn paper(theta: f64, finer: usize, limit: usize) -> (Squash, Table) {
        let c = Correlation { family: Family::Markov, theta: [theta, 1.0] };
        (Squash::new(&c, &PAPER, [1, finer], limit).unwrap(), Table::new(&c, PAPER.cell, PAPER.cells))
    }

    fn maps() -> Vec<Box<dyn Map>> {
        let c = Correlation { family: Family::Markov, theta: [2.0, 1.0] };
        let lattice = Lattice { cell: [0.5, 0.25], cells: [7, 5] };
        let table = Table::new(&c, lattice.cell, [48, 48]);
        vec![
            Box::new(Exact::new(&table, lattice.cells).unwrap()),
            Box::new(Las::new(&table, lattice.cells, 4).unwrap()),
            Box::new(Squash::new(&c, &lattice, [1, 3], 8).unwrap()),
            Box::new(Squash::new(&c, &lattice, [2, 1], 8).unwrap()),
        ]
    }

    /// The matrix W from unit vectors; W W^T against the columns, to rounding.
    #[test]
    fn columns_are_those_of_the_map_of_unit_vectors() {
        for map in maps() {
            let mut scratch = Scratch::default();
            let mut unit = vec![0.0; map.normals()];
            let mut w = vec![vec![0.0; map.cells()]; map.normals()];
            for (k, row) in w.iter_mut().enumerate() {
                unit[k] = 1.0;
                map.apply(&mut Given(&unit), &mut scratch, row);
                unit[k] = 0.0;
            }
            let mut columns = Columns::new(&*map);
            for i in 0..map.cells() {
                for (j, value) in columns.covariances(i).iter().enumerate() {
                    let product: f64 = w.iter().map(|row| row[i] * row[j]).sum();
                    assert!((value - product).abs() < 1e-13, "{i} {j}");
                }
            }
        }
    }

    /// The figures of an independent program: stage 0 of 0.5 m gives 0.082, of 1 m 0.224.
    #[test]
    fn errors_for_a_short_scale_are_those_of_an_independent_program() {
        for (limit, figure) in [(1024, 0.082), (256, 0.224)] {
            let (map, target) = paper(1.0, 1, limit);
            let a = accuracy(&map, &target, &PAPER, usize::MAX);
            assert_eq!(a.checked, 2000);
            // given with three digits
            assert!((a.correlation_error - figure).abs() < 6e-4, "{a:?}");
        }
    }

    /// Correlation over 2 m: mean of all pairs.
    fn over_two_metres(map: &Squash, variance: f64) -> f64 {
        let mut columns = Columns::new(map);
        let pairs: Vec<usize> = (0..2000).filter(|c| c % 100 + 8 < 100).collect();
        pairs.iter().map(|&c| columns.covariances(c)[c + 8] / variance).sum::<f64>() / pairs.len() as f64
    }

    /// Plain subdivision loses correlation along the long axis: 0.703 where 0.970 is exact.
    #[test]
    fn a_long_scale_needs_finer_rows() {
        let (plain, target) = paper(48.0, 1, 256);
        assert!((target.at(8, 0) / target.at(0, 0) - 0.970).abs() < 5e-4);
        let lost = over_two_metres(&plain, target.at(0, 0));
        assert!((lost - 0.703).abs() < 5e-4, "{lost}");
        let (squash, _) = paper(48.0, 8, 1024);
        let a = accuracy(&squash, &target, &PAPER, usize::MAX);
        assert!(a.correlation_error < 0.013 && a.variance_error < 0.013, "{a:?}");
    }

    #[test]
    fn a_mirrored_lattice_has_the_same_covariance() {
        let c = Correlation { family: Family::Spherical, theta: [2.0, 1.0] };
        let lattice = Lattice { cell: [0.5, 0.25], cells: [8, 12] };
        let map = Squash::new(&c, &lattice, [1, 2], 8).unwrap();
        assert_eq!(map.mirrors(), [true, true]);
        let mut columns = Columns::new(&map);
        let first = columns.covariances(1).to_vec();
        let other = columns.covariances(8 * 12 - 2);
        assert!(first.iter().rev().zip(other).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn all_columns_are_looked_at_once() {
        for n in [1, 2, 5, 21, 34, 500] {
            let cells: Vec<usize> = (0..n).collect();
            let mut seen = spread(&cells, usize::MAX);
            seen.sort_unstable();
            assert_eq!(seen, cells);
        }
    }
}
