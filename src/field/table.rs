//! Covariances of local averages over the cells of a lattice.

use super::{
    correlation::{Correlation, Family},
    quadrature::Quadrature,
};

/// The cells of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Size of a cell (m) along x and the vertical.
    pub cell: [f64; 2],
    /// Cells along x and the vertical.
    pub cells: [usize; 2],
}

impl Lattice {
    /// Cells in all.
    pub fn len(&self) -> usize {
        self.cells[0] * self.cells[1]
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Covariances of the averages, over equal cells, of a field whose points have variance 1; by lag in cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    lags: [usize; 2],
    /// Lag along x fastest.
    values: Vec<f64>,
}

impl Table {
    /// Cells of size `cell` (m), with `lags` lags along each axis: 0 to `lags - 1`.
    ///
    /// C(i, j) is the integral of rho(lag) times the hat functions around i and j, both of width 2 cells:
    /// in closed form for the separable family, else by quadrature to 1e-13 (spherical: 1e-9).
    pub fn new(c: &Correlation, cell: [f64; 2], lags: [usize; 2]) -> Table {
        let scale = [0, 1].map(|k| cell[k] / c.theta[k]);
        let values = match c.family {
            Family::MarkovSeparable => separable(scale, lags),
            family => radial(&Quadrature::new(family, scale), lags),
        };
        Table { lags, values }
    }

    /// Lags along each axis.
    pub fn lags(&self) -> [usize; 2] {
        self.lags
    }

    /// Covariance of two cells `i` and `j` cells apart; both must be less than the number of lags.
    #[inline]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        debug_assert!(i < self.lags[0] && j < self.lags[1]);
        self.values[j * self.lags[0] + i]
    }

    /// The table of cells twice as large, with half the lags: the sum of (2-|a|)(2-|b|)/16 C(2i+a, 2j+b) over
    /// a and b in -1, 0, 1. Consistent with this one to rounding.
    pub fn coarser(&self) -> Table {
        let coarse = self.along_x().along_z();
        debug_assert_eq!(coarse.values.len(), coarse.lags[0] * coarse.lags[1]);
        coarse
    }

    /// The table of cells as high, and twice as wide.
    fn along_x(&self) -> Table {
        let lags = [self.lags[0] / 2, self.lags[1]];
        let of = |i: usize, j: usize| {
            (self.at((2 * i).abs_diff(1), j) + 2.0 * self.at(2 * i, j) + self.at(2 * i + 1, j)) / 4.0
        };
        Table { lags, values: all(lags, of) }
    }

    /// The table of cells as wide, and twice as high.
    fn along_z(&self) -> Table {
        let lags = [self.lags[0], self.lags[1] / 2];
        let of = |i: usize, j: usize| {
            (self.at(i, (2 * j).abs_diff(1)) + 2.0 * self.at(i, 2 * j) + self.at(i, 2 * j + 1)) / 4.0
        };
        Table { lags, values: all(lags, of) }
    }
}

fn all(lags: [usize; 2], of: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let of = &of;
    (0..lags[1]).flat_map(|j| (0..lags[0]).map(move |i| of(i, j))).collect()
}

fn separable(scale: [f64; 2], lags: [usize; 2]) -> Vec<f64> {
    let [x, z] = [0, 1].map(|k| (0..lags[k]).map(|i| markov(2.0 * scale[k], i)).collect::<Vec<_>>());
    all(lags, |i, j| x[i] * z[j])
}

/// Covariance of averages over cells on a line, `lag` cells apart, under exp(-a |t|) with t in cells.
///
/// Vanmarcke's variance function g = 2 / a^2 (a + exp(-a) - 1) at lag 0; beyond, the second difference of
/// T^2 g / 2, which is exp(-a (lag - 1)) ((1 - exp(-a)) / a)^2.
fn markov(a: f64, lag: usize) -> f64 {
    if a == 0.0 {
        1.0
    } else if lag > 0 {
        (-a * (lag - 1) as f64).exp() * ((-a).exp_m1() / a).powi(2)
    } else if a > 0.5 {
        2.0 / (a * a) * (a + (-a).exp_m1())
    } else {
        // 2 (1/2! - a/3! + a^2/4! - ...): the closed form cancels
        (3..20).rev().fold(0.0, |sum, n| (1.0 - a * sum) / f64::from(n)) * -a + 1.0
    }
}

/// Sums of the moments of the unit cells of lags around each lag.
fn radial(quadrature: &Quadrature, lags: [usize; 2]) -> Vec<f64> {
    let mut values = vec![0.0; lags[0] * lags[1]];
    for j in 0..lags[1] {
        for i in 0..lags[0] {
            // the cells at negative lags are the mirror images of those at positive lags
            let moments = quadrature.moments(i, j);
            for (k, moment) in moments.into_iter().enumerate() {
                let (i, j) = (i + k % 2, j + k / 2);
                if i < lags[0] && j < lags[1] {
                    let images = [i, j].into_iter().filter(|&lag| lag == 0).count() as i32;
                    values[j * lags[0] + i] += moment * 2f64.powi(images);
                }
            }
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RADIAL: [Family; 3] = [Family::Markov, Family::Gaussian, Family::Spherical];

    fn table(family: Family, theta: [f64; 2], cell: [f64; 2], lags: [usize; 2]) -> Table {
        Table::new(&Correlation { family, theta }, cell, lags)
    }

    /// Fenton and Vanmarcke's variance function: the published figures have five digits.
    #[test]
    fn variance_function_has_the_published_figures() {
        for (t, g) in [(0.25, 0.85225), (1.0, 0.56767), (5.0, 0.18000)] {
            let c = table(Family::MarkovSeparable, [1.0, f64::INFINITY], [t, 1.0], [1, 1]).at(0, 0);
            assert!((c - g).abs() <= 0.5e-5, "g({t}) = {c}");
        }
    }

    /// Simpson's rule on the hat functions, 2000 panels a cell: error h^4 / 180 a^4 < 1e-13, and the
    /// two branches of lag 0 on both sides of a = 1/2.
    #[test]
    fn separable_closed_form_is_the_integral() {
        for a in [1e-3, 0.1, 0.49, 0.51, 2.0] {
            for lag in 0..4 {
                let f = |t: f64| (1.0 - t.abs()) * (-a * (lag as f64 + t).abs()).exp();
                let half = |sign: f64| {
                    let n = 2000;
                    let at = |i: usize| f(sign * i as f64 / n as f64);
                    let inner: f64 = (1..n).map(|i| at(i) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
                    (at(0) + inner + at(n)) / (3 * n) as f64
                };
                let integral = half(1.0) + half(-1.0);
                assert!((markov(a, lag) - integral).abs() < 1e-12, "a = {a}, lag {lag}");
            }
        }
    }

    /// A field that does not vary along x is the one of the closed form.
    #[test]
    fn quadrature_gives_the_closed_form_on_a_line() {
        let line = [f64::INFINITY, 1.3];
        let a = table(Family::Markov, line, [0.25, 0.3], [2, 30]);
        let b = table(Family::MarkovSeparable, line, [0.25, 0.3], [2, 30]);
        for j in 0..30 {
            assert!((a.at(1, j) - b.at(1, j)).abs() < 1e-12, "lag {j}");
        }
    }

    /// Two quadratures on different cells agree as well as they are accurate.
    #[test]
    fn coarser_cells_average_the_finer() {
        for family in RADIAL {
            let tolerance = if family == Family::Spherical { 1e-9 } else { 1e-12 };
            for theta in [[1.0, 1.0], [48.0, 1.0], [0.07, 0.3], [f64::INFINITY, 2.0]] {
                let fine = table(family, theta, [0.25, 0.125], [17, 24]).coarser();
                let coarse = table(family, theta, [0.5, 0.25], [8, 12]);
                assert_eq!(fine.lags(), [8, 12]);
                for j in 0..12 {
                    for i in 0..8 {
                        let off = (fine.at(i, j) - coarse.at(i, j)).abs();
                        assert!(off < tolerance, "{family:?} {theta:?} lag {i} {j}: {off:e}");
                    }
                }
            }
        }
    }

    /// Far below theta a cell is a point; the variance reduction is about 2 r / theta of the mean lag.
    #[test]
    fn small_cells_are_points() {
        for family in RADIAL {
            let c = Correlation { family, theta: [5.0, 1.0] };
            let t = Table::new(&c, [1e-4, 1e-4], [2, 2]);
            assert!((t.at(0, 0) - 1.0).abs() < 4e-4 && t.at(0, 0) <= 1.0);
        }
    }

    /// Much larger than theta, averages are independent and the variance is the integral of the
    /// correlation over the plane, per cell: pi/2, 1 and 16 pi/45 of theta_x theta_z. Corrections are of
    /// order theta / cell = 1e-3.
    #[test]
    fn large_cells_are_independent() {
        use std::f64::consts::PI;
        for (family, integral) in
            [(Family::Markov, PI / 2.0), (Family::Gaussian, 1.0), (Family::Spherical, 16.0 * PI / 45.0)]
        {
            let t = table(family, [1.0, 1.0], [1e3, 1e3], [2, 1]);
            assert!((t.at(0, 0) * 1e6 / integral - 1.0).abs() < 2e-3, "{family:?} {}", t.at(0, 0) * 1e6);
            assert!(t.at(1, 0) < 2e-3 * t.at(0, 0));
        }
    }

    proptest! {
        #[test]
        fn covariances_are_bounded_and_finite(x in 1e-3..1e3f64, z in 1e-3..1e3f64, k in 0usize..4) {
            let family = [Family::Markov, Family::MarkovSeparable, Family::Gaussian, Family::Spherical][k];
            let t = table(family, [x, z], [0.25, 0.25], [3, 2]);
            for j in 0..2 {
                for i in 0..3 {
                    prop_assert!(t.at(i, j) >= 0.0 && t.at(i, j) <= t.at(0, 0) && t.at(0, 0) <= 1.0 + 1e-12);
                }
            }
        }
    }
}
