//! `rmpm converge`: how an answer depends on mesh, points per cell, time step or any other key.
//!
//! A ladder refines one of these alone, from the case as it is. Each level is the median of runs whose strength is
//! jittered by a hair, since after failure a slope is chaotic and single runs cannot be compared; or the mean over
//! realisations of the random fields, the same at every level, so that differences are those of pairs; or one run.

mod axis;
mod judge;
mod ladder;
mod picture;
#[cfg(test)]
mod tests;
mod text;

use serde::Serialize;

use super::{quantity::Quantity, variant::Variant, workers};
use crate::{
    case::{self, Case},
    fault::Fault,
    math::stats::Summary,
    output::record::{Build, SCHEMA_VERSION},
    run::{self, Blind, Limits, Status},
    scene::{self, Scene},
    snapshot::Snapshot,
};

pub use axis::{Axis, Plan as LadderPlan, paper};
pub use judge::{Difference, Rate, Verdict};
pub use ladder::{Ladder, Level};
pub use picture::draw;
pub use text::table;

/// The runs of a level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Draws {
    /// One run as the case says.
    Single,
    /// Runs whose strengths differ by up to `jitter` of themselves.
    Jittered { runs: usize, jitter: f64 },
    /// Realisations 0, 1, ... of the random fields, the same at every level.
    Realisations { runs: usize },
}

impl Draws {
    /// Runs a level.
    pub fn runs(self) -> usize {
        match self {
            Draws::Single => 1,
            Draws::Jittered { runs, .. } | Draws::Realisations { runs } => runs,
        }
    }

    fn jitter(self) -> f64 {
        if let Draws::Jittered { jitter, .. } = self { jitter } else { 0.0 }
    }

    fn is_paired(self) -> bool {
        matches!(self, Draws::Realisations { .. })
    }

    fn overrides(self, k: u64) -> Vec<String> {
        match self {
            Draws::Single => Vec::new(),
            Draws::Jittered { jitter, .. } => {
                vec![format!("jitter.strength={jitter:?}"), format!("jitter.realisation={k}")]
            }
            Draws::Realisations { .. } => vec![format!("ensemble.realisation={k}")],
        }
    }
}

/// What is run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name and text of the case file.
    pub name: String,
    pub text: String,
    /// `--set` values for all variants.
    pub overrides: Vec<String>,
    /// Variants that are no ladder.
    pub variants: Vec<Variant>,
    pub ladders: Vec<LadderPlan>,
    /// The quantities by name; without one that of the case.
    pub quantities: Vec<String>,
    pub draws: Draws,
    pub max_memory: u64,
    /// Runs at a time; 0 is one a core.
    pub threads: usize,
    /// What may end the runs early; those that it ends are counted as cut short.
    pub limits: Limits<'static>,
}

/// One run.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    pub realisation: u64,
    pub status: Status,
    pub fault: Option<String>,
    /// The quantities of the study, in their order.
    pub values: Vec<Option<f64>>,
    pub sliding_distance_m: Option<f64>,
    pub blocks: Option<u64>,
    pub first_block_m: Option<f64>,
    pub censored: bool,
    pub runout_m: f64,
    pub slide_volume_m3_per_m: Option<f64>,
    pub rest_time_s: f64,
    pub numerical_energy_share: f64,
    pub particle_steps: u64,
    #[serde(skip)]
    pub snapshot: Option<Snapshot>,
}

/// One variant with its runs.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub variant: String,
    pub overrides: Vec<String>,
    pub cells: u64,
    pub points: u64,
    /// The quantities of the study, in their order.
    pub quantities: Vec<Option<Summary>>,
    pub sliding_distance_m: Option<Summary>,
    /// Change of the median of r against the first variant (m).
    pub median_change_m: Option<f64>,
    pub blocks: Option<Summary>,
    pub first_block_m: Option<Summary>,
    pub runout_m: Option<Summary>,
    pub rest_time_s: Option<Summary>,
    pub failed: usize,
    /// Ended from outside; they count in no figure.
    pub cut_short: usize,
    pub censored: usize,
    /// Ended by their time where the case asks for rest.
    pub not_at_rest: usize,
    pub runs: Vec<Run>,
    /// Whether it belongs to a ladder of time steps: its shapes are not drawn.
    #[serde(skip)]
    pub is_step: bool,
}

/// The study, as `converge.json` holds it.
#[derive(Clone, Debug, Serialize)]
pub struct Study {
    pub schema_version: u32,
    pub build: Build,
    pub case: String,
    pub overrides: Vec<String>,
    /// 0 where strengths are not jittered.
    pub jitter: f64,
    /// Runs a level.
    pub runs: usize,
    pub draws: Draws,
    pub quantities: Vec<Quantity>,
    pub rows: Vec<Row>,
    pub ladders: Vec<Ladder>,
    /// What the figures are worth, in plain words.
    pub remarks: Vec<String>,
}

/// A variant with its case, and the place in the list of variants of each level of each ladder.
struct Scheme {
    variants: Vec<(Variant, Case)>,
    ladders: Vec<(Axis, Vec<usize>)>,
}

/// Runs all variants, several at a time. `progress` is told how many of how many runs are done.
///
/// # Errors
/// An unknown quantity; realisations of a case without a random field; the first variant that cannot be read or
/// built, with its message.
pub fn converge(plan: &Plan, progress: &dyn Fn(usize, usize)) -> Result<Study, String> {
    let (case, _) = case::read(&plan.name, &plan.text, &plan.overrides).map_err(|e| e.render(false))?;
    if plan.draws.is_paired() && case.field.is_empty() {
        return Err("the case has no random field, so it has no realisations; give it a [field.NAME]".to_owned());
    }
    let quantities = quantities(plan, &case)?;
    let scheme = scheme(plan)?;
    let count = plan.draws.runs();
    let jobs: Vec<(usize, u64)> =
        (0..scheme.variants.len()).flat_map(|v| (0..count as u64).map(move |k| (v, k))).collect();
    let work = |&(v, k): &(usize, u64)| one(plan, &scheme.variants[v].0, &quantities, k);
    let mut runs = workers::all(plan.threads, &jobs, progress, &work)?.into_iter();
    let mut rows: Vec<Row> =
        scheme.variants.iter().map(|v| row(v, quantities.len(), runs.by_ref().take(count).collect())).collect();
    note_changes(&mut rows);
    mark_steps(&mut rows, &scheme);
    let ladders = ladder::all(plan.draws, &case, &quantities, &scheme, &rows);
    Ok(Study {
        schema_version: SCHEMA_VERSION,
        build: Build::current(),
        case: plan.name.clone(),
        overrides: plan.overrides.clone(),
        jitter: plan.draws.jitter(),
        runs: count,
        draws: plan.draws,
        remarks: text::remarks(plan.draws, &case, &rows),
        quantities,
        rows,
        ladders,
    })
}

fn quantities(plan: &Plan, case: &Case) -> Result<Vec<Quantity>, String> {
    if plan.quantities.is_empty() {
        return Ok(vec![Quantity::of(case)]);
    }
    plan.quantities.iter().map(|word| Quantity::named(word, case)).collect()
}

/// All variants, those with one case once; the levels of ladders from the coarsest.
fn scheme(plan: &Plan) -> Result<Scheme, String> {
    let mut scheme = Scheme { variants: Vec::new(), ladders: Vec::new() };
    for variant in &plan.variants {
        scheme.place(plan, variant)?;
    }
    for ladder in &plan.ladders {
        let mut levels =
            ladder.levels.iter().map(|level| scheme.place(plan, level)).collect::<Result<Vec<usize>, String>>()?;
        let size = |k: &usize| ladder.axis.size(&scheme.variants[*k].1);
        levels.sort_by(|a, b| size(b).total_cmp(&size(a)));
        levels.dedup();
        if levels.len() < 2 {
            return Err(format!("a ladder by {} needs two different values", ladder.axis.words()));
        }
        scheme.ladders.push((ladder.axis, levels));
    }
    Ok(scheme)
}

impl Scheme {
    /// The place of a variant, which is built once so that what is wrong is told before anything runs.
    fn place(&mut self, plan: &Plan, variant: &Variant) -> Result<usize, String> {
        let (case, _) = prepare(plan, variant, &[])?;
        let known = self.variants.iter().position(|(_, known)| *known == case);
        Ok(known.unwrap_or_else(|| {
            self.variants.push((variant.clone(), case));
            self.variants.len() - 1
        }))
    }
}

/// The case of a variant with the keys of a run, and its scene.
fn prepare(plan: &Plan, variant: &Variant, run: &[String]) -> Result<(Case, Scene), String> {
    let overrides: Vec<String> = plan.overrides.iter().chain(&variant.overrides).chain(run).cloned().collect();
    let (case, _) = case::read(&plan.name, &plan.text, &overrides).map_err(|e| e.render(false))?;
    let scene = scene::build(&case, plan.max_memory).map_err(|e| format!("{}: {e}", variant.label))?;
    Ok((case, scene))
}

/// One run with the cells that hold soil and its points.
struct Ran {
    cells: u64,
    points: u64,
    run: Run,
}

fn one(plan: &Plan, variant: &Variant, quantities: &[Quantity], realisation: u64) -> Result<Ran, String> {
    let (case, mut scene) = prepare(plan, variant, &plan.draws.overrides(realisation))?;
    let outcome = run::run(&case, &mut scene, plan.limits, &mut Blind).map_err(|e| e.to_string())?;
    let m = &outcome.measures;
    let e = &m.energy_kj_per_m;
    let run = Run {
        realisation,
        status: outcome.status,
        fault: outcome.fault.as_ref().map(Fault::to_string),
        values: quantities.iter().map(|q| q.value(&outcome)).collect(),
        sliding_distance_m: m.sliding_distance_m,
        blocks: m.blocks,
        first_block_m: m.plateaus.first().map(|p| p.sliding_distance_m),
        censored: m.sliding_distance_censored,
        runout_m: m.runout_m,
        slide_volume_m3_per_m: m.slide_volume_m3_per_m,
        rest_time_s: outcome.time,
        numerical_energy_share: e.numerical / e.external.abs().max(f64::MIN_POSITIVE),
        particle_steps: scene.simulation.work.particle_steps,
        // of many realisations the first alone is drawn, and kept
        snapshot: (!plan.draws.is_paired() || realisation == 0).then(|| scene.simulation.snapshot()),
    };
    let points = scene.simulation.body.len() as u64;
    Ok(Ran { cells: scene.cells, points, run })
}

fn row((variant, case): &(Variant, Case), quantities: usize, ran: Vec<Ran>) -> Row {
    let (cells, points) = ran.first().map_or((0, 0), |r| (r.cells, r.points));
    let runs: Vec<Run> = ran.into_iter().map(|r| r.run).collect();
    let sound: Vec<&Run> = runs.iter().filter(|r| r.status.is_sound()).collect();
    let cut_short = runs.iter().filter(|r| r.status.is_cut_short()).count();
    let summary =
        |pick: &dyn Fn(&Run) -> Option<f64>| Summary::of(&sound.iter().filter_map(|r| pick(r)).collect::<Vec<_>>());
    Row {
        variant: variant.label.clone(),
        overrides: variant.overrides.clone(),
        cells,
        points,
        quantities: (0..quantities).map(|q| summary(&|r| r.values.get(q).copied().flatten())).collect(),
        sliding_distance_m: summary(&|r| r.sliding_distance_m),
        median_change_m: None,
        blocks: summary(&|r| r.blocks.map(|b| b as f64)),
        first_block_m: summary(&|r| r.first_block_m),
        runout_m: summary(&|r| Some(r.runout_m)),
        rest_time_s: summary(&|r| Some(r.rest_time_s)),
        failed: runs.len() - sound.len() - cut_short,
        cut_short,
        censored: runs.iter().filter(|r| r.censored).count(),
        not_at_rest: sound.iter().filter(|r| case.end.at_rest && r.status == Status::EndTime).count(),
        runs,
        is_step: false,
    }
}

/// Rows of ladders of time steps that stand in no other.
fn mark_steps(rows: &mut [Row], scheme: &Scheme) {
    let in_ladder =
        |k: usize, is: fn(Axis) -> bool| scheme.ladders.iter().any(|(axis, levels)| is(*axis) && levels.contains(&k));
    for (k, row) in rows.iter_mut().enumerate() {
        row.is_step = in_ladder(k, |axis| axis == Axis::TimeStep) && !in_ladder(k, |axis| axis != Axis::TimeStep);
    }
}

fn note_changes(rows: &mut [Row]) {
    let Some(first) = rows.first().and_then(|r| r.sliding_distance_m) else { return };
    for row in rows.iter_mut() {
        row.median_change_m = row.sliding_distance_m.map(|s| s.median - first.median);
    }
}

/// The run of a row whose first quantity is nearest to the median, of those that can be drawn.
fn typical(row: &Row) -> Option<&Run> {
    let median = row.quantities.first().copied().flatten().map_or(0.0, |s| s.median);
    let gap = |r: &Run| (r.values.first().copied().flatten().unwrap_or(0.0) - median).abs();
    let sound = row.runs.iter().filter(|r| r.status.is_sound() && r.snapshot.is_some());
    sound.min_by(|a, b| gap(a).total_cmp(&gap(b)))
}
