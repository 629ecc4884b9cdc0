//! `rmpm converge`: how an answer depends on mesh, points per cell or any other key, each variant
//! as the median and spread of runs whose strength is jittered by a hair. After failure a slope
//! is chaotic, so single runs cannot be compared.

use serde::Serialize;

use super::{variant::Variant, workers};
use crate::{
    case::{self, Case},
    fault::Fault,
    math::stats::Summary,
    output::record::{Build, SCHEMA_VERSION},
    run::{self, Blind, Limits, Status},
    scene::{self, Scene},
    snapshot::Snapshot,
};

/// What is run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name and text of the case file.
    pub name: String,
    pub text: String,
    /// `--set` values for all variants.
    pub overrides: Vec<String>,
    pub variants: Vec<Variant>,
    /// Jittered runs a variant.
    pub runs: usize,
    /// Largest relative change of strength.
    pub jitter: f64,
    pub max_memory: u64,
    /// Runs at a time; 0 is one a core.
    pub threads: usize,
    /// What may end the runs early; those that it ends are counted as not at rest.
    pub limits: Limits<'static>,
}

/// One run.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    pub realisation: u64,
    pub status: Status,
    pub fault: Option<String>,
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
    pub sliding_distance_m: Option<Summary>,
    /// Change of the median of r against the first variant (m).
    pub median_change_m: Option<f64>,
    pub blocks: Option<Summary>,
    pub first_block_m: Option<Summary>,
    pub runout_m: Option<Summary>,
    pub rest_time_s: Option<Summary>,
    pub failed: usize,
    pub censored: usize,
    pub not_at_rest: usize,
    pub runs: Vec<Run>,
}

/// The study, as `converge.json` holds it.
#[derive(Clone, Debug, Serialize)]
pub struct Study {
    pub schema_version: u32,
    pub build: Build,
    pub case: String,
    pub overrides: Vec<String>,
    pub jitter: f64,
    pub runs: usize,
    pub rows: Vec<Row>,
    /// What the figures are worth, in plain words.
    pub remarks: Vec<String>,
}

/// Meshes and points per cell for a case without wishes: the cell as it is and 20/29 of it (0.25
/// and 5/29 m for the paper's slope), and twice the points on each axis (16 for 4 per cell).
pub fn usual_variants(cell: f64, per_axis: usize) -> Vec<Variant> {
    let label = |h: f64, n: usize| format!("h = {h:.4} m, {0} points", n * n);
    let refined = cell * 20.0 / 29.0;
    vec![
        Variant { label: label(cell, per_axis), overrides: Vec::new() },
        Variant { label: label(refined, per_axis), overrides: vec![format!("grid.cell={refined}")] },
        Variant { label: label(cell, 2 * per_axis), overrides: vec![format!("points.per_axis={}", 2 * per_axis)] },
    ]
}

/// Runs all variants, several at a time. `progress` is told how many of how many runs are done.
///
/// # Errors
/// The first variant that cannot be read or built, with its message.
pub fn converge(plan: &Plan, progress: &dyn Fn(usize, usize)) -> Result<Study, String> {
    plan.variants.iter().try_for_each(|v| prepare(plan, v, 0).map(drop))?;
    let jobs: Vec<(usize, u64)> =
        (0..plan.variants.len()).flat_map(|v| (0..plan.runs as u64).map(move |k| (v, k))).collect();
    let results = workers::all(plan.threads, &jobs, progress, &|&(v, k)| one(plan, &plan.variants[v], k))?;
    let mut runs = results.into_iter();
    let mut rows: Vec<Row> = plan.variants.iter().map(|v| row(v, runs.by_ref().take(plan.runs).collect())).collect();
    note_changes(&mut rows);
    Ok(Study {
        schema_version: SCHEMA_VERSION,
        build: Build::current(),
        case: plan.name.clone(),
        overrides: plan.overrides.clone(),
        jitter: plan.jitter,
        runs: plan.runs,
        remarks: remarks(&rows),
        rows,
    })
}

/// The case of one run of a variant, and its scene.
fn prepare(plan: &Plan, variant: &Variant, realisation: u64) -> Result<(Case, Scene), String> {
    let mut overrides = plan.overrides.clone();
    overrides.extend(variant.overrides.iter().cloned());
    overrides.push(format!("jitter.strength={:?}", plan.jitter));
    overrides.push(format!("jitter.realisation={realisation}"));
    let (case, _) = case::read(&plan.name, &plan.text, &overrides).map_err(|e| e.render(false))?;
    let scene = scene::build(&case, plan.max_memory).map_err(|e| format!("{}: {e}", variant.label))?;
    Ok((case, scene))
}

/// One run of a variant; the cells that hold soil come with it.
fn one(plan: &Plan, variant: &Variant, realisation: u64) -> Result<(u64, Run), String> {
    let (case, mut scene) = prepare(plan, variant, realisation)?;
    let outcome = run::run(&case, &mut scene, plan.limits, &mut Blind).map_err(|e| e.to_string())?;
    let m = &outcome.measures;
    let e = &m.energy_kj_per_m;
    let run = Run {
        realisation,
        status: outcome.status,
        fault: outcome.fault.as_ref().map(Fault::to_string),
        sliding_distance_m: m.sliding_distance_m,
        blocks: m.blocks,
        first_block_m: m.plateaus.first().map(|p| p.sliding_distance_m),
        censored: m.sliding_distance_censored,
        runout_m: m.runout_m,
        slide_volume_m3_per_m: m.slide_volume_m3_per_m,
        rest_time_s: outcome.time,
        numerical_energy_share: e.numerical / e.external.abs().max(f64::MIN_POSITIVE),
        particle_steps: scene.simulation.work.particle_steps,
        snapshot: Some(scene.simulation.snapshot()),
    };
    Ok((scene.cells, run))
}

fn row(variant: &Variant, runs: Vec<(u64, Run)>) -> Row {
    let cells = runs.first().map_or(0, |(cells, _)| *cells);
    let runs: Vec<Run> = runs.into_iter().map(|(_, run)| run).collect();
    let sound: Vec<&Run> = runs.iter().filter(|r| r.fault.is_none()).collect();
    let summary =
        |pick: fn(&Run) -> Option<f64>| Summary::of(&sound.iter().filter_map(|r| pick(r)).collect::<Vec<_>>());
    Row {
        variant: variant.label.clone(),
        overrides: variant.overrides.clone(),
        cells,
        points: runs.first().and_then(|r| r.snapshot.as_ref()).map_or(0, |s| s.len() as u64),
        sliding_distance_m: summary(|r| r.sliding_distance_m),
        median_change_m: None,
        blocks: summary(|r| r.blocks.map(|b| b as f64)),
        first_block_m: summary(|r| r.first_block_m),
        runout_m: summary(|r| Some(r.runout_m)),
        rest_time_s: summary(|r| Some(r.rest_time_s)),
        failed: runs.len() - sound.len(),
        censored: runs.iter().filter(|r| r.censored).count(),
        not_at_rest: runs.iter().filter(|r| matches!(r.status, Status::EndTime | Status::Interrupted)).count(),
        runs,
    }
}

fn note_changes(rows: &mut [Row]) {
    let Some(first) = rows.first().and_then(|r| r.sliding_distance_m) else { return };
    for row in rows.iter_mut() {
        row.median_change_m = row.sliding_distance_m.map(|s| s.median - first.median);
    }
}

/// What a reader must know before using the table.
fn remarks(rows: &[Row]) -> Vec<String> {
    let mut text = vec![
        "Spread is over jittered strengths only: it is the chance part of one run, not the effect of soil variability."
            .to_owned(),
    ];
    let sd = rows.iter().filter_map(|r| r.sliding_distance_m).map(|s| s.sd).fold(0.0, f64::max);
    let change = rows.iter().filter_map(|r| r.median_change_m).map(f64::abs).fold(0.0, f64::max);
    if change > sd.max(0.5) {
        text.push(format!(
            "Medians differ by up to {change:.1} m, more than the spread of the runs ({sd:.1} m): the variants do not give the same answer. Linear softening has no length scale, so refining is not expected to converge."
        ));
    }
    let failed: usize = rows.iter().map(|r| r.failed).sum();
    if failed > 0 {
        text.push(format!("{failed} runs failed and are left out of the statistics; converge.json holds the faults."));
    }
    text
}

/// The run of a row whose r is nearest to the median.
pub fn typical(row: &Row) -> Option<&Run> {
    let median = row.sliding_distance_m.map_or(0.0, |s| s.median);
    let gap = |r: &Run| (r.sliding_distance_m.unwrap_or(0.0) - median).abs();
    row.runs.iter().filter(|r| r.fault.is_none()).min_by(|a, b| gap(a).total_cmp(&gap(b)))
}

/// The table for people.
pub fn table(study: &Study) -> String {
    let mut text = format!(
        "{:<28} {:>6} {:>7} {:>5} {:>9} {:>15} {:>15} {:>14} {:>7} {:>11} {:>8}\n",
        "variant",
        "cells",
        "points",
        "runs",
        if study.rows.iter().any(|r| r.sliding_distance_m.is_some()) { "median r" } else { "run-out" },
        "quartiles",
        "min to max",
        "mean +- se",
        "blocks",
        "first block",
        "rest (s)"
    );
    study.rows.iter().for_each(|row| text += &line(row));
    for remark in &study.remarks {
        text += &format!("note: {remark}\n");
    }
    text
}

fn line(row: &Row) -> String {
    let median = |s: &Option<Summary>| s.map_or("-".to_owned(), |s| format!("{:.2}", s.median));
    let r = row.sliding_distance_m.or(row.runout_m);
    let of = |f: &dyn Fn(Summary) -> String| r.map_or("-".to_owned(), f);
    let flags = [(row.failed, "failed"), (row.censored, "censored"), (row.not_at_rest, "not at rest")];
    let flags: Vec<String> = flags.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
    format!(
        "{:<28} {:>6} {:>7} {:>5} {:>9} {:>15} {:>15} {:>14} {:>7} {:>11} {:>8} {}\n",
        row.variant,
        row.cells,
        row.points,
        row.runs.len(),
        of(&|s| format!("{:.2}", s.median)),
        of(&|s| format!("{:.2} to {:.2}", s.lower_quartile, s.upper_quartile)),
        of(&|s| format!("{:.2} to {:.2}", s.min, s.max)),
        of(&|s| format!("{:.2} +- {:.2}", s.mean, s.standard_error)),
        median(&row.blocks),
        median(&row.first_block_m),
        median(&row.rest_time_s),
        flags.join(", "),
    )
}
