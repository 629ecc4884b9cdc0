//! Positions of points inside a cell.

/// Abscissae of the n-point Gauss rule on (0, 1), by Newton on the Legendre polynomial.
pub fn gauss(n: usize) -> Vec<f64> {
    let mut x: Vec<f64> = (0..n).map(|i| 0.5 + 0.5 * root(n, i)).collect();
    x.sort_by(f64::total_cmp);
    x
}

/// Centres of n equal parts of (0, 1).
pub fn even(n: usize) -> Vec<f64> {
    (0..n).map(|i| (i as f64 + 0.5) / n as f64).collect()
}

/// Root `i` of P_n on (-1, 1).
fn root(n: usize, i: usize) -> f64 {
    let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
    for _ in 0..50 {
        let (p, dp) = legendre(n, x);
        let dx = p / dp;
        x -= dx;
        if dx.abs() < 1e-16 {
            break;
        }
    }
    x
}

/// P_n(x) and its derivative, n >= 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut p0, mut p1) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
    }
    (p1, n as f64 * (x * p1 - p0) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_rules() {
        let g = 0.5 / 3f64.sqrt();
        assert!((gauss(2)[0] - (0.5 - g)).abs() < 1e-15 && (gauss(2)[1] - (0.5 + g)).abs() < 1e-15);
        assert_eq!(gauss(1), vec![0.5]);
        assert!((gauss(3)[1] - 0.5).abs() < 1e-15);
        assert!((gauss(4)[0] - 0.069_431_844_202_973_71).abs() < 1e-14);
        assert_eq!(even(2), vec![0.25, 0.75]);
    }
}
