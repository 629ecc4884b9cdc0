//! The runs of one setting, and what they took.

use std::{
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

use super::{Plan, SHORT, Skipped, price::Prices, setting::Setting};
use crate::{
    case::{self, Case},
    fault::Fault,
    math::stats::Summary,
    run::{self, Blind, Limits, Outcome, Status},
    scene,
    study::{clock, quantity::Quantity},
    work::Work,
};

/// Batches of a short run.
const BATCHES: usize = 3;
/// CPU time of a batch (s): the system counts the time of a thread in steps of some 4 ms.
const BATCH: f64 = 0.05;
/// Most runs of a batch.
const MOST: f64 = 64.0;

/// What the runs of a setting came to.
pub struct Measured {
    pub status: Status,
    pub fault: Option<String>,
    pub value: Option<f64>,
    pub runs: Option<Summary>,
    pub cpu_s: Option<f64>,
    pub repeats: usize,
    pub work: Work,
}

/// One run.
struct Run {
    outcome: Outcome,
    work: Work,
    cpu_s: f64,
}

/// Runs a setting, if its price is within what is left.
pub fn one(plan: &Plan, setting: &Setting, quantity: &Quantity, prices: &Mutex<Prices>) -> Result<Measured, Skipped> {
    let count = if quantity.is_statistical() { plan.runs.max(1) } else { 1 };
    // a worker that panicked ends the program; its budget is of no account
    let lock = || prices.lock().unwrap_or_else(PoisonError::into_inner);
    let (predicted, enough, left) = {
        let mut prices = lock();
        let predicted = prices.predict(setting, count);
        (predicted, prices.reserve(predicted), prices.left())
    };
    if !enough {
        return Err(Skipped::new(setting, "over what is left of the budget", Some(predicted)));
    }
    let (measured, total) = if quantity.is_statistical() {
        jittered(plan, setting, quantity, count, left)
    } else {
        timed(plan, setting, quantity, left)
    };
    let once = measured.as_ref().ok().and_then(|m| m.cpu_s).unwrap_or(0.0);
    lock().pay(setting, predicted, total, once);
    measured.map_err(|why| Skipped::new(setting, &why, None))
}

/// One run, again where it is short; with the CPU time of all.
fn timed(plan: &Plan, setting: &Setting, quantity: &Quantity, left: f64) -> (Result<Measured, String>, f64) {
    let began = Instant::now();
    let first = match run_once(plan, &setting.case, left) {
        Ok(run) => run,
        Err(why) => return (Err(why), 0.0),
    };
    let wall = began.elapsed().as_secs_f64();
    let (mut least, mut total, mut repeats) = (first.cpu_s, first.cpu_s, 1);
    if first.cpu_s < SHORT {
        let (batches, runs) = again(plan, &setting.case, left, wall);
        let of_all = batches.iter().copied().reduce(f64::min);
        (least, total, repeats) = (of_all.unwrap_or(least), total + batches.iter().sum::<f64>() * runs as f64, runs);
    }
    let measured = Measured {
        status: first.outcome.status,
        fault: fault(&first.outcome),
        value: sound(&first.outcome).then(|| quantity.value(&first.outcome)).flatten(),
        runs: None,
        cpu_s: Some(least),
        repeats,
        work: first.work,
    };
    (Ok(measured), total)
}

/// CPU time of a run (s) in each of some batches, and the runs of a batch; `wall` is about what one takes (s).
fn again(plan: &Plan, case: &Case, left: f64, wall: f64) -> (Vec<f64>, usize) {
    let runs = (BATCH / wall).ceil().clamp(1.0, MOST) as usize;
    let once = |_| if plan.limits.interrupted() { None } else { run_once(plan, case, left).ok().map(|run| run.cpu_s) };
    let batch = |_| (0..runs).map(once).sum::<Option<f64>>().map(|total| total / runs as f64);
    ((0..BATCHES).map_while(batch).collect(), runs)
}

/// Runs whose strengths differ by a hair; with the CPU time of all.
fn jittered(
    plan: &Plan,
    setting: &Setting,
    quantity: &Quantity,
    count: usize,
    left: f64,
) -> (Result<Measured, String>, f64) {
    let case = |k: usize| {
        let jitter = case::Jitter { strength: plan.jitter, realisation: k as u64 };
        Case { jitter, ..setting.case.clone() }
    };
    let runs: Result<Vec<Run>, String> = (0..count).map(|k| run_once(plan, &case(k), left)).collect();
    let runs = match runs {
        Ok(runs) => runs,
        Err(why) => return (Err(why), 0.0),
    };
    let total: f64 = runs.iter().map(|r| r.cpu_s).sum();
    let values: Vec<f64> =
        runs.iter().filter(|r| sound(&r.outcome)).filter_map(|r| quantity.value(&r.outcome)).collect();
    let summary = Summary::of(&values);
    // the run that tells most: one that failed, if any did
    let told = runs.iter().find(|r| !sound(&r.outcome)).or(runs.first());
    let measured = told.ok_or("no run".to_owned()).map(|run| Measured {
        status: run.outcome.status,
        fault: fault(&run.outcome),
        value: summary.map(|s| s.median),
        runs: summary,
        cpu_s: Some(total / count as f64),
        repeats: 1,
        work: run.work.clone(),
    });
    (measured, total)
}

fn run_once(plan: &Plan, case: &Case, left: f64) -> Result<Run, String> {
    let (began, cpu) = (Instant::now(), clock::thread_seconds());
    let mut scene = scene::build(case, plan.max_memory).map_err(|e| e.to_string())?;
    // a prediction may be wrong: what is left, in wall time of a machine that does other things as well
    let time_limit = Duration::try_from_secs_f64(5.0 * left + 10.0).ok();
    let limits = Limits { time_limit, ..plan.limits };
    let outcome = run::run(case, &mut scene, limits, &mut Blind).map_err(|e| e.to_string())?;
    let cpu_s = clock::thread_seconds().zip(cpu).map(|(after, before)| after - before);
    Ok(Run { outcome, work: scene.simulation.work.clone(), cpu_s: cpu_s.unwrap_or(began.elapsed().as_secs_f64()) })
}

/// Whether a run came to its end, so that its value counts.
fn sound(outcome: &Outcome) -> bool {
    matches!(outcome.status, Status::AtRest | Status::EndTime | Status::SlopeFailed)
}

fn fault(outcome: &Outcome) -> Option<String> {
    let told = outcome.fault.as_ref().map(Fault::to_string);
    told.or_else(|| (!sound(outcome)).then(|| outcome.message.clone()))
}
