//! `rmpm compare schemes`: the explicit and the implicit scheme on one case, with the same schedule
//! and the same strength measure, each as the median of jittered runs.

mod figures;
pub mod onset;
pub mod picture;
mod row;
mod single;
mod table;
mod variants;
mod verdict;

pub use row::Row;
pub use single::Run;
pub use table::{csv, table};
pub use variants::{Entry, Group};

use serde::Serialize;

use super::workers;
use crate::{
    case::{self, Case},
    output::record::{Build, SCHEMA_VERSION},
    run::{Limits, Status},
    scene::{self, Scene},
};

/// What is run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name and text of the case file.
    pub name: String,
    pub text: String,
    /// `--set` values for all variants.
    pub overrides: Vec<String>,
    /// Jittered runs of each scheme, and of each other variant (0: none of these).
    pub runs: usize,
    pub sweep: usize,
    /// Implicit steps (s); the first is compared with the explicit scheme.
    pub steps: Vec<f64>,
    /// Largest relative change of strength.
    pub jitter: f64,
    pub max_memory: u64,
    /// Runs at a time; 0 is one a core.
    pub threads: usize,
    /// What may end the runs early.
    pub limits: Limits<'static>,
}

/// The study, as `compare.json` holds it. CPU times, and what is concluded from them, depend on the
/// machine.
#[derive(Clone, Debug, Serialize)]
pub struct Study {
    pub schema_version: u32,
    pub build: Build,
    pub case: String,
    pub overrides: Vec<String>,
    pub jitter: f64,
    pub cell_m: f64,
    pub rows: Vec<Row>,
    /// What the figures say, in plain words.
    pub conclusions: Vec<String>,
}

/// Runs everything, several runs at a time. `progress` is told how many of how many are done.
///
/// # Errors
/// The first variant that cannot be read or built, with its message.
pub fn compare(plan: &Plan, case: &Case, progress: &dyn Fn(usize, usize)) -> Result<Study, String> {
    let entries = variants::entries(case, &plan.steps, plan.runs, plan.sweep);
    entries.iter().try_for_each(|e| prepare(plan, &e.overrides, 0).map(drop).map_err(|t| told(e, &t)))?;
    let full = onset::crest_weight(case);
    // by realisation, so that the schemes share the moods of the machine
    let most = entries.iter().map(|e| e.count).max().unwrap_or(0);
    let jobs: Vec<(u64, &Entry)> =
        (0..most).flat_map(|k| entries.iter().filter(move |e| k < e.count).map(move |e| (k as u64, e))).collect();
    let results = workers::all(plan.threads, &jobs, progress, &|&(k, entry)| {
        let run = one(plan, entry, full, k).map_err(|e| told(entry, &e))?;
        // a run that was cut short says nothing
        Ok(Some(run).filter(|r| r.status != Status::Interrupted))
    })?;
    let mut pool: Vec<(&Entry, Run)> = jobs.iter().zip(results).filter_map(|((_, e), r)| Some((*e, r?))).collect();
    let rows = entries.iter().map(|e| Row::new(e.clone(), taken(&mut pool, e))).collect();
    Ok(study(plan, case, rows))
}

fn told(entry: &Entry, text: &str) -> String {
    format!("{}: {text}", entry.variant)
}

/// The runs of an entry, in order.
fn taken<'a>(pool: &mut Vec<(&'a Entry, Run)>, entry: &'a Entry) -> Vec<Run> {
    let all = std::mem::take(pool);
    let (own, rest): (Vec<_>, Vec<_>) = all.into_iter().partition(|(e, _)| std::ptr::eq(*e, entry));
    *pool = rest;
    own.into_iter().map(|(_, run)| run).collect()
}

fn study(plan: &Plan, case: &Case, rows: Vec<Row>) -> Study {
    let mut study = Study {
        schema_version: SCHEMA_VERSION,
        build: Build::current(),
        case: plan.name.clone(),
        overrides: plan.overrides.clone(),
        jitter: plan.jitter,
        cell_m: case.grid.cell,
        rows,
        conclusions: Vec::new(),
    };
    study.conclusions = verdict::conclusions(&study);
    if variants::needs_inertia(case) {
        let text = "The soil starts in motion: the implicit runs have inertia from the start (newmark).";
        study.conclusions.insert(0, text.to_owned());
    }
    study
}

/// A case with overrides, and its scene.
fn prepare(plan: &Plan, further: &[String], realisation: u64) -> Result<(Case, Scene), String> {
    let mut overrides = plan.overrides.clone();
    overrides.extend(further.iter().cloned());
    overrides.push(format!("jitter.strength={:?}", plan.jitter));
    overrides.push(format!("jitter.realisation={realisation}"));
    let (case, _) = case::read(&plan.name, &plan.text, &overrides).map_err(|e| e.render(false))?;
    let scene = scene::build(&case, plan.max_memory).map_err(|e| e.to_string())?;
    Ok((case, scene))
}

/// One run of a variant to its end, and one to its onset.
fn one(plan: &Plan, entry: &Entry, full: Option<f64>, realisation: u64) -> Result<Run, String> {
    let (case, mut scene) = prepare(plan, &entry.overrides, realisation)?;
    let mut run = single::to_the_end(&case, &mut scene, realisation, plan.limits)?;
    drop(scene);
    if let Some(full) = full.filter(|_| entry.onset) {
        let case = onset::raised(&case, full);
        let mut scene = scene::build(&case, plan.max_memory).map_err(|e| e.to_string())?;
        let found = onset::find(&case, &mut scene, full, plan.limits);
        run.onset = (!plan.limits.interrupted()).then_some(found);
    }
    Ok(run)
}
