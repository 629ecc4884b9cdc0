//! Standard error and interval of any statistic, by resampling.

use serde::Serialize;

use super::random::Draws;
use super::{CONFIDENCE, quantile};

/// How to resample: `resamples` samples of n values drawn with replacement.
///
/// Efron and Tibshirani, An Introduction to the Bootstrap, 1993: the standard error is known to
/// about 1 / sqrt(2 resamples) of itself, 1.6 % for 2000.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bootstrap {
    pub resamples: usize,
    pub seed: u64,
    /// Of the percentile interval, in 0..1.
    pub confidence: f64,
}

impl Default for Bootstrap {
    fn default() -> Self {
        Bootstrap { resamples: 2000, seed: 0, confidence: CONFIDENCE }
    }
}

/// How far a statistic spreads over resamples; in its unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    pub standard_error: f64,
    /// Ends of the percentile interval.
    pub low: f64,
    pub high: f64,
}

/// A statistic over resamples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resampled {
    /// Over the resamples that have it; `None` for fewer than two.
    pub spread: Option<Spread>,
    /// Share of the resamples that have it.
    pub defined: f64,
}

impl Bootstrap {
    /// Spread of a statistic, which is given each resample in ascending order. `None` if the sample
    /// is empty or not finite, or if the statistic is finite for fewer than two resamples.
    pub fn spread(&self, sample: &[f64], statistic: impl Fn(&[f64]) -> f64) -> Option<Spread> {
        let [spread] = self.spreads(sample, |s| [statistic(s)]);
        spread
    }

    /// The same for several statistics of the same resamples.
    pub fn spreads<const K: usize>(
        &self,
        sample: &[f64],
        statistics: impl Fn(&[f64]) -> [f64; K],
    ) -> [Option<Spread>; K] {
        let mut sorted = sample.to_vec();
        sorted.sort_by(f64::total_cmp);
        if sorted.is_empty() || sorted.iter().any(|v| !v.is_finite()) {
            return [None; K];
        }
        let mut resample = Resample::new(&sorted, self.seed);
        let rows: Vec<[f64; K]> = (0..self.resamples).map(|k| statistics(resample.draw(k))).collect();
        std::array::from_fn(|k| self.summarise(rows.iter().map(|row| row[k])))
    }

    /// Statistics of several samples at once, each resample in any order. `paired`: values of one place belong
    /// together and are drawn together (the samples are as long as the shortest). A statistic that is not finite is
    /// one that the resample does not have.
    pub fn joint(
        &self,
        samples: &[Vec<f64>],
        paired: bool,
        statistics: impl Fn(&[Vec<f64>]) -> Vec<f64>,
    ) -> Vec<Resampled> {
        let rows: Vec<Vec<f64>> =
            (0..self.resamples).map(|k| statistics(&redrawn(samples, paired, self.seed, k))).collect();
        let of = |k: usize| {
            let values = || rows.iter().filter_map(|row| row.get(k)).copied().filter(|v| v.is_finite());
            Resampled { spread: self.summarise(values()), defined: values().count() as f64 / rows.len() as f64 }
        };
        (0..rows.first().map_or(0, Vec::len)).map(of).collect()
    }

    fn summarise(&self, values: impl Iterator<Item = f64>) -> Option<Spread> {
        let mut values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let outside = 0.5 * (1.0 - self.confidence);
        let (_, sd) = super::normal::mean_and_sd(&values)?;
        Some(Spread { standard_error: sd, low: quantile(&values, outside)?, high: quantile(&values, 1.0 - outside)? })
    }
}

/// Resample `k` of several samples.
fn redrawn(samples: &[Vec<f64>], paired: bool, seed: u64, k: usize) -> Vec<Vec<f64>> {
    let mut draws = Draws::new(seed, k);
    let shortest = samples.iter().map(Vec::len).min().unwrap_or(0);
    let places: Vec<usize> = if paired { (0..shortest).map(|_| draws.index(shortest)).collect() } else { Vec::new() };
    let mut one = |sample: &Vec<f64>| -> Vec<f64> {
        if paired {
            return places.iter().map(|&k| sample[k]).collect();
        }
        (0..sample.len()).map(|_| sample[draws.index(sample.len())]).collect()
    };
    samples.iter().map(&mut one).collect()
}

/// One resample after the other, each in ascending order without being sorted.
struct Resample<'a> {
    sorted: &'a [f64],
    seed: u64,
    counts: Vec<usize>,
    values: Vec<f64>,
}

impl<'a> Resample<'a> {
    fn new(sorted: &'a [f64], seed: u64) -> Self {
        Resample { sorted, seed, counts: vec![0; sorted.len()], values: Vec::with_capacity(sorted.len()) }
    }

    fn draw(&mut self, k: usize) -> &[f64] {
        let mut draws = Draws::new(self.seed, k);
        self.counts.fill(0);
        (0..self.sorted.len()).for_each(|_| self.counts[draws.index(self.sorted.len())] += 1);
        self.values.clear();
        for (value, count) in self.sorted.iter().zip(&self.counts) {
            self.values.extend(std::iter::repeat_n(*value, *count));
        }
        &self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::normal::mean_and_sd;

    #[test]
    fn the_error_of_a_mean_is_that_of_the_formula() {
        let sample: Vec<f64> = (0..100).map(|k| f64::from(k * 37 % 100)).collect();
        let spread = Bootstrap::default().spread(&sample, |s| mean_and_sd(s).unwrap().0).unwrap();
        let sd = mean_and_sd(&sample).unwrap().1;
        // A bootstrap divides by n, not n - 1, and 2000 resamples leave 1.6 %: four of them.
        let exact = sd * 0.99_f64.sqrt() / 10.0;
        assert!((spread.standard_error / exact - 1.0).abs() < 0.064, "{}", spread.standard_error / exact);
        assert!((spread.high - spread.low) / exact > 3.7 && (spread.high - spread.low) / exact < 4.2);
    }

    #[test]
    fn resamples_are_reproducible_sorted_and_whole() {
        let sample = [3.0, 1.0, 2.0, 5.0, 4.0];
        let go = |seed| Bootstrap { seed, ..Bootstrap::default() }.spread(&sample, |s| s[2]);
        assert_eq!(go(1), go(1));
        assert_ne!(go(1), go(2));
        let ordered = |s: &[f64]| f64::from(u8::from(s.len() == 5 && s.windows(2).all(|w| w[0] <= w[1])));
        assert_eq!(Bootstrap::default().spread(&sample, ordered).unwrap().low, 1.0);
        assert!(Bootstrap::default().spread(&[], |_| 0.0).is_none());
        assert!(Bootstrap::default().spread(&[1.0, f64::NAN], |_| 0.0).is_none());
    }
    /// b = a + 1 exactly: paired, the difference of the means does not spread; on its own it spreads by sqrt 2 of
    /// one mean. Four times the 1.6 % of 2000 resamples.
    #[test]
    fn pairs_are_drawn_together() {
        let a: Vec<f64> = (0..50).map(|k| f64::from(k * 37 % 50)).collect();
        let b: Vec<f64> = a.iter().map(|v| v + 1.0).collect();
        let samples = [a.clone(), b];
        let mean = |s: &[f64]| mean_and_sd(s).unwrap().0;
        let difference = |s: &[Vec<f64>]| vec![mean(&s[1]) - mean(&s[0]), f64::NAN];
        let paired = Bootstrap::default().joint(&samples, true, difference);
        assert!(paired[0].spread.unwrap().standard_error < 1e-12 && paired[0].defined == 1.0);
        assert!(paired[1].spread.is_none() && paired[1].defined == 0.0);
        let alone = Bootstrap::default().joint(&samples, false, difference)[0].spread.unwrap();
        let exact = mean_and_sd(&a).unwrap().1 * (2.0_f64 * 0.98 / 50.0).sqrt();
        assert!((alone.standard_error / exact - 1.0).abs() < 0.064, "{}", alone.standard_error / exact);
    }
}
