//! Whether a sample looks normal.
//!
//! Kolmogorov-Smirnov and Anderson-Darling statistics against the normal that was fitted to the same
//! sample. The fit makes both smaller than tables for a known normal say (H. Lilliefors, J. Am. Stat.
//! Assoc. 62, 1967), so the p-value comes from simulated normal samples that are rounded, censored and
//! fitted like the sample itself.

use serde::Serialize;

use super::censored::{CensoredFit, Censoring, Unfit};
use super::gauss::{cdf, log_cdf};
use super::normal::NormalFit;
use super::random::Draws;

/// How to test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalTest {
    /// Values beyond a limit tell a side only; both statistics then look between the limits.
    pub censoring: Censoring,
    /// Step in which values come (unit of the sample); 0 for a continuous sample. r comes in columns
    /// of points. Without it, ties alone make a large sample look as if it were not normal.
    pub resolution: f64,
    /// Simulated samples. p is known to sqrt(p (1 - p) / resamples): 0.005 at 0.05 for 2000.
    pub resamples: usize,
    pub seed: u64,
}

impl Default for NormalTest {
    fn default() -> Self {
        NormalTest { censoring: Censoring::default(), resolution: 0.0, resamples: 2000, seed: 0 }
    }
}

/// What a test says. A small p-value: a normal sample of this size, rounded and censored like this one,
/// would seldom be that far from its fit. A large one proves nothing; 100 values tell little.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Goodness {
    pub n: usize,
    /// Values between the limits that differ; fewer than `n` where there are ties.
    pub distinct: usize,
    /// Largest distance between the two distribution functions.
    pub kolmogorov_smirnov: f64,
    pub kolmogorov_smirnov_p: f64,
    /// n times the integral of (F_n - F)^2 / (F (1 - F)) over F.
    pub anderson_darling: f64,
    pub anderson_darling_p: f64,
    /// Simulated samples that could be fitted.
    pub resamples: usize,
}

/// Both statistics of a sample.
#[derive(Clone, Copy, Debug)]
struct Distances {
    largest: f64,
    weighted: f64,
}

impl NormalTest {
    /// Tests a sample against the normal fitted to it.
    ///
    /// # Errors
    /// Why the sample, or more than a tenth of the simulated ones, has no fit.
    pub fn of(&self, sample: &[f64]) -> Result<Goodness, Unfit> {
        let (mean, sd) = self.fit(sample)?;
        let seen = self.distances(sample, (mean, sd));
        let simulated: Vec<Distances> = (0..self.resamples)
            .filter_map(|k| {
                let sample = self.simulate(k, sample.len(), mean, sd);
                Some(self.distances(&sample, self.fit(&sample).ok()?))
            })
            .collect();
        if 10 * simulated.len() < 9 * self.resamples {
            return Err(Unfit::Resamples { fitted: simulated.len(), of: self.resamples });
        }
        Ok(Goodness {
            n: sample.len(),
            distinct: self.steps(sample).len(),
            kolmogorov_smirnov: seen.largest,
            kolmogorov_smirnov_p: p_value(seen.largest, simulated.iter().map(|d| d.largest)),
            anderson_darling: seen.weighted,
            anderson_darling_p: p_value(seen.weighted, simulated.iter().map(|d| d.weighted)),
            resamples: simulated.len(),
        })
    }

    /// Mean and sd as the fit that the caller would show has them.
    fn fit(&self, sample: &[f64]) -> Result<(f64, f64), Unfit> {
        let censored = CensoredFit::of(sample, &self.censoring)?;
        match NormalFit::of(sample).filter(|_| self.censoring.is_none()) {
            Some(plain) => Ok((plain.mean, plain.sd)),
            None => Ok((censored.mean, censored.sd)),
        }
    }

    fn simulate(&self, k: usize, n: usize, mean: f64, sd: f64) -> Vec<f64> {
        let mut sample = Draws::new(self.seed, k).sample(n, mean, sd);
        if self.resolution > 0.0 {
            sample.iter_mut().for_each(|v| *v = (*v / self.resolution).round() * self.resolution);
        }
        sample
    }

    /// Values between the limits in order, each with the number of values up to it.
    fn steps(&self, sample: &[f64]) -> Vec<(f64, usize)> {
        let mut inside: Vec<f64> = sample.iter().copied().filter(|v| self.censoring.is_inside(*v)).collect();
        inside.sort_by(f64::total_cmp);
        let mut count = sample.iter().filter(|v| self.censoring.is_below(**v)).count();
        let mut steps = Vec::new();
        for equal in inside.chunk_by(|a, b| a == b) {
            count += equal.len();
            steps.push((equal[0], count));
        }
        steps
    }

    /// F_n is constant between its steps, so both distances are sums over the pieces.
    fn distances(&self, sample: &[f64], (mean, sd): (f64, f64)) -> Distances {
        let n = sample.len() as f64;
        let place = |x: f64| (x - mean) / sd;
        let below = sample.iter().filter(|v| self.censoring.is_below(**v)).count();
        let mut found = Distances { largest: 0.0, weighted: 0.0 };
        let mut from = (self.censoring.low.map_or(f64::NEG_INFINITY, place), below as f64 / n);
        let end = (self.censoring.high.map_or(f64::INFINITY, place), f64::NAN);
        for (z, share) in self.steps(sample).into_iter().map(|(x, k)| (place(x), k as f64 / n)).chain([end]) {
            let distance = (from.1 - cdf(from.0)).abs().max((from.1 - cdf(z)).abs());
            found.largest = found.largest.max(distance);
            found.weighted += n * (primitive(from.1, z) - primitive(from.1, from.0));
            from = (z, share);
        }
        found
    }
}

/// integral of (c - u)^2 / (u (1 - u)) du = -u + c^2 ln u - (1 - c)^2 ln(1 - u), at u = Phi(z)
fn primitive(c: f64, z: f64) -> f64 {
    // c is 0 at the lower end of an uncensored sample, 1 at the upper one; 0 times infinity is 0 there.
    let tail = |weight: f64, z: f64| if weight == 0.0 { 0.0 } else { weight * weight * log_cdf(z) };
    tail(c, z) - tail(1.0 - c, -z) - cdf(z)
}

/// Share of simulated statistics that are as large, the one seen counted among them
/// (A. Davison and D. Hinkley, Bootstrap Methods and their Application, 1997, eq. 4.11).
fn p_value(seen: f64, simulated: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = simulated.len();
    // Statistics of rounded samples repeat; rounding must not decide which is larger.
    let as_large = simulated.filter(|s| *s >= seen - 1e-12 * seen.abs()).count();
    (as_large + 1) as f64 / (n + 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::quantile;

    fn simulated(test: &NormalTest, n: usize) -> Vec<Distances> {
        let fitted = |k| {
            let sample = test.simulate(k, n, 0.0, 1.0);
            test.distances(&sample, test.fit(&sample).unwrap())
        };
        (0..test.resamples).map(fitted).collect()
    }

    #[test]
    fn critical_values_are_the_published_ones() {
        // At the 5 % level. KS: 0.192 for n = 20 and 0.0888 for 100 (0.895 / (sqrt n - 0.01 + 0.85 / sqrt n),
        // M. Stephens, J. Am. Stat. Assoc. 69, 1974). AD: A2 (1 + 0.75 / n + 2.25 / n^2) = 0.752, D'Agostino and Stephens 1986.
        for (n, largest) in [(20, 0.192), (100, 0.0888)] {
            let test = NormalTest { resamples: 40_000, ..NormalTest::default() };
            let all = simulated(&test, n);
            let critical = |pick: fn(&Distances) -> f64| {
                let mut values: Vec<f64> = all.iter().map(pick).collect();
                values.sort_by(f64::total_cmp);
                quantile(&values, 0.95).unwrap()
            };
            // Of 40 000 samples the share beyond is known to 0.0011, which the density there turns into
            // 0.35 % of the quantile (KS) and 0.8 % (AD): three of them.
            let (ks, ad) = (critical(|d| d.largest), critical(|d| d.weighted));
            let n = n as f64;
            assert!((ks / largest - 1.0).abs() < 0.0105, "{n}: KS {ks}");
            assert!((ad * (1.0 + 0.75 / n + 2.25 / (n * n)) / 0.752 - 1.0).abs() < 0.024, "{n}: AD {ad}");
        }
    }

    #[test]
    fn the_sum_over_pieces_is_the_textbook_formula() {
        let sample = [0.3, -1.2, 2.2, 0.1, 0.9, -0.4];
        let test = NormalTest::default();
        let found = test.distances(&sample, (0.2, 1.1));
        let mut u: Vec<f64> = sample.iter().map(|x| cdf((x - 0.2) / 1.1)).collect();
        u.sort_by(f64::total_cmp);
        let n = u.len();
        let sum: f64 = (0..n).map(|i| (2 * i + 1) as f64 * (u[i].ln() + (1.0 - u[n - 1 - i]).ln())).sum();
        assert!((found.weighted - (-(n as f64) - sum / n as f64)).abs() < 1e-12);
        let ks = (0..n).map(|i| (u[i] - i as f64 / n as f64).max((i + 1) as f64 / n as f64 - u[i])).fold(0.0, f64::max);
        assert!((found.largest - ks).abs() < 1e-15);
    }

    #[test]
    fn columns_and_walls_are_no_evidence_against_a_normal() {
        let censoring = Censoring { low: Some(0.0), high: Some(18.0) };
        let test = NormalTest { censoring, resolution: 2.0, resamples: 300, ..NormalTest::default() };
        let fits = |p: f64| p > 0.01;
        let mut kept = [0, 0];
        for k in 0..40 {
            let sample = test.simulate(1000 + k, 200, 10.0, 6.0);
            let clamped: Vec<f64> = sample.iter().map(|v| v.clamp(0.0, 18.0)).collect();
            kept[0] += usize::from(fits(test.of(&clamped).unwrap().anderson_darling_p));
            let blind = NormalTest { resamples: 300, ..NormalTest::default() };
            kept[1] += usize::from(fits(blind.of(&clamped).unwrap().anderson_darling_p));
        }
        // Binomial(40, 0.01) exceeds 4 with probability 6e-5.
        assert!(kept[0] >= 36, "{kept:?}");
        assert!(kept[1] <= 4, "taken as continuous, the same samples are refused: {kept:?}");
    }

    #[test]
    fn what_is_not_normal_is_found() {
        let flat: Vec<f64> = (0..100).map(f64::from).collect();
        let p = NormalTest::default().of(&flat).unwrap();
        // A2 of a uniform sample of 100 is about 1.1, well beyond 0.75.
        assert!(p.anderson_darling > 0.9 && p.anderson_darling_p < 0.03, "{p:?}");
        assert!(NormalTest::default().of(&[1.0, 1.0, 1.0]).is_err());
    }
}
