//! How a mean and a standard deviation settle with the number of realisations, and when to stop.

use serde::Serialize;

use super::share::wilson;

/// Sums over the values so far. A value that is not finite takes its place in the order but is not
/// counted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Running {
    len: usize,
    n: usize,
    mean: f64,
    /// Sums of powers of the distance to the mean.
    m2: f64,
    m3: f64,
    m4: f64,
}

/// Estimates from the first values of a sample, in its unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Prefix {
    /// Values seen, whether finite or not.
    pub len: usize,
    /// Finite values.
    pub n: usize,
    pub mean: f64,
    /// sd / sqrt(n); NaN for n = 1.
    pub mean_se: f64,
    /// With n - 1; NaN for n = 1.
    pub sd: f64,
    /// From the fourth moment, sqrt((m4 - sd^4 (n - 3) / (n - 1)) / n) / (2 sd); NaN for n < 4.
    pub sd_se: f64,
}

impl Running {
    /// Takes one more value (one-pass sums of B. Welford 1962 and P. Pébay, SAND2008-6212).
    pub fn push(&mut self, value: f64) {
        self.len += 1;
        if !value.is_finite() {
            return;
        }
        self.n += 1;
        let (n, d) = (self.n as f64, value - self.mean);
        let (s, t) = (d / n, d * d / n * (n - 1.0));
        self.mean += s;
        self.m4 += t * s * s * (n * n - 3.0 * n + 3.0) + 6.0 * s * s * self.m2 - 4.0 * s * self.m3;
        self.m3 += t * s * (n - 2.0) - 3.0 * s * self.m2;
        self.m2 += t;
    }

    /// The estimates so far; `None` before the first finite value.
    pub fn prefix(&self) -> Option<Prefix> {
        let n = self.n as f64;
        let variance = self.m2 / (n - 1.0);
        let sd = variance.sqrt();
        let spread = (self.m4 / n - variance * variance * (n - 3.0) / (n - 1.0)) / n;
        // With all values the same nothing spreads; rounding may make a tiny negative number.
        let sd_se = match self.n {
            0..4 => f64::NAN,
            _ if sd == 0.0 => 0.0,
            _ => spread.max(0.0).sqrt() / (2.0 * sd),
        };
        (self.n > 0).then_some(Prefix { len: self.len, n: self.n, mean: self.mean, mean_se: sd / n.sqrt(), sd, sd_se })
    }
}

/// The estimates after each value in order.
pub fn running(sample: &[f64]) -> Vec<Prefix> {
    let mut sums = Running::default();
    let mut after = |v: &f64| {
        sums.push(*v);
        sums.prefix()
    };
    sample.iter().filter_map(&mut after).collect()
}

/// Whose standard error a rule looks at.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    Mean,
    Sd,
    /// The share of values above this one (unit of the sample).
    ShareAbove(f64),
}

/// Stop as soon as the standard error is small enough. Decided on the values in their order, so it does not
/// depend on which became known first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rule {
    pub target: Target,
    /// In the unit of the sample, or as a share.
    pub standard_error: f64,
    /// Finite values that are needed in any case.
    pub at_least: usize,
}

/// Where a rule was met.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reached {
    /// Values up to there, whether finite or not.
    pub len: usize,
    pub standard_error: f64,
}

impl Rule {
    /// The first prefix that meets the rule.
    pub fn first(&self, sample: &[f64]) -> Option<Reached> {
        let (mut sums, mut above) = (Running::default(), 0);
        for value in sample {
            sums.push(*value);
            above += usize::from(matches!(self.target, Target::ShareAbove(r) if *value > r && value.is_finite()));
            let standard_error = self.error(&sums, above);
            // NaN, where there are too few values, is not small.
            if sums.n >= self.at_least && standard_error <= self.standard_error {
                return Some(Reached { len: sums.len, standard_error });
            }
        }
        None
    }

    /// The standard error now; NaN where there are too few values. For a share half the Wilson interval of one
    /// standard error, which is not 0 for a share of 0.
    fn error(&self, sums: &Running, above: usize) -> f64 {
        match (self.target, sums.prefix()) {
            (_, None) => f64::NAN,
            (Target::Mean, Some(p)) => p.mean_se,
            (Target::Sd, Some(p)) => p.sd_se,
            (Target::ShareAbove(_), Some(p)) => wilson(above, p.n, 1.0).1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::{NormalFit, random::Draws};

    #[test]
    fn the_last_prefix_is_the_whole_sample() {
        let sample = Draws::new(4, 0).sample(500, 1e6, 3.0);
        let last = running(&sample).pop().unwrap();
        let fit = NormalFit::of(&sample).unwrap();
        assert!((last.mean - fit.mean).abs() < 1e-9 && (last.sd / fit.sd - 1.0).abs() < 1e-9);
        let n = 500.0;
        let moment = |k: i32| sample.iter().map(|v| (v - fit.mean).powi(k)).sum::<f64>() / n;
        let exact = ((moment(4) - fit.sd.powi(4) * (n - 3.0) / (n - 1.0)) / n).sqrt() / (2.0 * fit.sd);
        assert!((last.sd_se / exact - 1.0).abs() < 1e-9);
        // A normal sample of 500 knows its fourth moment to sqrt(24 / n) = 22 % of 2 sd^4: four of 11 % of the error.
        assert!((last.sd_se / fit.sd_se - 1.0).abs() < 0.44);
    }

    #[test]
    fn the_rule_is_met_where_the_error_is_small_enough() {
        let sample = Draws::new(4, 1).sample(400, 10.0, 3.0);
        let prefixes = running(&sample);
        for (target, pick) in [(Target::Mean, Prefix::mean_error as fn(&Prefix) -> f64), (Target::Sd, |p| p.sd_se)] {
            let rule = Rule { target, standard_error: 0.25, at_least: 30 };
            let reached = rule.first(&sample).unwrap();
            assert!((30..300).contains(&reached.len) && reached.standard_error <= 0.25);
            let before = &prefixes[29..reached.len - 1];
            assert!(before.iter().all(|p| pick(p) > 0.25));
        }
        assert!(Rule { target: Target::Mean, standard_error: 0.01, at_least: 1 }.first(&sample).is_none());
    }

    impl Prefix {
        fn mean_error(&self) -> f64 {
            self.mean_se
        }
    }

    #[test]
    fn failed_runs_take_a_place_and_nothing_more() {
        let mut sample = vec![1.0, f64::NAN, 1.0, 1.0];
        let rule = Rule { target: Target::Mean, standard_error: 0.1, at_least: 3 };
        assert_eq!(rule.first(&sample), Some(Reached { len: 4, standard_error: 0.0 }));
        sample.truncate(3);
        assert_eq!(rule.first(&sample), None);
        assert_eq!(running(&sample).iter().map(|p| (p.len, p.n)).collect::<Vec<_>>(), [(1, 1), (2, 1), (3, 2)]);
    }

    #[test]
    fn a_share_of_nothing_is_not_known_exactly() {
        let rule = Rule { target: Target::ShareAbove(5.0), standard_error: 0.01, at_least: 10 };
        // (1 / (4 n^2))^(1/2) / (1 + 1 / n) <= 0.01 from n = 49 on.
        assert_eq!(rule.first(&[0.0; 100]).unwrap().len, 49);
    }
}
