//! Sums over vectors, in an order that does not change.

/// Sum of products, in four interleaved sums.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (whole_a, rest_a) = a.as_chunks::<4>();
    let (whole_b, rest_b) = b.as_chunks::<4>();
    for (a, b) in whole_a.iter().zip(whole_b) {
        for lane in 0..4 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Euclidean length.
pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Sum of the absolute values.
pub(super) fn sum_abs(a: &[f64]) -> f64 {
    a.iter().map(|v| v.abs()).sum()
}

/// `a += factor b`.
pub(super) fn add_multiple(a: &mut [f64], factor: f64, b: &[f64]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += factor * b;
    }
}

/// Whether all numbers are finite.
pub(super) fn finite(a: &[f64]) -> bool {
    // 0 x is 0 for a number and NaN else: without branches, so that it vectorises
    a.chunks(64).all(|part| part.iter().fold(0.0, |sum, x| sum + 0.0 * x) == 0.0)
}
