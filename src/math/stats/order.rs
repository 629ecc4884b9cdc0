//! The observed order of convergence.

/// Least-squares slope of ln(y) over ln(x): the observed order of convergence.
pub fn log_slope(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len().min(y.len()) as f64;
    let (lx, ly): (Vec<f64>, Vec<f64>) = x.iter().zip(y).map(|(a, b)| (a.ln(), b.ln())).unzip();
    let (mx, my) = (lx.iter().sum::<f64>() / n, ly.iter().sum::<f64>() / n);
    let sxy: f64 = lx.iter().zip(&ly).map(|(a, b)| (a - mx) * (b - my)).sum();
    let sxx: f64 = lx.iter().map(|a| (a - mx).powi(2)).sum();
    sxy / sxx
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slope_of_a_power_law() {
        let x = [1.0, 0.5, 0.25];
        let y = x.map(|h: f64| 3.0 * h.powi(2));
        assert!((log_slope(&x, &y) - 2.0).abs() < 1e-12);
    }
}
