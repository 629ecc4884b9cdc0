//! How wide a band of nonlocal softening is.
//!
//! In a layer under shear the stress is uniform, and so is kappa where the soil yields. With the length l of the Gaussian
//! as unit, eps_p of a band from -a to a satisfies
//! ```text
//! (1 - m) e(x) + m int_-a^a w(x - y) e(y) dy = 1,   w(x) = exp(-x^2) / sqrt(pi),   e(a) = 0
//! ```
//! for kappa = 1, where e(a) = 0 lets the band join the elastic soil. Slip over kappa, the integral of e, is the width of
//! the local band that dissipates as much per area: 3.830 for m = 2. Its change with a goes with e(a)^2, so the error in a
//! does not matter.

use nalgebra::{DMatrix, DVector};

/// Midpoints on half of a band: the error goes with their square, 1e-4 with 48.
const POINTS: usize = 48;

/// Slip of a band over kappa, in lengths of the Gaussian, for a weight m > 1.
pub fn effective_width(m: f64) -> f64 {
    let step = 0.02;
    let too_narrow = |a: f64| band(m, a).is_none_or(|b| b.slip < 0.0 || b.end > 0.0);
    let (mut low, mut high) = (0.0, step);
    // wide bands of large weights end below 4 l
    while too_narrow(high) && high < 4.0 {
        (low, high) = (high, high + step);
    }
    for _ in 0..12 {
        let middle = 0.5 * (low + high);
        if too_narrow(middle) { low = middle } else { high = middle }
    }
    band(m, high).map_or(f64::NAN, |b| b.slip)
}

struct Band {
    slip: f64,
    /// e(a).
    end: f64,
}

/// A band of half-width `a`; `None` where the equation has no solution.
fn band(m: f64, a: f64) -> Option<Band> {
    let dx = a / POINTS as f64;
    let at = |i: usize| (i as f64 + 0.5) * dx;
    // the other half of the band is the image of this one
    let w = |x: f64, y: f64| ((-(x - y).powi(2)).exp() + (-(x + y).powi(2)).exp()) / std::f64::consts::PI.sqrt();
    let matrix = DMatrix::from_fn(POINTS, POINTS, |i, j| {
        let own = if i == j { 1.0 - m } else { 0.0 };
        own + m * w(at(i), at(j)) * dx
    });
    let e = matrix.lu().solve(&DVector::from_element(POINTS, 1.0))?;
    let around: f64 = (0..POINTS).map(|j| w(a, at(j)) * e[j] * dx).sum();
    Some(Band { slip: 2.0 * dx * e.sum(), end: (1.0 - m * around) / (1.0 - m) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against a Gauss rule of 40 points, worked out apart from the program; midpoints err by less than 1e-4.
    #[test]
    fn widths_are_those_of_a_finer_rule() {
        for (m, width) in [(1.5, 3.089_096), (2.0, 3.830_151), (3.0, 4.966_306)] {
            let ours = effective_width(m);
            assert!((ours / width - 1.0).abs() < 1e-4, "{m}: {ours}");
        }
        assert!(effective_width(1.2).is_finite() && effective_width(5.0) > effective_width(3.0));
    }
}
