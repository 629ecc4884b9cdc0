//! Small measures that several problems share.

/// Slope of ln(error) over ln(size) by least squares: the observed order of convergence.
pub(super) fn order(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<_> = points.iter().map(|&(h, e)| (h.ln(), e.abs().ln())).collect();
    slope(&logs)
}

/// Slope of the straight line through points by least squares.
pub(super) fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(a, b), &(x, y)| (a + x / n, b + y / n));
    let top: f64 = points.iter().map(|&(a, b)| (a - x) * (b - y)).sum();
    let bottom: f64 = points.iter().map(|&(a, _)| (a - x).powi(2)).sum();
    top / bottom
}

/// Largest of some numbers; NaN if one is NaN.
pub(super) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(f64::NEG_INFINITY, |a, v| if a.is_nan() || a >= v { a } else { v })
}

/// Mean of some numbers.
pub(super) fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, n) = values.into_iter().fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    sum / n
}

/// The last value up to which `holds`, between one that holds and one that does not, to a
/// relative width.
pub(super) fn bisect(
    mut good: f64,
    mut bad: f64,
    width: f64,
    mut holds: impl FnMut(f64) -> Result<bool, String>,
) -> Result<f64, String> {
    while (bad - good).abs() > width * good.abs() {
        let middle = 0.5 * (good + bad);
        if holds(middle)? { good = middle } else { bad = middle }
    }
    Ok(0.5 * (good + bad))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_a_square_is_two() {
        let points: Vec<_> = [1.0, 0.5, 0.25].iter().map(|h: &f64| (*h, 3.0 * h * h)).collect();
        assert!((order(&points) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn bisection_finds_the_edge() {
        let edge = bisect(0.0, 2.0, 1e-9, |x| Ok(x < 0.7)).unwrap();
        assert!((edge - 0.7).abs() < 1e-8);
    }

    #[test]
    fn one_nan_spoils_the_largest() {
        assert!(largest([1.0, f64::NAN, 2.0]).is_nan());
        assert_eq!(largest([1.0, 3.0, 2.0]), 3.0);
    }
}
