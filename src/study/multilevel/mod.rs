//! `rmpm multilevel`: what a mean over realisations costs. Levels of cell size with the same random fields, the
//! best split between bias and standard error, and multilevel Monte Carlo beside the plain one.
//!
//! A term l of the multilevel sum has realisations of its own, each run at the levels l and l - 1. So terms are
//! independent, and the same runs tell mean, variance and cost of every level.

mod estimate;
pub mod picture;
mod remarks;
mod runs;
mod settings;
mod split;
pub mod text;

use std::io::Write;

use serde::Serialize;

pub use estimate::{Cost, Forecast, Quantity};
pub use settings::{Levels, Setting};
pub use split::{Budget, Offer, Split};

use crate::{
    math::stats::{
        Rate,
        levels::{self, Beyond},
    },
    output::record::{Build, SCHEMA_VERSION},
    run::Limits,
    study::ensemble::{Problem, SLIDING_DISTANCE, needs_crest},
};
use runs::{Job, Runs};
use settings::Ladder;

/// What is run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name and text of the case file.
    pub name: String,
    pub text: String,
    /// `--set` values for all levels.
    pub overrides: Vec<String>,
    pub levels: Levels,
    /// Realisations of each term at first; the last one holds for all further terms.
    pub pilot: Vec<u64>,
    pub target: Target,
    /// CPU time (s) for further realisations, towards the target.
    pub budget: f64,
    /// Measures; the target is one of the first.
    pub quantities: Vec<String>,
    pub max_memory: u64,
    /// Runs at a time; 0 is one a core.
    pub threads: usize,
    pub limits: Limits<'static>,
}

/// The error that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Target {
    /// eps: root of bias^2 + standard error^2, in the unit of the measure.
    pub error: f64,
    /// Part of eps^2 kept for the bias of the finest level, from 0 to below 1.
    pub bias_share: f64,
}

impl Target {
    /// What is left for all other errors, (1 - share) eps^2.
    pub fn variance(self) -> f64 {
        (1.0 - self.bias_share) * self.error * self.error
    }
}

/// What is asked for where nothing else is: r, its first block, volume and onset.
pub const QUANTITIES: [&str; 4] = [SLIDING_DISTANCE, "first_block_m", "slide_volume_m3_per_m", "onset_time_s"];

/// The study, as `multilevel.json` holds it.
#[derive(Clone, Debug, Serialize)]
pub struct Study {
    pub schema_version: u32,
    pub build: Build,
    pub case: String,
    pub overrides: Vec<String>,
    pub target: Target,
    pub settings: Vec<Setting>,
    /// Of each setting.
    pub costs: Vec<Cost>,
    /// C = a h^-gamma, in CPU time.
    pub gamma: Option<Rate>,
    /// The first is the one of the target.
    pub quantities: Vec<Quantity>,
    /// From the pilot alone, and from all runs.
    pub pilot: Forecast,
    pub forecast: Forecast,
    pub split: Split,
    /// P(Y > R) on the finest level, by multilevel and from its own runs alone.
    pub beyond: Vec<Beyond>,
    pub plain_beyond: Vec<Beyond>,
    /// The first as a picture may show it: falling, and biased for it.
    pub falling: Vec<f64>,
    /// CPU time of all runs (s), also of those that the estimates do not need.
    pub spent_cpu_s: f64,
    pub failed: usize,
    pub interrupted: bool,
    /// What the figures are worth, in plain words.
    pub remarks: Vec<String>,
}

/// Runs the study: pilot, then as many more realisations as target and budget allow. Rows go to `journal` as they
/// come. Gives the study and its rows in order.
///
/// # Errors
/// A setting that cannot be built; too few runs for any figure; writing.
pub fn multilevel(
    plan: &Plan,
    journal: &mut dyn Write,
    progress: &dyn Fn(usize, usize),
) -> Result<(Study, String), Problem> {
    let ladder = Ladder::new(&plan.name, &plan.text, &plan.overrides, &plan.levels).map_err(Problem::Refused)?;
    let terms = plan.levels.cells.len();
    let mut runs = Runs::new(&ladder, terms, plan.max_memory, plan.limits, plan.threads)?;
    check(plan, &ladder, &runs).map_err(Problem::Refused)?;
    runs.header(journal)?;
    let counts: Vec<u64> = (0..terms).filter_map(|t| plan.pilot.get(t).or(plan.pilot.last()).copied()).collect();
    let jobs = jobs(&ladder.settings, terms, &vec![0; terms], &counts, true);
    runs.extend(&jobs, journal, progress)?;
    let pilot = forecast(&runs, plan, terms).map_err(Problem::Refused)?;
    let more = within(&pilot.realisations, &counts, &costs(&runs, terms), plan.budget);
    let jobs = self::jobs(&ladder.settings, terms, &counts, &more, false);
    runs.extend(&jobs, journal, progress)?;
    let study = study(plan, &ladder, &runs, pilot).map_err(Problem::Refused)?;
    Ok((study, runs.csv()?))
}

/// Every measure is one of the case.
fn check(plan: &Plan, ladder: &Ladder, runs: &Runs<'_>) -> Result<(), String> {
    let names = runs.names();
    if let Some(name) = plan.quantities.iter().find(|name| !names.contains(&name.as_str())) {
        return Err(format!("`{name}` is no measure; there are: {}", names.join(", ")));
    }
    let crestless = ladder.cases.iter().all(|case| case.slide.is_none());
    match plan.quantities.iter().find(|name| crestless && needs_crest(name)) {
        Some(name) => Err(format!("`{name}` needs a crest: give the case a [slide], or choose a --quantity")),
        None => Ok(()),
    }
}

/// Runs of the samples from `from` to `to` of each term. All terms get on alike, so that an interrupt leaves
/// something of each; the dearest run of a sample comes first.
fn jobs(settings: &[Setting], terms: usize, from: &[u64], to: &[u64], variants: bool) -> Vec<Job> {
    let mut jobs: Vec<(f64, std::cmp::Reverse<usize>, Job)> = Vec::new();
    for (term, (from, to)) in from.iter().zip(to).enumerate() {
        for sample in *from..*to {
            let place = (sample - from) as f64 / (to - from) as f64;
            let own = settings.iter().enumerate().filter(|(k, setting)| {
                let base = *k < terms && (*k == term || *k + 1 == term);
                base || (variants && *k >= terms && setting.level == term)
            });
            jobs.extend(own.map(|(setting, s)| (place, std::cmp::Reverse(s.level), Job { term, sample, setting })));
        }
    }
    jobs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    jobs.into_iter().map(|(_, _, job)| job).collect()
}

fn costs(runs: &Runs<'_>, settings: usize) -> Vec<Cost> {
    (0..settings).map(|k| Cost::of(runs, k)).collect()
}

fn forecast(runs: &Runs<'_>, plan: &Plan, terms: usize) -> Result<Forecast, String> {
    let name = plan.quantities.first().ok_or("no measure is asked for")?;
    let (pairs, _) = estimate::pairs(runs, terms, name);
    let found = pairs.iter().map(|p| p.term()).collect::<Option<Vec<_>>>();
    let forecast = found.and_then(|t| Forecast::new(&t, &costs(runs, terms), plan.target));
    forecast.ok_or_else(|| {
        let counts: Vec<String> = pairs.iter().map(|p| p.fine.len().to_string()).collect();
        let counts = counts.join(", ");
        format!("`{name}` is known in {counts} realisations of the levels, and two of each are needed")
    })
}

/// How many realisations of each term the budget allows: those `wanted`, or the largest same share of them that the
/// time is enough for; never fewer than there are.
fn within(wanted: &[u64], have: &[u64], costs: &[Cost], budget: f64) -> Vec<u64> {
    let seconds = estimate::of_terms(costs, |c| c.cpu_s);
    let at = |share: f64| -> Vec<u64> {
        wanted.iter().zip(have).map(|(w, h)| ((share * *w as f64).floor() as u64).max(*h)).collect()
    };
    let cost = |n: &[u64]| -> f64 { n.iter().zip(have).zip(&seconds).map(|((n, h), c)| (n - h) as f64 * c).sum() };
    if cost(&at(1.0)) <= budget {
        return at(1.0);
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if cost(&at(middle)) <= budget { low = middle } else { high = middle }
    }
    at(low)
}

fn study(plan: &Plan, ladder: &Ladder, runs: &Runs<'_>, pilot: Forecast) -> Result<Study, String> {
    let cells = &plan.levels.cells;
    let costs = costs(runs, ladder.settings.len());
    let (levels, terms) = (costs.get(..cells.len()).unwrap_or_default(), cells.len());
    let quantity = |name: &String| estimate::quantity(runs, cells, levels, name);
    let quantities: Vec<Quantity> = plan.quantities.iter().filter_map(quantity).collect();
    let main = quantities.first().filter(|q| Some(&q.name) == plan.quantities.first());
    let main = main.ok_or("too few runs were finished for any figure")?;
    let (beyond, plain_beyond) = curves(runs, terms, &main.name);
    let mut study = Study {
        schema_version: SCHEMA_VERSION,
        build: Build::current(),
        case: plan.name.clone(),
        overrides: plan.overrides.clone(),
        target: plan.target,
        split: split::split(runs, &ladder.settings, &costs, main, plan.target),
        forecast: forecast(runs, plan, terms)?,
        gamma: estimate::gamma(cells, levels),
        falling: levels::falling(&beyond.iter().map(|b| b.share).collect::<Vec<_>>()),
        beyond,
        plain_beyond,
        spent_cpu_s: costs.iter().map(|c| c.runs as f64 * c.cpu_s).sum(),
        settings: ladder.settings.clone(),
        costs,
        pilot,
        failed: runs.failed(),
        interrupted: runs.interrupted(),
        remarks: Vec::new(),
        quantities,
    };
    study.remarks = remarks::remarks(&study);
    Ok(study)
}

/// P(Y > R) on a grid of R from the least to the largest result, by multilevel and from the finest runs.
fn curves(runs: &Runs<'_>, terms: usize, name: &str) -> (Vec<Beyond>, Vec<Beyond>) {
    const PLACES: usize = 60;
    let (pairs, _) = estimate::pairs(runs, terms, name);
    let all = pairs.iter().flat_map(|p| p.fine.iter().chain(p.coarse.iter().flatten()));
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
    let places: Vec<f64> = (0..=PLACES).map(|k| low + (high - low) * k as f64 / PLACES as f64).collect();
    let fine = pairs.last().map(|p| levels::Pairs { fine: p.fine.clone(), coarse: None }).unwrap_or_default();
    let of = |pairs: &[levels::Pairs]| places.iter().map(|r| levels::beyond(pairs, *r)).collect();
    (of(&pairs), of(&[fine]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cost(seconds: f64) -> Cost {
        Cost { runs: 1, particle_steps: 1.0, cpu_s: seconds, cpu_se: 0.0 }
    }

    #[test]
    fn a_budget_shares_out_what_is_wanted() {
        let costs = [cost(1.0), cost(4.0)];
        // a realisation of the second term takes both runs, 5 s
        assert_eq!(within(&[100, 20], &[10, 10], &costs, 140.0), [100, 20]);
        assert_eq!(within(&[100, 20], &[10, 10], &costs, 0.0), [10, 10]);
        let half = within(&[100, 20], &[10, 2], &costs, 80.0);
        assert_eq!(half, [50, 10]);
    }

    #[test]
    fn jobs_of_a_term_are_its_two_levels_and_its_variants() {
        let setting = |level: usize, step_factor: f64| Setting {
            label: String::new(),
            level,
            cell_m: 1.0,
            points_per_axis: 2,
            step_factor,
            overrides: Vec::new(),
        };
        let settings = [setting(0, 1.0), setting(1, 1.0), setting(0, 2.0), setting(1, 2.0)];
        let found = jobs(&settings, 2, &[0, 0], &[2, 1], true);
        let of = |term, sample| {
            let mut k: Vec<usize> =
                found.iter().filter(|j| (j.term, j.sample) == (term, sample)).map(|j| j.setting).collect();
            k.sort_unstable();
            k
        };
        assert_eq!((of(0, 0), of(0, 1), of(1, 0)), (vec![0, 2], vec![0, 2], vec![0, 1, 3]));
        let mut realisations: Vec<u64> = found.iter().map(|j| j.realisation(2)).collect();
        realisations.sort_unstable();
        realisations.dedup();
        assert_eq!(realisations, [0, 1, 2]);
        assert_eq!(jobs(&settings, 2, &[1, 0], &[2, 0], false).len(), 1);
    }
}
