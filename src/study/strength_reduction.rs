//! The factor of safety by strength reduction: whole runs of a case with divided strengths, until the factor that
//! the slope just bears lies between two that are close together.

use serde::Serialize;

use crate::{
    case::{Case, Regime, Scheme, StrengthReduction},
    run::{self, Blind, Limits, Outcome, Status},
    scene::{self, Fields},
};

/// What the search has found. The names are those of `record.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Safety {
    /// Middle of the bracket.
    pub factor_of_safety: f64,
    /// The largest factor with which the slope stood, and the least with which it failed.
    pub bracket: [f64; 2],
    /// In the order in which they were run.
    pub trials: Vec<Trial>,
}

/// One run with divided strengths.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trial {
    pub factor: f64,
    pub failed: bool,
    /// End of the run (s), and how it ended.
    pub time_s: f64,
    pub message: String,
    pub newton_iterations: u64,
}

/// Why there is no factor of safety.
#[derive(Clone, Debug, PartialEq)]
pub enum NoFactor {
    /// The case cannot be searched; the sentence names the key to change.
    Input(String),
    /// A run would take more memory than is allowed.
    TooLarge(String),
    /// A trial ended otherwise than by standing or failing.
    Trial { status: Status, message: String },
}

/// Halves the bracket of the case until it is as narrow as `tolerance`. `told` hears of each trial.
///
/// A slope has failed where, without inertia, no step down to the least leads to equilibrium; with `auto`, where
/// the soil has moved by the lowest of `slide.initial_levels` since the onset.
///
/// # Errors
/// A case that asks for no search or cannot tell failure; a slope that fails at `low` or stands at `high`; a
/// trial that was interrupted or broke off for another reason.
pub fn find(case: &Case, max_memory: u64, limits: Limits, mut told: impl FnMut(&Trial)) -> Result<Safety, NoFactor> {
    let keys = searchable(case)?;
    let fields = Fields::of(case).map_err(refused)?;
    let mut trials = Vec::new();
    let mut fails = |factor: f64| -> Result<bool, NoFactor> {
        let trial = attempt(case, max_memory, limits, &fields, factor)?;
        told(&trial);
        let failed = trial.failed;
        trials.push(trial);
        Ok(failed)
    };
    let (mut low, mut high) = (keys.low, keys.high);
    if fails(low)? {
        return Err(outside("fails", "low", low, "lower"));
    }
    if !fails(high)? {
        return Err(outside("stands", "high", high, "raise"));
    }
    while high - low > keys.tolerance {
        let middle = low + 0.5 * (high - low);
        // neighbours among the numbers have no middle
        if middle <= low || middle >= high {
            break;
        }
        *(if fails(middle)? { &mut high } else { &mut low }) = middle;
    }
    Ok(Safety { factor_of_safety: low + 0.5 * (high - low), bracket: [low, high], trials })
}

fn outside(what: &str, end: &str, factor: f64, way: &str) -> NoFactor {
    let text = format!("the slope {what} with its strength divided by {factor}: {way} `strength_reduction.{end}`");
    NoFactor::Input(text)
}

/// The keys of the search, for a case that can tell whether it fails.
fn searchable(case: &Case) -> Result<StrengthReduction, NoFactor> {
    let input = |text: &str| NoFactor::Input(text.to_owned());
    let keys = case.strength_reduction.ok_or_else(|| input("the case has no table `strength_reduction`"))?;
    if case.solver.scheme == Scheme::Explicit {
        return Err(input("a factor of safety is a question of equilibrium: set solver.scheme = \"implicit\""));
    }
    match case.implicit.regime {
        Regime::QuasiStatic => Ok(keys),
        Regime::Auto { .. } if case.slide.is_some() => Ok(keys),
        Regime::Auto { .. } => Err(input(
            "with implicit.regime = \"auto\" failure is told by what has moved: add the table `slide`, or set implicit.regime = \"quasi_static\"",
        )),
        _ => Err(input("a factor of safety needs implicit.regime = \"quasi_static\" or \"auto\"")),
    }
}

fn attempt(case: &Case, max_memory: u64, limits: Limits, fields: &Fields, factor: f64) -> Result<Trial, NoFactor> {
    let mut scene = scene::build_reduced(case, max_memory, fields, factor).map_err(refused)?;
    let broke = |e: std::io::Error| NoFactor::Trial { status: Status::Failed, message: e.to_string() };
    let outcome = run::run(case, &mut scene, limits, &mut Blind).map_err(broke)?;
    let failed = has_failed(&outcome)
        .ok_or_else(|| NoFactor::Trial { status: outcome.status, message: outcome.message.clone() })?;
    let newton_iterations = scene.simulation.work.newton_iterations;
    Ok(Trial { factor, failed, time_s: outcome.time, message: outcome.message, newton_iterations })
}

fn refused(e: scene::SceneError) -> NoFactor {
    if e.too_large { NoFactor::TooLarge(e.to_string()) } else { NoFactor::Input(e.to_string()) }
}

/// Whether a run shows a failed slope; `None` where it shows neither that nor one that stands.
pub fn has_failed(outcome: &Outcome) -> Option<bool> {
    let moved = outcome.measures.slope_failed;
    match outcome.status {
        Status::AtRest | Status::EndTime => Some(moved == Some(true)),
        Status::SlopeFailed => Some(true),
        Status::Failed if moved == Some(true) => Some(true),
        Status::Failed if moved.is_none() => {
            outcome.fault.as_ref().filter(|fault| fault.kind.is_loss_of_balance()).map(|_| true)
        }
        Status::Failed | Status::Interrupted | Status::ResourceCap => None,
    }
}
