//! A normal distribution of which the tails were not seen.
//!
//! A slope that does not slide tells r = 0, and a slide that reaches the end of the mesh tells
//! where the mesh ends: r would be that or less, that or more. Mean and standard deviation by maximum
//! likelihood with both tails known by their number only (J. Tobin, Econometrica 26, 1958), in the
//! parameters in which the likelihood has one maximum (R. Olsen, Econometrica 46, 1978).

use std::fmt;

use serde::Serialize;

use super::gauss::{log_cdf, log_cdf_slope};

/// From where on values tell a side only; in the unit of the sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Censoring {
    /// A value at or below this may stand for any lower one.
    pub low: Option<f64>,
    /// A value at or above this may stand for any higher one.
    pub high: Option<f64>,
}

/// Why there is no fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "reason")]
pub enum Unfit {
    /// Fewer than three values.
    TooFew { n: usize },
    /// A value is not finite.
    NotFinite { index: usize },
    /// The low limit is not below the high one, or one is not finite.
    Limits { low: f64, high: f64 },
    /// No value lies between the limits.
    AllCensored { below: usize, above: usize },
    /// All values between the limits are the same.
    NoSpread { value: f64 },
    /// Newton's method did not come to an end; `decrement` is its last step in standard errors.
    NotConverged { iterations: usize, decrement: f64 },
    /// Too few of the simulated samples could be fitted.
    Resamples { fitted: usize, of: usize },
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unfit::TooFew { n } => write!(f, "{n} values; a fit needs 3"),
            Unfit::NotFinite { index } => write!(f, "value {index} is not finite"),
            Unfit::Limits { low, high } => write!(f, "the limits {low} and {high} are no range"),
            Unfit::AllCensored { below, above } => {
                write!(f, "all values are censored: {below} at the low and {above} at the high limit")
            }
            Unfit::NoSpread { value } => write!(f, "all values that are not censored are {value}"),
            Unfit::NotConverged { iterations, decrement } => {
                write!(f, "no maximum of the likelihood in {iterations} iterations (last step {decrement:.1e} errors)")
            }
            Unfit::Resamples { fitted, of } => write!(f, "only {fitted} of {of} simulated samples could be fitted"),
        }
    }
}

impl std::error::Error for Unfit {}

impl Censoring {
    /// Whether nothing is censored.
    pub fn is_none(&self) -> bool {
        self.low.is_none() && self.high.is_none()
    }

    pub(super) fn is_below(&self, value: f64) -> bool {
        self.low.is_some_and(|low| value <= low)
    }

    pub(super) fn is_above(&self, value: f64) -> bool {
        !self.is_below(value) && self.high.is_some_and(|high| value >= high)
    }

    /// Whether the value is known.
    pub fn is_inside(&self, value: f64) -> bool {
        !self.is_below(value) && !self.is_above(value)
    }

    /// Refuses limits and samples that nothing can be made of.
    pub(super) fn check(&self, sample: &[f64]) -> Result<(), Unfit> {
        let (low, high) = (self.low.unwrap_or(f64::MIN), self.high.unwrap_or(f64::MAX));
        if !(low < high && low.is_finite() && high.is_finite()) {
            return Err(Unfit::Limits { low, high });
        }
        if let Some(index) = sample.iter().position(|v| !v.is_finite()) {
            return Err(Unfit::NotFinite { index });
        }
        if sample.len() < 3 { Err(Unfit::TooFew { n: sample.len() }) } else { Ok(()) }
    }
}

/// A fitted normal whose tails are censored; in the unit of the sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CensoredFit {
    pub n: usize,
    /// Values at the low limit.
    pub below: usize,
    /// Values at the high limit.
    pub above: usize,
    pub mean: f64,
    /// Standard errors from the observed information.
    pub mean_se: f64,
    /// Of maximum likelihood: with n, not n - 1.
    pub sd: f64,
    pub sd_se: f64,
    /// Newton iterations.
    pub iterations: usize,
}

impl CensoredFit {
    /// The fit.
    ///
    /// # Errors
    /// The reason why there is none.
    pub fn of(sample: &[f64], censoring: &Censoring) -> Result<Self, Unfit> {
        censoring.check(sample)?;
        let (likelihood, scale) = Likelihood::of(sample, censoring)?;
        let (at, iterations) = likelihood.maximum()?;
        Ok(likelihood.fit(at, scale, iterations))
    }
}

/// Where the values between the limits lie: t = (y - mean) / sd is what the likelihood sees.
#[derive(Clone, Copy)]
struct Scale {
    mean: f64,
    sd: f64,
}

/// All that the likelihood depends on: how many values lie inside, and per side how many lie outside
/// of which t. The inner t have mean 0 and mean square 1.
struct Likelihood {
    inside: usize,
    low: (usize, f64),
    high: (usize, f64),
}

/// Gradient and information over (delta, gamma) = (mean / sd, 1 / sd) of t.
struct Slope {
    gradient: [f64; 2],
    information: [[f64; 2]; 2],
}

impl Likelihood {
    fn of(sample: &[f64], censoring: &Censoring) -> Result<(Self, Scale), Unfit> {
        let below = sample.iter().filter(|v| censoring.is_below(**v)).count();
        let above = sample.iter().filter(|v| censoring.is_above(**v)).count();
        let inside = || sample.iter().filter(|v| censoring.is_inside(**v));
        let k = sample.len() - below - above;
        let Some(first) = inside().next().copied() else {
            return Err(Unfit::AllCensored { below, above });
        };
        let mean = inside().sum::<f64>() / k as f64;
        let sd = (inside().map(|v| (v - mean).powi(2)).sum::<f64>() / k as f64).sqrt();
        if !(sd > 1e-12 * mean.abs() && sd.is_finite()) {
            return Err(Unfit::NoSpread { value: first });
        }
        let place = |limit: Option<f64>| limit.map_or(0.0, |y| (y - mean) / sd);
        let (low, high) = ((below, place(censoring.low)), (above, place(censoring.high)));
        Ok((Likelihood { inside: k, low, high }, Scale { mean, sd }))
    }

    /// l = k ln gamma - k (gamma^2 + delta^2) / 2 + n_low ln Phi(gamma t_low - delta)
    ///     + n_high ln Phi(delta - gamma t_high)
    fn value(&self, [delta, gamma]: [f64; 2]) -> f64 {
        let tail = |n: usize, z: f64| if n == 0 { 0.0 } else { n as f64 * log_cdf(z) };
        self.inside as f64 * (gamma.ln() - 0.5 * (gamma * gamma + delta * delta))
            + tail(self.low.0, gamma * self.low.1 - delta)
            + tail(self.high.0, delta - gamma * self.high.1)
    }

    fn slope(&self, [delta, gamma]: [f64; 2]) -> Slope {
        let k = self.inside as f64;
        let mut gradient = [-k * delta, k / gamma - k * gamma];
        let mut information = [[k, 0.0], [0.0, k + k / (gamma * gamma)]];
        // d z / d (delta, gamma) is (-1, t) for the low side and (1, -t) for the high one.
        for ((n, t), sign) in [(self.low, 1.0), (self.high, -1.0)] {
            let z = sign * (gamma * t - delta);
            let dz = [-sign, sign * t];
            let first = log_cdf_slope(z);
            let second = first * (z + first);
            for i in 0..2 {
                gradient[i] += n as f64 * first * dz[i];
                (0..2).for_each(|j| information[i][j] += n as f64 * second * dz[i] * dz[j]);
            }
        }
        Slope { gradient, information }
    }

    /// Newton's method with halved steps from the fit of what lies inside. It ends with a step of
    /// 1e-9 standard errors.
    fn maximum(&self) -> Result<([f64; 2], usize), Unfit> {
        const MOST: usize = 100;
        let (mut at, mut decrement) = ([0.0, 1.0], f64::INFINITY);
        for iteration in 0..MOST {
            let slope = self.slope(at);
            let step = product(inverse(slope.information), slope.gradient);
            decrement = (step[0] * slope.gradient[0] + step[1] * slope.gradient[1]).sqrt();
            if decrement <= 1e-9 {
                return Ok((at, iteration));
            }
            at = self.search(at, step);
        }
        Err(Unfit::NotConverged { iterations: MOST, decrement })
    }

    /// The longest of the steps 1, 1/2, 1/4 ... that does not lower the likelihood beyond rounding.
    fn search(&self, at: [f64; 2], step: [f64; 2]) -> [f64; 2] {
        let floor = self.value(at) - 1e-12 * self.value(at).abs();
        let go = |k: i32| [at[0] + 0.5_f64.powi(k) * step[0], at[1] + 0.5_f64.powi(k) * step[1]];
        (0..60).map(go).find(|to| to[1] > 0.0 && self.value(*to) >= floor).unwrap_or(at)
    }

    /// Back to the mean and the standard deviation of y, errors by the chain rule.
    fn fit(&self, [delta, gamma]: [f64; 2], scale: Scale, iterations: usize) -> CensoredFit {
        let c = inverse(self.slope([delta, gamma]).information);
        let ratio = delta / gamma;
        let sd = scale.sd / gamma;
        CensoredFit {
            n: self.inside + self.low.0 + self.high.0,
            below: self.low.0,
            above: self.high.0,
            mean: scale.mean + scale.sd * ratio,
            mean_se: sd * (c[0][0] - 2.0 * ratio * c[0][1] + ratio * ratio * c[1][1]).sqrt(),
            sd,
            sd_se: sd / gamma * c[1][1].sqrt(),
            iterations,
        }
    }
}

fn inverse(m: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let d = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    [[m[1][1] / d, -m[0][1] / d], [-m[1][0] / d, m[0][0] / d]]
}

fn product(m: [[f64; 2]; 2], v: [f64; 2]) -> [f64; 2] {
    m.map(|row| row[0] * v[0] + row[1] * v[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::gauss;
    use crate::math::stats::random::Draws;

    const BOTH: Censoring = Censoring { low: Some(0.0), high: Some(18.0) };

    fn censored(n: usize, seed: u64) -> Vec<f64> {
        Draws::new(seed, 0).sample(n, 10.0, 6.0).into_iter().map(|v| v.clamp(0.0, 18.0)).collect()
    }

    #[test]
    fn a_large_sample_gives_the_parameters_back() {
        let sample = censored(20_000, 1);
        let fit = CensoredFit::of(&sample, &BOTH).unwrap();
        assert!(fit.below > 800 && fit.above > 1500);
        // Four standard errors; they are about sd / sqrt(n) = 0.042.
        assert!((fit.mean - 10.0).abs() < 4.0 * fit.mean_se && fit.mean_se < 0.05, "{fit:?}");
        assert!((fit.sd - 6.0).abs() < 4.0 * fit.sd_se && fit.sd_se < 0.05, "{fit:?}");
        let naive = crate::math::stats::NormalFit::of(&sample).unwrap();
        assert!(naive.sd < 5.6, "what was clipped looks narrower: {}", naive.sd);
    }

    #[test]
    fn errors_are_those_of_repeated_samples() {
        let fits: Vec<CensoredFit> = (0..400).map(|k| CensoredFit::of(&censored(100, k), &BOTH).unwrap()).collect();
        let sd = |pick: fn(&CensoredFit) -> f64| {
            let values: Vec<f64> = fits.iter().map(pick).collect();
            crate::math::stats::normal::mean_and_sd(&values).unwrap()
        };
        // The spread of 400 values is known to 1 / sqrt(800) = 3.5 %; four of them.
        assert!((sd(|f| f.mean).1 / sd(|f| f.mean_se).0 - 1.0).abs() < 0.14);
        assert!((sd(|f| f.sd).1 / sd(|f| f.sd_se).0 - 1.0).abs() < 0.14);
        assert!(fits.iter().all(|f| f.iterations <= 10));
    }

    #[test]
    fn the_fit_is_the_maximum_of_the_likelihood_as_it_is_defined() {
        let sample = censored(100, 3);
        let fit = CensoredFit::of(&sample, &BOTH).unwrap();
        let term = |y: f64, m: f64, s: f64| match y {
            y if y <= 0.0 => gauss::cdf((0.0 - m) / s).ln(),
            y if y >= 18.0 => gauss::cdf((m - 18.0) / s).ln(),
            y => (gauss::density((y - m) / s) / s).ln(),
        };
        let l = |m: f64, s: f64| sample.iter().map(|y| term(*y, m, s)).sum::<f64>();
        let h = 1e-3;
        let first =
            [l(fit.mean + h, fit.sd) - l(fit.mean - h, fit.sd), l(fit.mean, fit.sd + h) - l(fit.mean, fit.sd - h)];
        assert!(first.iter().all(|d| (d / (2.0 * h)).abs() < 1e-5), "{first:?}");
        let second = |a: f64, b: f64| {
            let at = |s: f64, t: f64| l(fit.mean + s * h, fit.sd + t * h);
            -(at(a, b) - 2.0 * at(0.0, 0.0) + at(-a, -b)) / (h * h)
        };
        let (mm, ss) = (second(1.0, 0.0), second(0.0, 1.0));
        let ms = 0.5 * (second(1.0, 1.0) - mm - ss);
        let c = inverse([[mm, ms], [ms, ss]]);
        // Second differences of numbers near 300 over 1e-6: 1e-7 of rounding each.
        assert!((c[0][0].sqrt() / fit.mean_se - 1.0).abs() < 1e-4 && (c[1][1].sqrt() / fit.sd_se - 1.0).abs() < 1e-4);
    }

    #[test]
    fn without_censored_values_it_is_the_plain_fit() {
        let sample = [1.0, 2.0, 3.0, 4.0];
        for censoring in [Censoring::default(), BOTH] {
            let fit = CensoredFit::of(&sample, &censoring).unwrap();
            assert!((fit.mean - 2.5).abs() < 1e-15 && (fit.sd - 1.25_f64.sqrt()).abs() < 1e-15);
            assert!((fit.sd_se - fit.sd / 8.0_f64.sqrt()).abs() < 1e-15);
        }
    }

    #[test]
    fn what_cannot_be_fitted_has_a_reason() {
        let fit = |s: &[f64]| CensoredFit::of(s, &BOTH).unwrap_err();
        assert_eq!(fit(&[1.0, 2.0]), Unfit::TooFew { n: 2 });
        assert_eq!(fit(&[0.0, 0.0, 20.0]), Unfit::AllCensored { below: 2, above: 1 });
        assert_eq!(fit(&[0.0, 3.0, 3.0]), Unfit::NoSpread { value: 3.0 });
        assert_eq!(fit(&[0.0, f64::NAN, 3.0]), Unfit::NotFinite { index: 1 });
        let turned = Censoring { low: Some(2.0), high: Some(1.0) };
        assert!(matches!(CensoredFit::of(&[1.0, 2.0, 3.0], &turned), Err(Unfit::Limits { .. })));
        // Two values inside and many outside: far from normal, but there is a maximum.
        let mut odd = vec![0.0; 50];
        odd.extend([9.0, 9.1]);
        odd.extend([18.0; 50]);
        assert!(CensoredFit::of(&odd, &BOTH).unwrap().sd > 20.0);
    }
}
