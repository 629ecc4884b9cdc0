//! `rmpm ensemble`.

use std::{path::PathBuf, sync::atomic::Ordering, time::Duration};

use super::{Failure, exit::print, input::CaseArgs, interrupt, progress::runs_bar};
use crate::{
    output::folder,
    study::ensemble::{self, Ended, Plan, Problem, Shard, Start, Watch},
};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    case: CaseArgs,
    /// Folder for journal, tables and summary; out/<name of the case>-ensemble without it
    #[arg(long, short)]
    out: Option<PathBuf>,
    /// How many realisations, over all shards; `ensemble.realisations` of the case without it
    #[arg(short = 'n', long, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    realisations: Option<u64>,
    /// The first of them
    #[arg(long, value_name = "K", default_value_t = 0)]
    first: u64,
    /// Only a part, for one of several machines, e.g. 2/7; `rmpm merge` puts the parts together
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    shard: Shard,
    /// Go on with the ensemble in the folder
    #[arg(long, conflicts_with = "fresh")]
    resume: bool,
    /// Start over, whatever ensemble the folder holds
    #[arg(long)]
    fresh: bool,
    /// Realisations at a time; all cores without it
    #[arg(long, short = 'j', value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Begin no realisation after this much wall time (s)
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    time_limit: Option<Duration>,
    /// No progress bar
    #[arg(long, short)]
    quiet: bool,
    /// Print {summary, timing} as JSON on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let (stop, abandon) = (interrupt::flag(), interrupt::second());
    let (case, _) = args.case.read()?;
    let stem = args.case.case.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{stem}-ensemble")));
    let place = out.display().to_string();
    let _lock = folder::claim(&out).map_err(|e| Failure::io(&place, &e))?;
    let plan = Plan {
        first: args.first,
        realisations: args.realisations.unwrap_or(case.ensemble.realisations),
        case,
        shard: args.shard,
        start: start(args),
        threads: args.jobs.map_or(0, usize::from),
        max_memory: args.case.max_memory,
        time_limit: args.time_limit,
        stop,
        abandon,
    };
    let watch = Watch { progress: &runs_bar(args.quiet), note: &note };
    let ended = ensemble::ensemble(&plan, &out, &watch).map_err(|e| failure(&place, e))?;
    say(&ended, args.json, &place)?;
    ending(&ended)
}

fn start(args: &Args) -> Start {
    match (args.resume, args.fresh) {
        (true, _) => Start::Resume,
        (_, true) => Start::Fresh,
        _ => Start::New,
    }
}

/// A note while the bar may be there.
pub fn note(text: &str) {
    eprintln!("note: {text}");
}

/// A problem of an ensemble as the failure of a command.
pub fn failure(place: &str, problem: Problem) -> Failure {
    match problem {
        Problem::Refused(text) => Failure::Input(text),
        Problem::TooLarge(text) => Failure::Cap(text),
        Problem::Io(error) => Failure::io(place, &error),
    }
}

/// Prints an ensemble.
pub fn say(ended: &Ended, json: bool, place: &str) -> Result<(), Failure> {
    if json {
        let text = serde_json::to_string_pretty(&ended.report).map_err(|e| Failure::io(place, &e.into()))?;
        return print(&(text + "\n"));
    }
    print(&format!("{}  left in     {place}\n", ensemble::text(&ended.results, &ended.report)))
}

/// What is not done comes before what has failed: it can be gone on with.
fn ending(ended: &Ended) -> Result<(), Failure> {
    let (done, failed) = (ended.results.rows.len(), ended.results.failed());
    if !ended.results.complete() {
        let hint = format!("{done} realisations are done and kept; go on with: {}", again());
        return Err(if interrupt::flag().load(Ordering::Relaxed) {
            Failure::Interrupted(format!("interrupted: {hint}"))
        } else {
            Failure::Cap(format!("the time limit was reached: {hint}"))
        });
    }
    failures(failed)
}

/// Realisations that have failed.
pub fn failures(failed: usize) -> Result<(), Failure> {
    if failed == 0 {
        return Ok(());
    }
    Err(Failure::Partly(format!(
        "{failed} runs failed; they are rows with their reasons in ensemble.csv or summary.json"
    )))
}

/// The command that goes on.
fn again() -> String {
    let typed = std::env::args().filter(|a| a != "--resume" && a != "--fresh");
    typed.chain(["--resume".to_owned()]).map(|a| quoted(&a)).collect::<Vec<_>>().join(" ")
}

/// An argument as a shell takes it.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

/// A length of time (s).
fn seconds(text: &str) -> Result<Duration, String> {
    let wrong = || format!("'{text}' is no time in s");
    Duration::try_from_secs_f64(text.trim().parse().map_err(|_| wrong())?).map_err(|_| wrong())
}
