//! From runs to figures: costs, terms, rates, bias, and what multilevel and plain Monte Carlo cost.

use serde::Serialize;

use super::{Target, runs::Runs};
use crate::math::stats::{
    Bias, Rate, Summary,
    levels::{self, Pairs, Term},
    rate,
};

/// Sum of CPU times (s) below which the ticks of the clock, of a few milliseconds, are too coarse.
const SHORTEST: f64 = 0.1;

/// What a run takes at one setting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    pub runs: usize,
    /// Points moved; it depends on the case alone.
    pub particle_steps: f64,
    /// CPU time of the thread (s), wall time where the system does not tell it well enough, and the standard error of its
    /// mean.
    pub cpu_s: f64,
    pub cpu_se: f64,
}

impl Cost {
    /// Mean over all runs of a setting; zero where there are none.
    pub fn of(runs: &Runs<'_>, setting: usize) -> Cost {
        let cpu: Option<Vec<f64>> = runs.of_setting(setting).map(|d| d.cost.cpu_s).collect();
        let told = cpu.filter(|cpu| cpu.iter().sum::<f64>() >= SHORTEST);
        let seconds = told.unwrap_or_else(|| runs.of_setting(setting).map(|d| d.cost.wall_s).collect());
        let steps: Vec<f64> =
            runs.of_setting(setting).filter_map(|d| d.row.work.get("particle_steps").copied()).collect();
        let mean = |v: &[f64]| Summary::of(v).map_or(0.0, |s| s.mean);
        let cpu_se = Summary::of(&seconds).map_or(0.0, |s| s.standard_error);
        Cost { runs: seconds.len(), particle_steps: mean(&steps), cpu_s: mean(&seconds), cpu_se }
    }
}

/// Cost of one realisation of each term: both of its runs.
pub fn of_terms(levels: &[Cost], unit: fn(&Cost) -> f64) -> Vec<f64> {
    let below = std::iter::once(0.0).chain(levels.iter().map(unit));
    levels.iter().map(unit).zip(below).map(|(fine, coarse)| fine + coarse).collect()
}

/// How the cost of a run grows as the cells shrink, C = a h^-gamma.
pub fn gamma(cells: &[f64], costs: &[Cost]) -> Option<Rate> {
    let (c, e): (Vec<f64>, Vec<f64>) = costs.iter().map(|c| (c.cpu_s, c.cpu_se)).unzip();
    let r = rate(cells, &c, &e)?;
    Some(Rate { rate: -r.rate, low: -r.high, high: -r.low, ..r })
}

/// Realisations and CPU time that the target takes, by multilevel and by plain Monte Carlo on the finest level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Forecast {
    /// Of each term.
    pub realisations: Vec<u64>,
    pub cpu_s: f64,
    pub plain_realisations: u64,
    pub plain_cpu_s: f64,
}

impl Forecast {
    /// `None` for fewer than two realisations in a term. The realisations are shared out by particle-steps, so
    /// that they depend on the case alone.
    pub fn new(terms: &[Term], costs: &[Cost], target: Target) -> Option<Forecast> {
        let (variances, plain): (Vec<f64>, _) = (terms.iter().map(|t| t.variance).collect(), terms.last()?);
        let realisations = levels::allocation(&variances, &of_terms(costs, |c| c.particle_steps), target.variance());
        let seconds = of_terms(costs, |c| c.cpu_s);
        let plain_realisations = (plain.fine_variance / target.variance()).ceil().max(2.0) as u64;
        Some(Forecast {
            cpu_s: realisations.iter().zip(seconds).map(|(n, c)| *n as f64 * c).sum(),
            realisations,
            plain_realisations,
            plain_cpu_s: plain_realisations as f64 * costs.last()?.cpu_s,
        })
    }
}

/// One measure over the levels.
#[derive(Clone, Debug, Serialize)]
pub struct Quantity {
    pub name: String,
    pub terms: Vec<Term>,
    /// Of each term: realisations in which the measure is not defined at one of both levels, left out. Where there
    /// are some, the terms are means of different things, and their sum is none of the finest level's.
    pub lacking: Vec<usize>,
    /// Of each level: mean, standard error and standard deviation over all its runs.
    pub levels: Vec<Summary>,
    /// `V[Y_l - Y_(l-1)] = a h^beta`.
    pub beta: Option<Rate>,
    /// With alpha.
    pub bias: Bias,
    /// Multilevel mean on the finest level, and its standard error.
    pub mean: f64,
    pub mean_se: f64,
    /// Least cost by multilevel over that by plain Monte Carlo, for any error; 95 % interval.
    pub cost_ratio: f64,
    pub cost_ratio_interval: Option<[f64; 2]>,
    /// CPU time of the runs that the multilevel mean is made of (s), and what plain Monte Carlo would
    /// take for the same standard error.
    pub cpu_s: f64,
    pub plain_cpu_s: f64,
}

/// Results of each term at its levels.
pub fn pairs(runs: &Runs<'_>, terms: usize, name: &str) -> (Vec<Pairs>, Vec<usize>) {
    let one = |term: usize| {
        let (fine, coarse, lacking) = runs.both(term, [term, term.saturating_sub(1)], name);
        (Pairs { fine, coarse: (term > 0).then_some(coarse) }, lacking)
    };
    (0..terms).map(one).unzip()
}

/// The figures of a measure; `None` where a term has fewer than two realisations.
pub fn quantity(runs: &Runs<'_>, cells: &[f64], costs: &[Cost], name: &str) -> Option<Quantity> {
    let (pairs, lacking) = pairs(runs, cells.len(), name);
    let terms: Vec<Term> = pairs.iter().map(Pairs::term).collect::<Option<_>>()?;
    let (mean, mean_se) = levels::telescope(&terms);
    let seconds = of_terms(costs, |c| c.cpu_s);
    let (top, plain) = (terms.last()?, costs.last()?.cpu_s);
    let further = terms.get(1..)?;
    let differences: Vec<(f64, f64)> = further.iter().map(|t| (t.mean, t.mean_se)).collect();
    let (v, e): (Vec<f64>, Vec<f64>) = further.iter().map(|t| (t.variance, t.variance_se)).unzip();
    let level = |l: usize| {
        let values: Vec<f64> = runs.of_setting(l).filter_map(|d| d.row.measure(name)).collect();
        Summary::of(&values)
    };
    Some(Quantity {
        name: name.to_owned(),
        levels: (0..cells.len()).map(level).collect::<Option<_>>()?,
        beta: rate(cells.get(1..)?, &v, &e),
        bias: Bias::of(cells.get(1..)?, &differences),
        mean,
        mean_se,
        cost_ratio: levels::cost_ratio(&terms, &seconds, plain),
        cost_ratio_interval: levels::cost_ratio_interval(&pairs, &seconds, plain),
        cpu_s: terms.iter().zip(&seconds).map(|(t, c)| t.n as f64 * c).sum(),
        plain_cpu_s: top.fine_variance / (mean_se * mean_se) * plain,
        terms,
        lacking,
    })
}
