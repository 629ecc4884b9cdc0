//! `rmpm validate`.

use std::path::PathBuf;

use super::{Failure, exit::print};
use crate::{
    output::{
        folder,
        record::{Build, SCHEMA_VERSION},
    },
    study::validate::{self, Effort, Report},
};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Problems to run; all without a name
    names: Vec<String>,
    /// Fine grids and all sizes: minutes instead of seconds
    #[arg(long)]
    full: bool,
    /// Folder for validate.json and validate.html
    #[arg(long, short, default_value = "out/validate")]
    out: PathBuf,
    /// Print the reports as JSON on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let write = |e: std::io::Error| Failure::io(&args.out.display().to_string(), &e);
    let _lock = folder::claim(&args.out).map_err(write)?;
    let effort = if args.full { Effort::Full } else { Effort::Short };
    let problems = validate::choose(&args.names).map_err(Failure::Input)?;
    let mut reports = Vec::new();
    show(args, &validate::header())?;
    for problem in problems {
        let report = problem.run(effort).map_err(Failure::Input)?;
        show(args, &validate::section(&report))?;
        reports.push(report);
    }
    let all = serde_json::json!({ "schema_version": SCHEMA_VERSION, "build": Build::current(), "problems": reports });
    let json = serde_json::to_string_pretty(&all).map_err(|e| write(e.into()))?;
    folder::write_text(&args.out.join("validate.json"), &(json.clone() + "\n")).map_err(write)?;
    for (name, text) in reports.iter().flat_map(|r| &r.files) {
        folder::write_text(&args.out.join(name), text).map_err(write)?;
    }
    folder::write_text(&args.out.join("timing.json"), &timing(&reports)).map_err(write)?;
    let page = validate::page(&reports, effort, &Build::current()).map_err(write)?;
    folder::write_text(&args.out.join("validate.html"), &page).map_err(write)?;
    if args.json {
        print(&(json + "\n"))?;
    }
    show(args, &validate::total(&reports))?;
    let failed: Vec<&str> = reports.iter().filter(|r| !r.pass()).map(|r| r.name.as_str()).collect();
    if failed.is_empty() { Ok(()) } else { Err(Failure::Solver(format!("failed: {}", failed.join(", ")))) }
}

/// Prints what there is so far; on standard error where standard output is for JSON.
fn show(args: &Args, text: &str) -> Result<(), Failure> {
    if args.json {
        eprint!("{text}");
        return Ok(());
    }
    print(text)
}

/// CPU time of each problem (s): what is not the same twice.
fn timing(reports: &[Report]) -> String {
    let times: serde_json::Map<_, _> =
        reports.iter().map(|r| (r.name.clone(), serde_json::json!({ "cpu_s": r.cost.cpu_s }))).collect();
    format!("{:#}\n", serde_json::Value::Object(times))
}
