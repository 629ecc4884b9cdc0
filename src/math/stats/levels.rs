//! Multilevel Monte Carlo: the mean on a fine level as the sum of means of differences between levels,
//!
//! `E[Y_L] = E[Y_0] + sum over l of E[Y_l - Y_(l-1)]`,
//!
//! each with realisations of its own (M. Giles, Oper. Res. 56(3), 2008; Acta Numer. 24, 2015). A *term* is one of
//! these means. Costs are in any unit, the same for all levels.

use serde::Serialize;

use super::random::Draws;
use super::{CONFIDENCE, Correlation, quantile};

/// Results of a term's realisations on the fine level and, but for the first term, on the coarse one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pairs {
    pub fine: Vec<f64>,
    pub coarse: Option<Vec<f64>>,
}

/// What a term came to, in the unit of the results.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Term {
    pub n: usize,
    /// Of Y_l - Y_(l-1); of Y_0 in the first term.
    pub mean: f64,
    pub mean_se: f64,
    /// V_l, with n - 1.
    pub variance: f64,
    /// From the fourth moment; too small a guess for heavy tails and few realisations.
    pub variance_se: f64,
    /// Of Y_l.
    pub fine_variance: f64,
    /// Of Y_l with Y_(l-1).
    pub correlation: Option<Correlation>,
}

impl Pairs {
    /// Y_l - Y_(l-1), or Y_0; places that one side lacks are left out.
    pub fn differences(&self) -> Vec<f64> {
        match &self.coarse {
            Some(coarse) => self.fine.iter().zip(coarse).map(|(f, c)| f - c).collect(),
            None => self.fine.clone(),
        }
    }

    /// Mean and variance; `None` for fewer than two realisations or what is not finite.
    pub fn term(&self) -> Option<Term> {
        let d = self.differences();
        let (mean, variance, variance_se) = spread(&d)?;
        Some(Term {
            n: d.len(),
            mean,
            mean_se: (variance / d.len() as f64).sqrt(),
            variance,
            variance_se,
            fine_variance: spread(&self.fine)?.1,
            correlation: self.coarse.as_ref().and_then(|c| Correlation::of(c, &self.fine, CONFIDENCE)),
        })
    }
}

/// Mean, variance s^2 and its standard error, sqrt((m4 - (n - 3) / (n - 1) s^4) / n).
fn spread(sample: &[f64]) -> Option<(f64, f64, f64)> {
    let (mean, sd) = super::normal::mean_and_sd(sample)?;
    let (n, variance) = (sample.len() as f64, sd * sd);
    let fourth = sample.iter().map(|v| (v - mean).powi(4)).sum::<f64>() / n;
    let of_variance = (fourth - (n - 3.0) / (n - 1.0) * variance * variance) / n;
    Some((mean, variance, of_variance.max(0.0).sqrt()))
}

/// Sum of the terms and its standard error: the terms are independent.
pub fn telescope(terms: &[Term]) -> (f64, f64) {
    let variance: f64 = terms.iter().map(|t| t.mean_se * t.mean_se).sum();
    (terms.iter().map(|t| t.mean).sum(), variance.sqrt())
}

/// Realisations of each term for the least cost with the variance `target` of the sum,
/// N_l = ceil(sqrt(V_l / C_l) sum_k sqrt(V_k C_k) / target), at least 2. With half of eps^2 for the bias,
/// target = eps^2 / 2, it is the formula of Giles (2008).
pub fn allocation(variances: &[f64], costs: &[f64], target: f64) -> Vec<u64> {
    let sum = root_sum(variances, costs);
    // a float too large for u64 becomes the largest one
    variances.iter().zip(costs).map(|(v, c)| ((v / c).sqrt() * sum / target).ceil().max(2.0) as u64).collect()
}

/// sum_k sqrt(V_k C_k): its square over the variance wanted is the least cost.
pub fn root_sum(variances: &[f64], costs: &[f64]) -> f64 {
    variances.iter().zip(costs).map(|(v, c)| (v * c).sqrt()).sum()
}

/// Least cost of the multilevel sum over that of plain Monte Carlo on the finest level, for the same variance:
/// `(sum sqrt(V_l C_l))^2 / (V[Y_L] C)`, with `plain` = C, the cost of one run of the finest level.
pub fn cost_ratio(terms: &[Term], costs: &[f64], plain: f64) -> f64 {
    let variances: Vec<f64> = terms.iter().map(|t| t.variance).collect();
    root_sum(&variances, costs).powi(2) / (terms.last().map_or(f64::NAN, |t| t.fine_variance) * plain)
}

/// Percentile interval (95 %) of [`cost_ratio`], by resampling the realisations of each term.
pub fn cost_ratio_interval(pairs: &[Pairs], costs: &[f64], plain: f64) -> Option<[f64; 2]> {
    const RESAMPLES: usize = 1000;
    let one = |k: usize| {
        let mut draws = Draws::new(0, k);
        let terms: Option<Vec<Term>> = pairs.iter().map(|p| resample(p, &mut draws).term()).collect();
        Some(cost_ratio(&terms?, costs, plain)).filter(|r| r.is_finite())
    };
    let mut ratios: Vec<f64> = (0..RESAMPLES).filter_map(one).collect();
    ratios.sort_by(f64::total_cmp);
    let outside = 0.5 * (1.0 - CONFIDENCE);
    Some([quantile(&ratios, outside)?, quantile(&ratios, 1.0 - outside)?])
}

fn resample(pairs: &Pairs, draws: &mut Draws) -> Pairs {
    let n = pairs.fine.len();
    let places: Vec<usize> = (0..n).map(|_| draws.index(n)).collect();
    let pick = |values: &Vec<f64>| places.iter().filter_map(|k| values.get(*k).copied()).collect();
    Pairs { fine: pick(&pairs.fine), coarse: pairs.coarse.as_ref().map(pick) }
}

/// P(Y_L > R) at one R.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Beyond {
    /// R, in the unit of the results.
    pub above: f64,
    /// Sum of the means of differences of indicators: may lie outside 0..1 and rise with R.
    pub share: f64,
    /// At this R alone.
    pub standard_error: f64,
}

/// P(Y_L > R) by differences of indicators, without smoothing. Standard errors are those of A. Agresti and B. Coull
/// (Am. Stat. 52, 1998) and, for pairs, of A. Agresti and Y. Min (Stat. Med. 24, 2005), who add a few imagined
/// realisations: a term in which no pair differs is not known to be 0.
pub fn beyond(pairs: &[Pairs], above: f64) -> Beyond {
    let terms: Vec<(f64, f64)> = pairs.iter().map(|p| indicator(p, above)).collect();
    Beyond {
        above,
        share: terms.iter().map(|t| t.0).sum(),
        standard_error: terms.iter().map(|t| t.1).sum::<f64>().sqrt(),
    }
}

/// Mean of a term's indicator and the variance of that mean.
fn indicator(pairs: &Pairs, above: f64) -> (f64, f64) {
    let n = pairs.fine.len() as f64;
    let Some(coarse) = &pairs.coarse else {
        let count = pairs.fine.iter().filter(|f| **f > above).count() as f64;
        let share = (count + 2.0) / (n + 4.0);
        return (count / n, share * (1.0 - share) / (n + 4.0));
    };
    let count = |fine: bool| {
        let differs = pairs.fine.iter().zip(coarse).filter(|(f, c)| (**f > above) == fine && (**c > above) != fine);
        differs.count() as f64
    };
    let (up, down) = (count(true), count(false));
    let of_mean = (up + down + 1.0 - (up - down).powi(2) / (n + 2.0)) / (n + 2.0).powi(2);
    ((up - down) / n, of_mean)
}

/// The curve as a picture may show it: within 0..1, and the mean of the nearest curves that do not rise, one from
/// above and one from below. Neither is unbiased.
pub fn falling(shares: &[f64]) -> Vec<f64> {
    let clipped: Vec<f64> = shares.iter().map(|s| s.clamp(0.0, 1.0)).collect();
    let run = |least: f64, v: &f64| least.min(*v);
    let below = clipped.iter().scan(f64::INFINITY, |s, v| {
        *s = run(*s, v);
        Some(*s)
    });
    let mut above: Vec<f64> = clipped
        .iter()
        .rev()
        .scan(f64::NEG_INFINITY, |s, v| {
            *s = s.max(*v);
            Some(*s)
        })
        .collect();
    above.reverse();
    below.zip(above).map(|(a, b)| 0.5 * (a + b)).collect()
}

#[cfg(test)]
mod tests;
