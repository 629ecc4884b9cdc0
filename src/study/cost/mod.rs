//! `rmpm cost`: what accuracy costs in time, for any case.
//!
//! A case is run with many settings of the numerics; each run has an error in one quantity and a cost. What is on the
//! front of the two, and the cheapest setting for an error of 10 %, 1 % and 0.1 %, is the answer.
//!
//! Costs are CPU seconds of the thread that runs, scene and steps, without output. They are those of one machine in
//! one hour: other programs share its caches, so a run shorter than [`SHORT`] is repeated in batches and
//! the batch of the least time counts.
//! Counters of work stand beside them, which are exact and the same everywhere.

mod answer;
mod front;
mod picture;
mod price;
mod reference;
mod runs;
mod setting;
mod table;
#[cfg(test)]
mod tests;

use std::{ops::ControlFlow, sync::Mutex};

use serde::Serialize;

use super::{quantity::Quantity, workers};
use crate::{
    case::{self, Case, Scheme, ShapeFunctions},
    math::stats::Summary,
    output::record::{Build, SCHEMA_VERSION},
    run::{Limits, Status},
    work::Work,
};
use price::Prices;
use runs::Measured;
use setting::Setting;

pub use answer::{Answer, Pick};
pub use picture::draw;
pub use reference::{Basis, Ladder, Reference};
pub use setting::Axis;
pub use table::{csv, table};

/// A run that takes less CPU time (s) is repeated.
pub const SHORT: f64 = 0.2;

/// What is run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name and text of the case file.
    pub name: String,
    pub text: String,
    /// `--set` values for all settings; scheme and shape, where they are among these, are not varied.
    pub overrides: Vec<String>,
    /// Axes that replace the usual ones of their key, or stand beside them; those of one key are one.
    pub vary: Vec<Axis>,
    /// Meshes of the usual ladder: h, h/2, h/4, ...
    pub levels: u32,
    /// The quantity by name; without one that of the case.
    pub quantity: Option<String>,
    /// Jittered runs a setting where the quantity is statistical, and the largest relative change of strength.
    pub runs: usize,
    pub jitter: f64,
    /// CPU seconds for all runs; what is predicted to exceed what is left is skipped.
    pub budget_s: f64,
    pub max_memory: u64,
    /// Runs at a time; 0 is one a core.
    pub threads: usize,
    pub limits: Limits<'static>,
}

/// One setting that was run.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub setting: String,
    pub overrides: Vec<String>,
    pub scheme: Scheme,
    pub shape: ShapeFunctions,
    pub cell_m: f64,
    pub points_per_axis: usize,
    pub status: Status,
    pub fault: Option<String>,
    /// The quantity; the median of the runs where it is statistical.
    pub value: Option<f64>,
    /// The jittered runs, where the quantity is statistical.
    pub runs: Option<Summary>,
    /// |value - reference| over |reference|.
    pub error: Option<f64>,
    /// Whether errors are measured against this run.
    pub is_reference: bool,
    /// CPU time of one run (s): the least of the repeats, the mean of jittered runs.
    pub cpu_s: Option<f64>,
    /// Runs of a batch; a run that takes long enough is timed once.
    pub repeats: usize,
    /// Whether no other setting is better in error and CPU time both.
    pub on_front: bool,
    /// The same with the blocks sent through the law in place of the time.
    pub on_work_front: bool,
    /// Counters of one run.
    pub work: Work,
    /// Which scheme and shape.
    #[serde(skip)]
    pub family: String,
    #[serde(skip)]
    at: Option<Setting>,
}

impl Row {
    /// Whether this is another setting with one key made finer.
    fn refines(&self, other: &Row) -> bool {
        self.at.as_ref().zip(other.at.as_ref()).is_some_and(|(a, b)| a.refines(b))
    }
}

/// A setting that was not run.
#[derive(Clone, Debug, Serialize)]
pub struct Skipped {
    pub setting: String,
    pub why: String,
    /// CPU time that was expected (s); none for a setting that the case does not allow.
    pub predicted_s: Option<f64>,
}

/// The study, as `cost.json` holds it.
#[derive(Clone, Debug, Serialize)]
pub struct Study {
    pub schema_version: u32,
    pub build: Build,
    pub case: String,
    pub title: String,
    pub overrides: Vec<String>,
    pub quantity: Quantity,
    /// Whether the error is one of chance as well as of the method.
    pub statistical: bool,
    pub reference: Option<Reference>,
    pub rows: Vec<Row>,
    pub skipped: Vec<Skipped>,
    pub ladders: Vec<Ladder>,
    pub answers: Vec<Answer>,
    /// What the figures are worth, in plain words.
    pub remarks: Vec<String>,
}

impl Study {
    /// Whether errors are shares of the reference; where that is 0 they are differences, in the unit of the quantity.
    pub fn is_relative(&self) -> bool {
        self.reference.as_ref().is_none_or(Reference::is_relative)
    }
}

/// Runs the settings, the cheap ones first. `progress` is told how many of how many are done.
///
/// # Errors
/// A case that cannot be read, an unknown quantity, a jitter out of its range, an axis that the case does not allow or
/// does not use, a case that allows no setting.
pub fn cost(plan: &Plan, progress: &dyn Fn(usize, usize)) -> Result<Study, String> {
    let (case, _) = case::read(&plan.name, &plan.text, &plan.overrides).map_err(|e| e.render(false))?;
    let quantity = plan.quantity.as_ref().map_or(Ok(Quantity::of(&case)), |word| Quantity::named(word, &case))?;
    setting::allowed(plan, format!("jitter.strength={:?}", plan.jitter))?;
    let (settings, refused) = setting::settings(plan, &case)?;
    let results = run_all(plan, &settings, &quantity, progress)?;
    let mut study = Study {
        schema_version: SCHEMA_VERSION,
        build: Build::current(),
        case: plan.name.clone(),
        title: case.title.clone(),
        overrides: plan.overrides.clone(),
        statistical: quantity.is_statistical(),
        quantity,
        reference: None,
        rows: Vec::new(),
        skipped: refused.into_iter().map(|r| Skipped { setting: r.label, why: r.why, predicted_s: None }).collect(),
        ladders: Vec::new(),
        answers: Vec::new(),
        remarks: Vec::new(),
    };
    for (setting, result) in settings.into_iter().zip(results) {
        match result {
            Ok(measured) => study.rows.push(row(setting, measured)),
            Err(skipped) => study.skipped.push(skipped),
        }
    }
    judge(&mut study, plan, &case);
    Ok(study)
}

/// One result a setting, in their order, whatever the threads.
fn run_all(
    plan: &Plan,
    settings: &[Setting],
    quantity: &Quantity,
    progress: &dyn Fn(usize, usize),
) -> Result<Vec<Result<Measured, Skipped>>, String> {
    let mut order: Vec<usize> = (0..settings.len()).collect();
    order.sort_by(|&a, &b| price::guess(&settings[a].case).total_cmp(&price::guess(&settings[b].case)));
    let prices = Mutex::new(Prices::new(plan.budget_s));
    let mut results: Vec<Option<Result<Measured, Skipped>>> = settings.iter().map(|_| None).collect();
    let mut done = 0;
    let work = |_: usize, k: &usize| runs::one(plan, &settings[*k], quantity, &prices);
    let stop = || plan.limits.interrupted();
    workers::hand_out(plan.threads, &order, &stop, &work, &mut |k, result| {
        results[order[k]] = Some(result);
        done += 1;
        progress(done, settings.len());
        ControlFlow::Continue(())
    })
    .map_err(|e| e.to_string())?;
    let left = |setting: &Setting| Err(Skipped::new(setting, "interrupted before its turn", None));
    Ok(results.into_iter().zip(settings).map(|(result, setting)| result.unwrap_or_else(|| left(setting))).collect())
}

impl Skipped {
    fn new(setting: &Setting, why: &str, predicted_s: Option<f64>) -> Self {
        Skipped { setting: setting.label(), why: why.to_owned(), predicted_s }
    }
}

fn row(setting: Setting, m: Measured) -> Row {
    Row {
        setting: setting.label(),
        overrides: setting.overrides(),
        scheme: setting.case.solver.scheme,
        shape: setting.case.solver.shape,
        cell_m: setting.case.grid.cell,
        points_per_axis: setting.case.points.per_axis,
        status: m.status,
        fault: m.fault,
        value: m.value,
        runs: m.runs,
        error: None,
        is_reference: false,
        cpu_s: m.cpu_s,
        repeats: m.repeats,
        on_front: false,
        on_work_front: false,
        work: m.work,
        family: setting.family(),
        at: Some(setting),
    }
}

/// Errors, fronts and answers from the values.
fn judge(study: &mut Study, plan: &Plan, case: &Case) {
    let points: Vec<reference::Point<'_>> = study.rows.iter().filter_map(point).collect();
    // what jumps by columns of points has no rate
    let ladders = if study.statistical { Vec::new() } else { reference::ladders(&points) };
    study.reference = reference::reference(study.quantity.exact(case), &ladders, &points);
    study.ladders = ladders;
    if let Some(reference) = &study.reference {
        for row in &mut study.rows {
            row.error = row.value.map(|value| reference.error(value));
            row.is_reference = reference.setting.as_ref() == Some(&row.setting);
        }
    }
    mark_fronts(&mut study.rows);
    let floor = study.reference.as_ref().and_then(Reference::floor);
    // a target is a share of the reference
    if study.is_relative() {
        study.answers = answer::answers(&study.rows, study.quantity.name(), floor);
    }
    study.remarks = table::remarks(study, plan);
}

fn point(row: &Row) -> Option<reference::Point<'_>> {
    Some(reference::Point { setting: row.at.as_ref()?, value: row.value?, steps: row.work.steps })
}

fn mark_fronts(rows: &mut [Row]) {
    let points = |cost: fn(&Row) -> f64| -> Vec<(f64, f64)> {
        let error = |r: &Row| r.error.filter(|_| !r.is_reference).unwrap_or(f64::NAN);
        rows.iter().map(|r| (cost(r), error(r))).collect()
    };
    let cpu = front::front(&points(|r| r.cpu_s.unwrap_or(f64::NAN)));
    let work = front::front(&points(|r| r.work.law_blocks as f64));
    cpu.into_iter().for_each(|k| rows[k].on_front = true);
    work.into_iter().for_each(|k| rows[k].on_work_front = true);
}
