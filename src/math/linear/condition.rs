//! Estimate of the size of an inverse (Hager 1984, Higham 1988).

use super::vector::{dot, sum_abs};

/// Most pairs of solves; more hardly ever change the estimate.
const ROUNDS: usize = 5;

/// Lower bound, nearly always within a factor of 3, of the 1-norm of A^-1 for a matrix of `n` rows.
/// `solve(x, transposed)` overwrites x with A^-1 x or A^-T x. Infinite if a solve fails.
pub(super) fn inverse_norm(n: usize, mut solve: impl FnMut(&mut [f64], bool) -> Option<()>) -> f64 {
    let climbed = climb(n, &mut solve);
    let alternating = alternate(n, &mut solve);
    let bound = climbed.zip(alternating).map_or(f64::INFINITY, |(a, b)| a.max(b));
    if bound.is_nan() { f64::INFINITY } else { bound }
}

/// Climbs from vertex to vertex of the unit ball, where |A^-1 x| is convex.
fn climb(n: usize, solve: &mut impl FnMut(&mut [f64], bool) -> Option<()>) -> Option<f64> {
    let mut x = vec![1.0 / n as f64; n];
    let mut best: f64 = 0.0;
    for _ in 0..ROUNDS {
        let mut y = x.clone();
        solve(&mut y, false)?;
        best = best.max(sum_abs(&y));
        let mut slope: Vec<f64> = y.iter().map(|v| 1f64.copysign(*v)).collect();
        solve(&mut slope, true)?;
        let steepest = (0..n).max_by(|&i, &j| slope[i].abs().total_cmp(&slope[j].abs()))?;
        if slope[steepest].abs() <= dot(&slope, &x) {
            break;
        }
        x.fill(0.0);
        x[steepest] = 1.0;
    }
    Some(best)
}

/// Higham's safeguard: a vector of growing components with alternating signs.
fn alternate(n: usize, solve: &mut impl FnMut(&mut [f64], bool) -> Option<()>) -> Option<f64> {
    let last = n.saturating_sub(1).max(1) as f64;
    let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    let mut x: Vec<f64> = (0..n).map(|i| sign(i) * (1.0 + i as f64 / last)).collect();
    solve(&mut x, false)?;
    Some(2.0 * sum_abs(&x) / (3.0 * n as f64))
}
