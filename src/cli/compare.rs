//! `rmpm compare`.

use std::path::PathBuf;

use super::{Failure, exit::print, input::CaseArgs, interrupt, progress::runs_bar};
use crate::{
    output::folder,
    run::Limits,
    study::compare::{self, Plan, Study, picture},
};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, clap::Subcommand)]
enum What {
    /// The explicit and the implicit scheme on one case: onset, slide, energies, CPU time
    Schemes(Schemes),
    /// RFEM and RMPM on the same random fields: pairs of r, histograms over each other
    Rfem(super::study::RfemArgs),
}

#[derive(Debug, clap::Args)]
struct Schemes {
    #[command(flatten)]
    case: CaseArgs,
    /// Folder for tables and picture; out/<name of the case>-schemes without it
    #[arg(long, short)]
    out: Option<PathBuf>,
    /// Jittered runs of each scheme
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    /// Jittered runs of each other step and integrator of inertia; 0 leaves these out
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(0..=10_000))]
    sweep_runs: u32,
    /// Implicit steps (s); the first is compared with the explicit scheme
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "0.01,0.005,0.02,0.04", value_parser = step)]
    dt: Vec<f64>,
    /// Largest relative change of strength between runs
    #[arg(long, default_value_t = 0.0005)]
    jitter: f64,
    /// Runs at a time; all cores without it
    #[arg(long, short = 'j')]
    jobs: Option<usize>,
    /// Print the study as JSON on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    match &args.what {
        What::Schemes(args) => schemes(args),
        What::Rfem(args) => super::study::rfem(args),
    }
}

fn schemes(args: &Schemes) -> Result<(), Failure> {
    if args.case.scheme.is_some() {
        return Err(Failure::Input("--scheme: both schemes are compared".to_owned()));
    }
    let (case, source) = args.case.read()?;
    let stem = args.case.case.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{stem}-schemes")));
    let write = |e: std::io::Error| Failure::io(&out.display().to_string(), &e);
    let _lock = folder::claim(&out).map_err(write)?;
    let plan = Plan {
        name: source.path.clone(),
        text: source.text.clone(),
        overrides: source.overrides.clone(),
        runs: args.runs as usize,
        sweep: args.sweep_runs as usize,
        steps: args.dt.clone(),
        jitter: args.jitter,
        max_memory: args.case.max_memory,
        threads: args.jobs.unwrap_or(0),
        limits: Limits { interrupt: Some(interrupt::flag()), time_limit: None },
    };
    let study = compare::compare(&plan, &case, &runs_bar(false)).map_err(Failure::Input)?;
    let json = serde_json::to_string_pretty(&study).map_err(|e| write(e.into()))?;
    folder::write_text(&out.join("compare.json"), &(json.clone() + "\n")).map_err(write)?;
    folder::write_text(&out.join("compare.csv"), &compare::csv(&study).map_err(write)?).map_err(write)?;
    picture::draw(&out.join("compare.png"), &case, &study).map_err(write)?;
    let table = || format!("{}left in {}\n", compare::table(&study), out.display());
    print(&if args.json { json + "\n" } else { table() })?;
    ending(&study)
}

fn ending(study: &Study) -> Result<(), Failure> {
    if interrupt::flag().load(std::sync::atomic::Ordering::Relaxed) {
        return Err(Failure::Interrupted("runs that were cut short are left out of the table".to_owned()));
    }
    let failed: usize = study.rows.iter().map(|r| r.failed).sum();
    if failed > 0 { Err(Failure::Partly(format!("{failed} runs failed"))) } else { Ok(()) }
}

/// A length of step (s).
fn step(text: &str) -> Result<f64, String> {
    let found: Option<f64> = text.trim().parse().ok();
    found.filter(|dt| *dt > 0.0 && dt.is_finite()).ok_or_else(|| format!("'{text}' is no length of a step in s"))
}
