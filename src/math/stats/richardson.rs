//! Rate and limit of values on a ladder of sizes (Richardson; Roache 1997).
//!
//! Sizes h_1 > h_2 > ... and values that approach the limit v as v_k = v + c h_k^p have the differences
//! ```text
//! |v_(k+1) - v_k| = |c| h_(k+1)^p (r_k^p - 1),   r_k = h_k / h_(k+1)
//! ```
//! p is fitted to their logarithms by least squares: for three sizes of one ratio r it is
//! ln((v1 - v2) / (v2 - v3)) / ln r. The ratios may differ.

/// Rates that a clean ladder may show: from half an order, as beside a corner, to four orders with the error of their
/// fit. Out of it the sizes are not yet, or no longer, where the formula holds.
pub const RATES: [f64; 2] = [0.5, 4.5];

/// Rounds of Newton's method: two where the ratios are equal, as the fit is linear then.
const ROUNDS: usize = 50;
/// A rate beyond this is none.
const LARGEST: f64 = 50.0;

/// One difference: logarithms of the finer size, of the ratio of the sizes, and of the difference over the latter.
struct Step {
    size: f64,
    ratio: f64,
    difference: f64,
}

/// The rate p of three values or more, coarsest first; `None` where the sizes do not fall or the differences have not
/// one sign.
pub fn order(h: &[f64], v: &[f64]) -> Option<f64> {
    let steps = steps(h, v)?;
    let mut p = 1.0;
    for _ in 0..ROUNDS {
        let change = correction(&steps, p);
        p += change;
        if p.is_nan() || p.abs() >= LARGEST {
            return None;
        }
        if change.abs() <= 4.0 * f64::EPSILON * p.abs().max(1.0) {
            return Some(p);
        }
    }
    None
}

/// The limit from the finest two values and a rate: v = v_n + (v_n - v_(n-1)) / (r^p - 1). `None` unless p > 0.
pub fn limit(h: &[f64], v: &[f64], p: f64) -> Option<f64> {
    let ([h1, h2], [v1, v2]) = (h.last_chunk()?, v.last_chunk()?);
    let limit = v2 + (v2 - v1) / ((h1 / h2).powf(p) - 1.0);
    (p > 0.0 && limit.is_finite()).then_some(limit)
}

fn steps(h: &[f64], v: &[f64]) -> Option<Vec<Step>> {
    let falls = h.iter().all(|h| *h > 0.0) && h.windows(2).all(|w| w[0] > w[1]);
    let differences: Vec<f64> = v.windows(2).map(|w| w[1] - w[0]).collect();
    let one_sign = differences.iter().all(|d| *d > 0.0) || differences.iter().all(|d| *d < 0.0);
    if h.len() != v.len() || h.len() < 3 || !falls || !one_sign {
        return None;
    }
    let step = |(h, d): (&[f64], &f64)| {
        let ratio = (h[0] / h[1]).ln();
        Step { size: h[1].ln(), ratio, difference: (d.abs() / ratio).ln() }
    };
    Some(h.windows(2).zip(&differences).map(step).collect())
}

/// The change of p of one round: residuals over slopes of the model, both from their means, as c is free.
///
/// ln |d| = ln |c p| + ln r + p ln h_(k+1) + phi(p ln r), phi(x) = ln((e^x - 1) / x)
fn correction(steps: &[Step], p: f64) -> f64 {
    let residual = |s: &Step| s.difference - p * s.size - phi(p * s.ratio);
    let slope = |s: &Step| s.size + s.ratio * phi_slope(p * s.ratio);
    let mean = |of: &dyn Fn(&Step) -> f64| steps.iter().map(of).sum::<f64>() / steps.len() as f64;
    let (mean_residual, mean_slope) = (mean(&residual), mean(&slope));
    let product: f64 = steps.iter().map(|s| (residual(s) - mean_residual) * (slope(s) - mean_slope)).sum();
    let square: f64 = steps.iter().map(|s| (slope(s) - mean_slope).powi(2)).sum();
    product / square
}

/// Below this the series of phi is exact to rounding: its next term is x^4 / 2880.
const SMALL: f64 = 1e-3;

fn phi(x: f64) -> f64 {
    if x.abs() < SMALL { 0.5 * x + x * x / 24.0 } else { (x.exp_m1() / x).ln() }
}

fn phi_slope(x: f64) -> f64 {
    if x.abs() < SMALL { 0.5 + x / 12.0 } else { -(-x).exp_m1().recip() - x.recip() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ladder(h: &[f64], p: f64) -> Vec<f64> {
        h.iter().map(|h| 2.0 - 0.3 * h.powf(p)).collect()
    }

    /// Rounding of the values over the least difference is below 1e-12 here, that of p alike.
    #[test]
    fn a_power_is_found_whatever_the_ratios() {
        for h in [&[1.0, 0.5, 0.25][..], &[0.5, 0.25, 5.0 / 29.0], &[1.0, 0.9, 0.3, 0.2]] {
            for p in [-1.0, 0.5, 1.0, 2.0, 3.0] {
                let v = ladder(h, p);
                let found = order(h, &v).unwrap();
                assert!((found - p).abs() < 1e-10, "{found} for {p}");
                assert!(p < 0.0 || (limit(h, &v, found).unwrap() - 2.0).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn equal_differences_have_the_rate_zero_and_no_limit() {
        let (h, v) = ([1.0, 0.5, 0.25], [3.0, 2.0, 1.0]);
        let p = order(&h, &v).unwrap();
        assert!(p.abs() < 1e-12, "{p}");
        assert!(limit(&h, &v, 0.0).is_none() && limit(&h, &v, -1.0).is_none());
    }

    #[test]
    fn what_has_no_rate_gives_none() {
        let h = [1.0, 0.5, 0.25];
        assert!(order(&h, &[1.0, 2.0, 1.5]).is_none() && order(&h, &[1.0, 1.0, 1.0]).is_none());
        assert!(order(&h, &[1.0, f64::NAN, 1.5]).is_none() && order(&h[..2], &[1.0, 2.0]).is_none());
        assert!(order(&[1.0, 1.0, 0.5], &[1.0, 2.0, 2.5]).is_none() && order(&h, &[1.0, 2.0]).is_none());
    }
}
