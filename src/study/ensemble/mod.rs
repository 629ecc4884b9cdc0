//! `rmpm ensemble`: many realisations of a random case, each a row that is safe as soon as it is done.
//!
//! Realisations go to threads in order; which thread did one, in how many sessions, on how many
//! machines, leaves no trace in `ensemble.csv` and `summary.json`.

mod folder;
mod journal;
mod measures;
pub mod merge;
mod pictures;
mod realise;
mod results;
mod row;
mod slide;
mod summary;
mod tables;
#[cfg(test)]
mod tests;
mod text;
mod timing;
mod until;

pub use folder::Start;
pub use measures::{CENSORED, SLIDE_VOLUME, SLIDING_DISTANCE, first_slide};
pub(super) use measures::{Measure, list as all_measures, needs_crest};
pub use realise::{Draw, Shard, is_random, realise};
pub use results::Results;
pub(super) use row::{Done, Realiser};
pub use slide::resolution;
pub use summary::Summary;
pub use text::text;
pub use timing::{Spent, Timing};

use std::{
    collections::BTreeMap,
    fmt, io,
    ops::ControlFlow,
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use serde::Serialize;

use super::workers;
use crate::{
    case::Case,
    output::{
        folder::write_text,
        record::{Build, SCHEMA_VERSION, cpu_seconds},
    },
    run::Limits,
    scene,
};
use journal::{Journal, Session};
use until::decide;

/// What is run. The case says when to stop earlier.
#[derive(Clone, Debug)]
pub struct Plan {
    pub case: Case,
    /// First realisation, and how many over all shards.
    pub first: u64,
    pub realisations: u64,
    pub shard: Shard,
    pub conduct: Conduct,
}

/// How ensembles are run.
#[derive(Clone, Copy, Debug)]
pub struct Conduct {
    pub start: Start,
    /// Realisations at a time; 0 is one a core.
    pub threads: usize,
    pub max_memory: u64,
    /// Wall time after which none is begun any more.
    pub time_limit: Option<Duration>,
    /// Set to finish those under way and begin no more, and to abandon those under way.
    pub stop: &'static AtomicBool,
    pub abandon: &'static AtomicBool,
}

/// Why an ensemble cannot be run, gone on with or merged.
#[derive(Debug)]
pub enum Problem {
    /// Bad input, with what to do.
    Refused(String),
    /// It takes more memory than it may.
    TooLarge(String),
    /// Reading or writing failed.
    Io(io::Error),
}

impl From<io::Error> for Problem {
    fn from(error: io::Error) -> Self {
        Problem::Io(error)
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Problem::Refused(text) | Problem::TooLarge(text) => f.write_str(text),
            Problem::Io(error) => error.fmt(f),
        }
    }
}

/// What the files hold that are not tables.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    pub summary: Summary,
    pub timing: Timing,
}

/// An ensemble as far as it has come.
#[derive(Clone, Debug)]
pub struct Ended {
    pub results: Results,
    pub report: Report,
}

/// Who is told how an ensemble goes.
pub struct Watch<'a> {
    /// How many of how many draws of this session are done.
    pub progress: &'a dyn Fn(usize, usize),
    /// What the user should know at once.
    pub note: &'a dyn Fn(&str),
}

/// Runs what is not done yet, into a claimed folder. An ensemble that was stopped leaves its files too.
///
/// # Errors
/// A case that is not random or cannot be built, a folder that holds something else; those of the
/// file system, with all rows done so far kept.
pub fn ensemble(plan: &Plan, out: &Path, watch: &Watch) -> Result<Ended, Problem> {
    let (began, cpu) = (Instant::now(), cpu_seconds());
    let realiser = realiser(plan)?;
    let session = session(plan);
    let (mut journal, known, notes) = folder::open(out, &session, plan.conduct.start)?;
    notes.iter().for_each(|text| (watch.note)(text));
    if plan.case.strength_reduction.is_some() {
        (watch.note)(
            "each realisation runs with its own strength; `strength_reduction` is searched by `rmpm solve` alone",
        );
    }
    write_text(&out.join("case.toml"), &realise::resolved(&plan.case, plan.realisations))?;
    let mut done = known.done;
    let mut spent = Spent { threads: 0, ..Spent::default() };
    work(plan, &session, &realiser, &mut journal, &mut done, &mut spent, watch)?;
    spent.wall_s = began.elapsed().as_secs_f64();
    spent.cpu_s = cpu_seconds().zip(cpu).map(|(b, a)| b - a);
    let results = Results::new(&plan.case, &session, &done);
    let report = write(out, &results, &spent)?;
    if results.complete() {
        journal.finish()?;
    }
    Ok(Ended { results, report })
}

/// Looks whether an ensemble could begin, without changing anything. Whether its folder holds one already.
///
/// # Errors
/// A case that is not random or cannot be built, a folder that may not be taken in this way.
pub fn ready(plan: &Plan, out: &Path) -> Result<bool, Problem> {
    realiser(plan)?;
    folder::admit(out, &session(plan), plan.conduct.start).map(|known| known.id().is_some())
}

/// Most realisations: the list of those to be done stands in memory.
const MOST: u64 = 10_000_000;

/// What all draws share. What no realisation can do is told before any is begun.
fn realiser(plan: &Plan) -> Result<Realiser<'_>, Problem> {
    check(plan).map_err(Problem::Refused)?;
    let cannot = |e: scene::SceneError| {
        if e.too_large { Problem::TooLarge(e.to_string()) } else { Problem::Refused(e.to_string()) }
    };
    let limits = Limits { interrupt: Some(plan.conduct.abandon), time_limit: None };
    let realiser = Realiser::new(&plan.case, plan.conduct.max_memory, limits).map_err(cannot)?;
    realiser.scene(None).map_err(cannot)?;
    Ok(realiser)
}

fn check(plan: &Plan) -> Result<(), String> {
    if !is_random(&plan.case) {
        return Err("nothing in the case is random: add a `[field]`, set `jitter.strength`, or run `rmpm solve`".into());
    }
    if plan.first.checked_add(plan.realisations).is_none() {
        return Err("--first and the number of realisations are too large".into());
    }
    if plan.realisations > MOST {
        return Err(format!("{} realisations: at most {MOST} can be run", plan.realisations));
    }
    let Some(until) = &plan.case.ensemble.until else { return Ok(()) };
    if plan.shard != Shard::WHOLE {
        return Err("a shard does not see all realisations: `ensemble.until` cannot be used with --shard".into());
    }
    if plan.case.slide.is_none() && measures::needs_crest(&until.measure) {
        return Err(format!(
            "`ensemble.until.measure`: `{}` is measured from a crest: add the table `slide`, or choose another, such as runout_m",
            until.measure
        ));
    }
    let names: Vec<String> = measures::list(&plan.case).into_iter().map(|m| m.name).collect();
    if names.contains(&until.measure) {
        return Ok(());
    }
    Err(format!("`ensemble.until.measure`: there is no `{}`; choose from {}", until.measure, names.join(", ")))
}

fn session(plan: &Plan) -> Session {
    Session {
        schema_version: SCHEMA_VERSION,
        case_hash: realise::case_hash(&plan.case),
        seed: plan.case.seed,
        build: Build::current(),
        shard: plan.shard,
        first: plan.first,
        realisations: plan.realisations,
    }
}

/// Runs the draws that are missing; each goes to the journal and to `done`.
fn work(
    plan: &Plan,
    session: &Session,
    realiser: &Realiser,
    journal: &mut Journal,
    done: &mut BTreeMap<Draw, Done>,
    spent: &mut Spent,
    watch: &Watch,
) -> io::Result<()> {
    let until = plan.case.ensemble.until.as_ref();
    let enough = |done: &_| until.is_some_and(|rule| decide(rule, plan.first, done).reached);
    // the run at the mean belongs to every ensemble
    let wanted = |draw: &Draw| !done.contains_key(draw) && (draw.is_none() || !enough(done));
    let draws: Vec<Draw> = session.draws().filter(wanted).collect();
    if draws.is_empty() {
        return Ok(());
    }
    let began = Instant::now();
    let stop = || {
        plan.conduct.stop.load(Ordering::Relaxed)
            || plan.conduct.time_limit.is_some_and(|limit| began.elapsed() >= limit)
    };
    let run = |worker: usize, draw: &Draw| realiser.run(*draw, worker);
    spent.threads = workers::count(plan.conduct.threads).min(draws.len());
    let mut failure = None;
    workers::hand_out(plan.conduct.threads, &draws, &stop, &run, &mut |_, result: Option<Done>| {
        let Some(row) = result else { return ControlFlow::Break(()) };
        if let Err(e) = journal.rows([&row].into_iter()) {
            failure.get_or_insert(e);
            return ControlFlow::Break(());
        }
        spent.draws += 1;
        spent.busy_s += row.cost.wall_s;
        done.insert(row.row.realisation, row);
        (watch.progress)(spent.draws, draws.len());
        if enough(done) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    spent.working_s = began.elapsed().as_secs_f64();
    failure.map_or(Ok(()), Err)
}

/// Writes all files but the journal, each whole or not at all.
fn write(out: &Path, results: &Results, spent: &Spent) -> io::Result<Report> {
    let report = Report { summary: summary::summary(results), timing: timing::timing(results, spent) };
    write_text(&out.join("case.toml"), &realise::resolved(&results.case, results.session.realisations))?;
    write_text(&out.join("ensemble.csv"), &tables::csv(results)?)?;
    write_text(&out.join("ensemble_timing.csv"), &tables::timing_csv(results)?)?;
    write_json(&out.join("summary.json"), &report.summary)?;
    write_json(&out.join("timing.json"), &report.timing)?;
    pictures::draw(out, results)?;
    Ok(report)
}

fn write_json(path: &Path, value: &impl Serialize) -> io::Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(io::Error::other)?;
    write_text(path, &(text + "\n"))
}
