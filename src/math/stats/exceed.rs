//! How often a value is exceeded: P(X > R).

use serde::Serialize;

use super::share::Share;

/// P(X > R) at one R, with its intervals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Exceed {
    /// R, in the unit of the sample.
    pub above: f64,
    /// Values above R.
    pub count: usize,
    pub share: f64,
    /// Wilson interval at this R alone.
    pub low: f64,
    pub high: f64,
    /// Ends of the band that holds the whole curve.
    pub band_low: f64,
    pub band_high: f64,
}

/// The empirical curve of P(X > R): a staircase that falls at each value of the sample.
///
/// The band is that of Dvoretzky, Kiefer and Wolfowitz with the constant of P. Massart (Ann. Prob.
/// 18, 1990): it holds the whole curve with at least the given confidence, whatever the distribution.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Exceedance {
    pub n: usize,
    pub confidence: f64,
    /// Half-width of the band, sqrt(ln(2 / (1 - confidence)) / (2 n)).
    pub half_width: f64,
    /// From here on values only say that they are no lower, and the curve is not known.
    pub high: Option<f64>,
    #[serde(skip)]
    sorted: Vec<f64>,
}

impl Exceedance {
    /// The curve of a sample; `None` if it is empty or not finite, or the confidence is not in (0, 1).
    pub fn of(sample: &[f64], high: Option<f64>, confidence: f64) -> Option<Self> {
        super::standard_errors(confidence)?;
        let mut sorted = sample.to_vec();
        sorted.sort_by(f64::total_cmp);
        let usable = !sorted.is_empty() && sorted.iter().chain(&high).all(|v| v.is_finite());
        let half_width = ((2.0 / (1.0 - confidence)).ln() / (2.0 * sorted.len() as f64)).sqrt();
        usable.then_some(Exceedance { n: sorted.len(), confidence, half_width, high, sorted })
    }

    /// P(X > R); `None` where the curve is not known.
    pub fn at(&self, above: f64) -> Option<Exceed> {
        if above.is_nan() || self.high.is_some_and(|high| above >= high) {
            return None;
        }
        let count = self.n - self.sorted.partition_point(|v| *v <= above);
        let share = Share::wilson(count, self.n, self.confidence)?;
        let band = |sign: f64| (share.share + sign * self.half_width).clamp(0.0, 1.0);
        let (band_low, band_high) = (band(-1.0), band(1.0));
        Some(Exceed { above, count, share: share.share, low: share.low, high: share.high, band_low, band_high })
    }

    /// The curve at every value at which it falls.
    pub fn steps(&self) -> Vec<Exceed> {
        let mut values = self.sorted.clone();
        values.dedup();
        values.into_iter().filter_map(|v| self.at(v)).collect()
    }

    /// Lowest and highest value of the sample.
    pub fn range(&self) -> (f64, f64) {
        let end = |v: Option<&f64>| v.copied().unwrap_or(f64::NAN);
        (end(self.sorted.first()), end(self.sorted.last()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::{gauss, random::Draws};

    #[test]
    fn counts_and_width() {
        let e = Exceedance::of(&[3.0, 1.0, 2.0, 2.0, 20.0], Some(18.0), 0.95).unwrap();
        let shares: Vec<f64> = e.steps().iter().map(|s| s.share).collect();
        assert_eq!(shares, [0.8, 0.4, 0.2]);
        assert_eq!((e.at(0.0).unwrap().share, e.at(17.9).unwrap().count, e.at(18.0)), (1.0, 1, None));
        let hundred = Exceedance::of(&[0.0; 100], None, 0.95).unwrap();
        // sqrt(ln 40 / 200)
        assert!((hundred.half_width - 0.135_810_151_574_061_95).abs() < 1e-15);
        assert!(Exceedance::of(&[], None, 0.95).is_none() && Exceedance::of(&[1.0], None, 1.0).is_none());
    }

    #[test]
    fn the_band_holds_the_whole_curve() {
        let holds = |k: usize| {
            let e = Exceedance::of(&Draws::new(5, k).sample(100, 0.0, 1.0), None, 0.95).unwrap();
            let truth = |r: f64| gauss::cdf(-r);
            // The empirical curve is farthest from a smooth one on either side of a step.
            let steps = e.steps();
            steps.iter().all(|s| (s.share - truth(s.above)).abs() <= e.half_width)
                && steps.iter().all(|s| (s.share + 0.01 - truth(s.above)).abs() <= e.half_width)
        };
        let missed = (0..1000).filter(|k| !holds(*k)).count();
        // At most 50 expected; four standard errors of 6.9. The bound is nearly sharp for n = 100.
        assert!((15..78).contains(&missed), "{missed}");
    }
}
