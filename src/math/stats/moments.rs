//! What is said of an ensemble: moments and quantiles with their standard errors.

use serde::Serialize;

use super::normal::mean_and_sd;
use super::{Bootstrap, quantile};

/// Quantiles that are given.
const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// Moments of a sample, in its unit. Errors but that of the mean by bootstrap.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moments {
    pub n: usize,
    pub mean: f64,
    /// sd / sqrt(n)
    pub mean_se: f64,
    /// With n - 1.
    pub sd: f64,
    pub sd_se: f64,
    pub min: f64,
    pub max: f64,
    /// At 5, 25, 50, 75 and 95 %.
    pub quantiles: Vec<QuantileEstimate>,
    /// m3 / m2^(3/2) with central moments over n; `None` where all values are the same.
    pub skewness: Option<f64>,
    pub skewness_se: Option<f64>,
}

/// An estimated quantile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct QuantileEstimate {
    /// Share of the values below it.
    pub share: f64,
    pub value: f64,
    pub standard_error: f64,
}

impl Moments {
    /// Of a sample in any order; `None` for fewer than two values or where one is not finite.
    pub fn of(sample: &[f64], bootstrap: &Bootstrap) -> Option<Self> {
        let (mean, sd) = mean_and_sd(sample)?;
        let mut sorted = sample.to_vec();
        sorted.sort_by(f64::total_cmp);
        let spreads = bootstrap.spreads(&sorted, estimates);
        let error = |k: usize| spreads.get(k).copied().flatten().map(|s| s.standard_error);
        let estimate = |(k, share): (usize, f64)| {
            let (value, standard_error) = (quantile(&sorted, share)?, error(k + 2)?);
            Some(QuantileEstimate { share, value, standard_error })
        };
        Some(Moments {
            n: sorted.len(),
            mean,
            mean_se: sd / (sorted.len() as f64).sqrt(),
            sd,
            sd_se: error(0)?,
            min: *sorted.first()?,
            max: *sorted.last()?,
            quantiles: SHARES.into_iter().enumerate().map(estimate).collect::<Option<_>>()?,
            skewness: Some(skewness(&sorted)).filter(|s| s.is_finite()),
            skewness_se: error(1),
        })
    }
}

/// Standard deviation, skewness and quantiles of a sample in order.
fn estimates(sorted: &[f64]) -> [f64; 7] {
    let at = |k: usize| quantile(sorted, SHARES[k]).unwrap_or(f64::NAN);
    let sd = mean_and_sd(sorted).map_or(f64::NAN, |(_, sd)| sd);
    [sd, skewness(sorted), at(0), at(1), at(2), at(3), at(4)]
}

/// m3 / m2^(3/2); NaN where all values are the same.
fn skewness(sample: &[f64]) -> f64 {
    let n = sample.len() as f64;
    let mean = sample.iter().sum::<f64>() / n;
    let moment = |k: i32| sample.iter().map(|v| (v - mean).powi(k)).sum::<f64>() / n;
    let variance = moment(2);
    if variance > 0.0 { moment(3) / variance.powf(1.5) } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::{NormalFit, random::Draws};

    #[test]
    fn known_moments() {
        let m = Moments::of(&[4.0, 1.0, 3.0, 2.0, 10.0], &Bootstrap::default()).unwrap();
        assert_eq!((m.n, m.mean, m.min, m.max, m.quantiles[2].value), (5, 4.0, 1.0, 10.0, 3.0));
        assert!((m.sd - 12.5_f64.sqrt()).abs() < 1e-15);
        // m2 = 10, m3 = 36
        assert!((m.skewness.unwrap() - 36.0 / 10.0_f64.powf(1.5)).abs() < 1e-14);
        assert!(Moments::of(&[1.0], &Bootstrap::default()).is_none());
        let same = Moments::of(&[2.0; 9], &Bootstrap::default()).unwrap();
        assert_eq!((same.sd, same.sd_se, same.skewness), (0.0, 0.0, None));
    }

    #[test]
    fn errors_of_a_normal_sample() {
        let sample = Draws::new(1, 0).sample(2000, 10.0, 3.0);
        let (m, fit) = (Moments::of(&sample, &Bootstrap::default()).unwrap(), NormalFit::of(&sample).unwrap());
        // 1.6 % of 2000 resamples and 2.2 % of the sample's fourth moment, sqrt(24 / n) / 4 of 2: four of both.
        assert!((m.sd_se / fit.sd_se - 1.0).abs() < 0.11, "{} {}", m.sd_se, fit.sd_se);
        // The median's error is sqrt(pi / 2) of the mean's; its bootstrap is rough, n^(-1/4) = 15 %.
        assert!((m.quantiles[2].standard_error / fit.mean_se / 1.2533 - 1.0).abs() < 0.3);
        assert!((m.skewness_se.unwrap() / (6.0_f64 / 2000.0).sqrt() - 1.0).abs() < 0.2);
    }
}
