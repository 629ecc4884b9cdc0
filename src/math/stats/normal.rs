//! A normal distribution fitted by mean and standard deviation.

use serde::Serialize;

/// Mean and standard deviation (with n - 1); `None` for fewer than two values or what is not finite.
pub(super) fn mean_and_sd(sample: &[f64]) -> Option<(f64, f64)> {
    let n = sample.len() as f64;
    let mean = sample.iter().sum::<f64>() / n;
    let squares = sample.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
    let sd = (squares / (n - 1.0)).sqrt();
    (sample.len() > 1 && mean.is_finite() && sd.is_finite()).then_some((mean, sd))
}

/// A fitted normal with standard errors, in the unit of the sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NormalFit {
    pub n: usize,
    pub mean: f64,
    /// sd / sqrt(n)
    pub mean_se: f64,
    /// With n - 1.
    pub sd: f64,
    /// sd / sqrt(2 (n - 1)): that of a normal sample.
    pub sd_se: f64,
}

impl NormalFit {
    /// The fit; `None` for fewer than two values or where one is not finite.
    pub fn of(sample: &[f64]) -> Option<Self> {
        let (mean, sd) = mean_and_sd(sample)?;
        let n = sample.len() as f64;
        Some(NormalFit { n: sample.len(), mean, mean_se: sd / n.sqrt(), sd, sd_se: sd / (2.0 * (n - 1.0)).sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_sample() {
        let fit = NormalFit::of(&[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!((fit.n, fit.mean), (4, 2.5));
        assert!((fit.sd - (5.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!((fit.mean_se - fit.sd / 2.0).abs() < 1e-15 && (fit.sd_se - fit.sd / 6.0_f64.sqrt()).abs() < 1e-15);
        assert!(NormalFit::of(&[1.0]).is_none() && NormalFit::of(&[1.0, f64::NAN]).is_none());
    }
}
