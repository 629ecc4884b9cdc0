//! `rmpm ensemble`.

use std::{path::PathBuf, sync::atomic::Ordering};

use super::{Failure, conduct::Options, exit::print, input::CaseArgs, interrupt, progress::runs_bar};
use crate::{
    output::folder,
    study::ensemble::{self, Ended, Plan, Problem, Shard, Watch},
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
    #[command(flatten)]
    options: Options,
}

pub fn run(args: &Args) -> Result<(), Failure> {
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
        conduct: args.options.conduct(args.case.max_memory),
    };
    let watch = Watch { progress: &runs_bar(args.options.quiet), note: &note };
    let ended = ensemble::ensemble(&plan, &out, &watch).map_err(|e| failure(&place, e))?;
    say(&ended, args.options.json, &place)?;
    ending(&ended)
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
    if !ended.results.complete() {
        return Err(unfinished(ended.results.rows.len()));
    }
    failures(ended.results.failed())
}

/// Why not all is done, and how to go on.
pub fn unfinished(done: usize) -> Failure {
    let hint = format!("{done} realisations are done and kept; go on with: {}", again());
    match interrupt::flag().load(Ordering::Relaxed) {
        true => Failure::Interrupted(format!("interrupted: {hint}")),
        false => Failure::Cap(format!("the time limit was reached: {hint}")),
    }
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
