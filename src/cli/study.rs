//! `rmpm study` and `rmpm compare rfem`.

use std::path::{Path, PathBuf};

use super::{
    Failure, conduct, ensemble as single,
    exit::print,
    input::{CaseArgs, read_text, size},
    progress::runs_bar,
};
use crate::{
    case::{self, Arm, Study},
    output::folder,
    study::arms::{self, Plan, Progress, Ran, Viewer},
};

/// How ensembles side by side are run.
#[derive(Debug, clap::Args)]
pub struct Options {
    /// Realisations of each arm, in place of those of the study
    #[arg(short = 'n', long, value_parser = clap::value_parser!(u64).range(2..=1_000_000))]
    realisations: Option<u64>,
    #[command(flatten)]
    conduct: conduct::Options,
}

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Study file (TOML): a case, and arms with changed keys
    study: PathBuf,
    /// Change a key in all arms, e.g. --set grid.cell=0.5 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Folder for ensembles, tables and pictures; out/<name of the study> without it
    #[arg(long, short)]
    out: Option<PathBuf>,
    /// Memory that a run may take
    #[arg(long, default_value = "4GiB", value_parser = size, value_name = "SIZE")]
    max_memory: u64,
    #[command(flatten)]
    options: Options,
}

#[derive(Debug, clap::Args)]
pub struct RfemArgs {
    #[command(flatten)]
    case: CaseArgs,
    /// Folder for ensembles, pairs and pictures; out/<name of the case>-rfem without it
    #[arg(long, short)]
    out: Option<PathBuf>,
    #[command(flatten)]
    options: Options,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let name = args.study.display().to_string();
    let text = read_text(&args.study)?;
    let (study, _) = case::read_study(&name, &text, &args.set).map_err(|e| Failure::Input(e.render(false)))?;
    let path = args.study.parent().unwrap_or(Path::new("")).join(&study.case);
    let text = read_text(&path)?;
    let stem = args.study.file_stem().unwrap_or_default();
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("out").join(stem));
    let plan = plan(study, path.display().to_string(), text, args.max_memory, &args.options);
    carry_out(&plan, &out, &args.options)
}

/// One arm: the case as it is, and RFEM on its fields.
pub fn rfem(args: &RfemArgs) -> Result<(), Failure> {
    let (case, source) = args.case.read()?;
    let stem = args.case.case.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{stem}-rfem")));
    let arm = Arm {
        name: "rmpm".to_owned(),
        group: String::new(),
        set: Vec::new(),
        realisations: None,
        rfem: true,
        expect: None,
    };
    let title = format!("{}: RMPM and RFEM on the same fields", case.title);
    let study =
        Study { title, case: source.path.clone(), realisations: None, set: source.overrides.clone(), arms: vec![arm] };
    let plan = plan(study, source.path, source.text, args.case.max_memory, &args.options);
    carry_out(&plan, &out, &args.options)
}

fn plan(study: Study, name: String, text: String, max_memory: u64, options: &Options) -> Plan {
    let conduct = options.conduct.conduct(max_memory);
    Plan { study, name, text, realisations: options.realisations, conduct }
}

fn carry_out(plan: &Plan, out: &Path, options: &Options) -> Result<(), Failure> {
    let place = out.display().to_string();
    let write = |e: std::io::Error| Failure::io(&place, &e);
    let _lock = folder::claim(out).map_err(write)?;
    let begin = |label: &str| -> Progress {
        if !options.conduct.quiet {
            eprintln!("{label}");
        }
        Box::new(runs_bar(options.conduct.quiet))
    };
    let ran = arms::study(plan, out, &Viewer { begin: &begin, note: &single::note })
        .map_err(|e| single::failure(&place, e))?;
    let report = arms::report(plan, &ran);
    arms::write(out, &report).map_err(write)?;
    arms::draw(out, &report).map_err(write)?;
    let json = || serde_json::to_string_pretty(&report).map_err(|e| write(e.into()));
    let table = || format!("{}left in {place}\n", arms::table(&report));
    print(&if options.conduct.json { json()? + "\n" } else { table() })?;
    ending(plan, &ran)
}

fn ending(plan: &Plan, ran: &[Ran]) -> Result<(), Failure> {
    let whole = |r: &Ran| r.rmpm.results.complete() && r.rfem.as_ref().is_none_or(|e| e.results.complete());
    if ran.len() < plan.study.arms.len() || !ran.iter().all(whole) {
        let done = |r: &Ran| r.rmpm.results.rows.len() + r.rfem.as_ref().map_or(0, |e| e.results.rows.len());
        return Err(single::unfinished(ran.iter().map(done).sum()));
    }
    let failed = |r: &Ran| r.rmpm.results.failed() + r.rfem.as_ref().map_or(0, |e| e.results.failed());
    single::failures(ran.iter().map(failed).sum())
}
