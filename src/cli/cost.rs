//! `rmpm cost`.

use std::path::PathBuf;

use super::{Failure, exit::print, input::CaseArgs, interrupt, progress::runs_bar};
use crate::{
    output::folder,
    run::Limits,
    study::{
        cost::{self, Axis, Plan},
        variant,
    },
};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    case: CaseArgs,
    /// Folder for tables and picture; out/<name of the case>-cost without it
    #[arg(long, short)]
    out: Option<PathBuf>,
    /// A probe by its name, or a measure such as sliding_distance; without it the first probe, else the sliding
    /// distance, else the largest displacement
    #[arg(long, value_name = "NAME")]
    quantity: Option<String>,
    /// Values of a key, in place of its usual ones or beside the other keys, e.g. --vary points.per_axis=2,3 (repeatable)
    #[arg(long, value_name = "KEY=V1,V2", value_parser = axis)]
    vary: Vec<Axis>,
    /// Meshes: h, h/2, h/4, ...
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=6))]
    levels: u32,
    /// CPU seconds for all runs; settings that are expected to exceed what is left are skipped
    #[arg(long, value_name = "SECONDS", default_value_t = 120.0, value_parser = budget)]
    budget: f64,
    /// Jittered runs a setting, where the quantity is statistical (sliding distance, slide volume)
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    /// Largest relative change of strength between these runs
    #[arg(long, default_value_t = 0.0005)]
    jitter: f64,
    /// Runs at a time; more than 1 is sooner done, but runs beside one another slow each other down. 0: all cores
    #[arg(long, short = 'j', default_value_t = 1, value_parser = clap::value_parser!(u16).range(0..=1024))]
    jobs: u16,
    /// No progress bar
    #[arg(long, short)]
    quiet: bool,
    /// Print the study as JSON on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let (_, source) = args.case.read()?;
    let stem = args.case.case.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{stem}-cost")));
    let write = |e: std::io::Error| Failure::io(&out.display().to_string(), &e);
    let _lock = folder::claim(&out).map_err(write)?;
    let plan = Plan {
        name: source.path.clone(),
        text: source.text.clone(),
        overrides: source.overrides.clone(),
        vary: args.vary.clone(),
        levels: args.levels,
        quantity: args.quantity.clone(),
        runs: args.runs as usize,
        jitter: args.jitter,
        budget_s: args.budget,
        max_memory: args.case.max_memory,
        threads: usize::from(args.jobs),
        limits: Limits { interrupt: Some(interrupt::flag()), time_limit: None },
    };
    let study = cost::cost(&plan, &runs_bar(args.quiet)).map_err(Failure::Input)?;
    let json = serde_json::to_string_pretty(&study).map_err(|e| write(e.into()))?;
    folder::write_text(&out.join("cost.json"), &(json.clone() + "\n")).map_err(write)?;
    folder::write_text(&out.join("cost.csv"), &cost::csv(&study)).map_err(write)?;
    cost::draw(&out.join("cost.png"), &study).map_err(write)?;
    let table = || format!("{}left in {}\n", cost::table(&study), out.display());
    print(&if args.json { json + "\n" } else { table() })?;
    if plan.limits.interrupted() {
        return Err(Failure::Interrupted("the runs were cut short; what they had is in the table".to_owned()));
    }
    // a setting that is too coarse to run is part of the answer; none that runs is a failure
    let none = study.rows.iter().all(|row| row.value.is_none());
    if none { Err(Failure::Solver("no setting gave a value".to_owned())) } else { Ok(()) }
}

fn axis(text: &str) -> Result<Axis, String> {
    let variants = variant::parse(text)?;
    let pairs: Vec<(&str, &str)> =
        variants.iter().flat_map(|v| &v.overrides).filter_map(|o| o.split_once('=')).collect();
    let key = pairs.first().map(|(key, _)| (*key).to_owned()).unwrap_or_default();
    Ok(Axis { key, values: pairs.into_iter().map(|(_, value)| value.trim_matches('"').to_owned()).collect() })
}

fn budget(text: &str) -> Result<f64, String> {
    let seconds: Option<f64> = text.trim().parse().ok();
    seconds.filter(|s| *s > 0.0 && s.is_finite()).ok_or_else(|| format!("'{text}' is no time in s"))
}
