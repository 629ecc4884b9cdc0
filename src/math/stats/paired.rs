//! Two results of the same realisations, such as r of RFEM and of RMPM.

use serde::Serialize;

use super::normal::mean_and_sd;
use super::standard_errors;

/// Differences b - a of pairs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Paired {
    pub n: usize,
    /// Mean of b - a.
    pub mean: f64,
    /// Its standard error.
    pub mean_se: f64,
    /// Standard deviation of b - a.
    pub sd: f64,
    /// Pairs with b > a, b < a and b = a.
    pub greater: usize,
    pub less: usize,
    pub equal: usize,
    /// Two-sided exact sign test that b > a is as likely as b < a; equal pairs tell nothing.
    pub sign_p: f64,
}

impl Paired {
    /// Of pairs by place; a pair in which one is not finite is left out. `None` for fewer than two.
    pub fn of(a: &[f64], b: &[f64]) -> Option<Self> {
        let d: Vec<f64> = pairs(a, b).map(|(a, b)| b - a).collect();
        let (mean, sd) = mean_and_sd(&d)?;
        let count = |test: fn(f64) -> bool| d.iter().filter(|d| test(**d)).count();
        let (greater, less) = (count(|d| d > 0.0), count(|d| d < 0.0));
        Some(Paired {
            n: d.len(),
            mean,
            mean_se: sd / (d.len() as f64).sqrt(),
            sd,
            greater,
            less,
            equal: d.len() - greater - less,
            sign_p: sign_test(greater, less),
        })
    }
}

fn pairs(a: &[f64], b: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    a.iter().copied().zip(b.iter().copied()).filter(|(a, b)| a.is_finite() && b.is_finite())
}

/// 2 P(K <= min) for K binomial(m, 1/2), at most 1. Terms relative to the last one, so that 2^-m need not be
/// a number.
fn sign_test(greater: usize, less: usize) -> f64 {
    let (m, k) = (greater + less, greater.min(less));
    let (mut term, mut sum) = (1.0, 1.0);
    for i in (0..k).rev() {
        // C(m, i) / C(m, i + 1)
        term *= (i + 1) as f64 / (m - i) as f64;
        sum += term;
    }
    let log_choose: f64 = (0..k).map(|i| ((m - i) as f64 / (i + 1) as f64).ln()).sum();
    let log_last = log_choose - m as f64 * std::f64::consts::LN_2;
    (2.0 * sum * log_last.exp()).min(1.0)
}

/// Pearson's correlation of pairs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Correlation {
    pub n: usize,
    pub r: f64,
    /// Fisher's interval, tanh(atanh r -+ z / sqrt(n - 3)): for nearly normal pairs.
    pub low: f64,
    pub high: f64,
    pub confidence: f64,
}

impl Correlation {
    /// Of pairs by place; a pair in which one is not finite is left out. `None` for fewer than four,
    /// or where one side does not vary.
    pub fn of(a: &[f64], b: &[f64], confidence: f64) -> Option<Self> {
        let z = standard_errors(confidence)?;
        let (a, b): (Vec<f64>, Vec<f64>) = pairs(a, b).unzip();
        let ((ma, sa), (mb, sb)) = (mean_and_sd(&a)?, mean_and_sd(&b)?);
        let n = a.len();
        if n < 4 || sa == 0.0 || sb == 0.0 {
            return None;
        }
        let sum: f64 = a.iter().zip(&b).map(|(x, y)| (x - ma) / sa * ((y - mb) / sb)).sum();
        let r = (sum / (n - 1) as f64).clamp(-1.0, 1.0);
        let end = |sign: f64| (r.atanh() + sign * z / ((n - 3) as f64).sqrt()).tanh();
        Some(Correlation { n, r, low: end(-1.0), high: end(1.0), confidence })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::gauss;

    #[test]
    fn differences_and_signs() {
        let a = [1.0, 2.0, 3.0, 4.0, f64::NAN];
        let p = Paired::of(&a, &[2.0, 2.0, 5.0, 3.0, 1.0]).unwrap();
        assert_eq!((p.n, p.mean, p.greater, p.less, p.equal), (4, 0.5, 2, 1, 1));
        assert!((p.sd - (5.0_f64 / 3.0).sqrt()).abs() < 1e-15 && p.sign_p == 1.0);
        assert!(Paired::of(&[1.0], &[2.0]).is_none());
    }

    #[test]
    fn sign_test_is_the_binomial_tail() {
        // 9 of 10: 2 (1 + 10) / 1024
        assert!((sign_test(9, 1) - 22.0 / 1024.0).abs() < 1e-15);
        assert!((sign_test(0, 10) - 2.0 / 1024.0).abs() < 1e-17);
        assert_eq!((sign_test(0, 0), sign_test(5, 5)), (1.0, 1.0));
        // P(K <= 40) of 100 is 0.028 443 97 in tables.
        assert!((sign_test(60, 40) - 0.056_887_9).abs() < 1e-7);
        // The normal approximation with continuity correction; the next term of Edgeworth's series is 1e-3 of it.
        let z = (2600.0 - 2500.0 - 0.5) / 1250.0_f64.sqrt();
        assert!((sign_test(2600, 2400) / (2.0 * gauss::cdf(-z)) - 1.0).abs() < 5e-3);
    }

    #[test]
    fn correlation_with_its_interval() {
        let a = [1.0, 2.0, 3.0, 4.0, 5.0];
        let c = Correlation::of(&a, &[2.0, 1.0, 4.0, 3.0, 5.0], 0.95).unwrap();
        // r = 1 - 6 (4) / (5 24) of ranks = 0.8; atanh 0.8 = 1.0986, 1.96 / sqrt 2 = 1.3859
        assert!((c.r - 0.8).abs() < 1e-15);
        assert!((c.low - (1.098_612_3_f64 - 1.385_903_8).tanh()).abs() < 1e-6);
        assert!(Correlation::of(&a, &[1.0; 5], 0.95).is_none());
        let line = Correlation::of(&a, &a, 0.95).unwrap();
        assert!(line.r > 1.0 - 1e-15 && line.high <= 1.0);
    }
}
