//! `rmpm multilevel`.

use std::{fs::File, path::PathBuf};

use super::{Failure, ensemble::failure, exit::print, input::CaseArgs, interrupt, progress::runs_bar};
use crate::{
    case::Case,
    output::folder,
    run::Limits,
    study::multilevel::{self, Levels, Plan, QUANTITIES, Study, Target, picture, text},
};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    case: CaseArgs,
    /// Folder for tables and pictures; out/<name of the case>-multilevel without it
    #[arg(long, short)]
    out: Option<PathBuf>,
    /// Cell sizes (m), coarsest first; 4, 2 and 1 times that of the case without it
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = positive)]
    levels: Vec<f64>,
    /// Realisations of each level to start with; the last number holds for all finer ones
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "40,24,12", value_parser = clap::value_parser!(u64).range(2..=1_000_000))]
    pilot: Vec<u64>,
    /// Error of the mean to aim at, in the unit of the first measure
    #[arg(long, default_value = "0.3", value_parser = positive)]
    error: f64,
    /// Part of its square kept for the bias of the finest level
    #[arg(long, default_value = "0.5", value_parser = share)]
    bias_share: f64,
    /// CPU time (s) for further realisations towards that error; only the start is run without it
    #[arg(long, value_name = "SECONDS", default_value = "0", value_parser = time)]
    budget: f64,
    /// Points on each axis of a cell to try beside those of the case
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "3")]
    points: Vec<usize>,
    /// Factors on the time step to try beside 1
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "2", value_parser = positive)]
    steps: Vec<f64>,
    /// Try no other points and steps
    #[arg(long)]
    cells_only: bool,
    /// The time step of the case on all levels; without it a step keeps its ratio to the cell
    #[arg(long)]
    same_step: bool,
    /// Change a key on one level, from 0, the coarsest, e.g. --at-level 0:explicit.time_step=0.004 (repeatable)
    #[arg(long, value_name = "LEVEL:KEY=VALUE", value_parser = at_level)]
    at_level: Vec<(usize, String)>,
    /// A measure (a column of levels.csv; repeatable); the first one is that of the error. Distance, first block,
    /// volume and onset of the slide without it
    #[arg(long, value_name = "NAME")]
    quantity: Vec<String>,
    /// Runs at a time; all cores without it
    #[arg(long, short = 'j')]
    jobs: Option<usize>,
    /// Print the study as JSON on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let (case, source) = args.case.read()?;
    let stem = args.case.case.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{stem}-multilevel")));
    let write = |e: std::io::Error| Failure::io(&out.display().to_string(), &e);
    let _lock = folder::claim(&out).map_err(write)?;
    let plan = Plan {
        name: source.path.clone(),
        text: source.text.clone(),
        overrides: source.overrides.clone(),
        levels: levels(args, &case),
        pilot: args.pilot.clone(),
        target: Target { error: args.error, bias_share: args.bias_share },
        budget: args.budget,
        quantities: quantities(args),
        max_memory: args.case.max_memory,
        threads: args.jobs.unwrap_or(0),
        limits: Limits { interrupt: Some(interrupt::flag()), time_limit: None },
    };
    let mut journal = File::create(out.join("levels.csv")).map_err(write)?;
    let (study, rows) = multilevel::multilevel(&plan, &mut journal, &runs_bar(false))
        .map_err(|problem| failure(&out.display().to_string(), problem))?;
    folder::write_text(&out.join("levels.csv"), &rows).map_err(write)?;
    let json = serde_json::to_string_pretty(&study).map_err(|e| write(e.into()))?;
    folder::write_text(&out.join("multilevel.json"), &(json.clone() + "\n")).map_err(write)?;
    picture::draw(&out, &study).map_err(write)?;
    let table = || format!("{}left in {}\n", text::table(&study), out.display());
    print(&if args.json { json + "\n" } else { table() })?;
    ending(&study)
}

fn ending(study: &Study) -> Result<(), Failure> {
    if study.interrupted {
        return Err(Failure::Interrupted("runs that were cut short are left out".to_owned()));
    }
    if study.failed > 0 { Err(Failure::Partly(format!("{} runs failed", study.failed))) } else { Ok(()) }
}

fn levels(args: &Args, case: &Case) -> Levels {
    let usual = || [4.0, 2.0, 1.0].map(|factor| factor * case.grid.cell).to_vec();
    Levels {
        cells: if args.levels.is_empty() { usual() } else { args.levels.clone() },
        keys: args.at_level.clone(),
        points: if args.cells_only { Vec::new() } else { args.points.clone() },
        steps: if args.cells_only { Vec::new() } else { args.steps.clone() },
        same_step: args.same_step,
    }
}

fn quantities(args: &Args) -> Vec<String> {
    if args.quantity.is_empty() { QUANTITIES.map(str::to_owned).to_vec() } else { args.quantity.clone() }
}

fn positive(text: &str) -> Result<f64, String> {
    let found: Option<f64> = text.trim().parse().ok();
    found.filter(|v| *v > 0.0 && v.is_finite()).ok_or_else(|| format!("'{text}' is no positive number"))
}

fn time(text: &str) -> Result<f64, String> {
    let found: Option<f64> = text.trim().parse().ok();
    found.filter(|v| *v >= 0.0 && v.is_finite()).ok_or_else(|| format!("'{text}' is no time in s"))
}

fn share(text: &str) -> Result<f64, String> {
    let found: Option<f64> = text.trim().parse().ok();
    found.filter(|v| (0.0..1.0).contains(v)).ok_or_else(|| format!("'{text}' is no share from 0 to below 1"))
}

/// `LEVEL:KEY=VALUE`.
fn at_level(text: &str) -> Result<(usize, String), String> {
    let wrong = || format!("'{text}': write LEVEL:KEY=VALUE, e.g. 0:explicit.time_step=0.004");
    let (level, key) = text.split_once(':').ok_or_else(wrong)?;
    let level = level.trim().parse().map_err(|_| wrong())?;
    if key.contains('=') { Ok((level, key.trim().to_owned())) } else { Err(wrong()) }
}
