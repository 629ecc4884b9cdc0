//! `rmpm converge`.

use std::path::PathBuf;

use super::{Failure, exit::print, input::CaseArgs, interrupt, progress::runs_bar};
use crate::{
    case::{Case, Material},
    output::folder,
    run::Limits,
    study::{
        converge::{self, Axis, Draws, LadderPlan, Plan},
        variant::{self, Variant},
    },
};

/// Jittered runs of a level where the soil has a strength and nothing else is asked for.
const RUNS: u32 = 6;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    case: CaseArgs,
    /// Folder for table and pictures; out/<name of the case>-converge without it
    #[arg(long, short)]
    out: Option<PathBuf>,
    #[command(flatten)]
    ladders: Ladders,
    /// A probe by its name, or a measure such as sliding_distance (repeatable); without it the first probe, else the
    /// sliding distance, else the largest displacement
    #[arg(long, value_name = "NAME")]
    quantity: Vec<String>,
    /// Jittered runs a level; 1: one run as the case is. Without it 6, or 1 where no soil has a strength
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: Option<u32>,
    /// Largest relative change of strength between runs
    #[arg(long, default_value_t = 0.0005)]
    jitter: f64,
    /// Realisations of the random fields in place of jittered runs, the same at every level
    #[arg(long, value_name = "N", conflicts_with = "runs", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    realisations: Option<u32>,
    /// Runs at a time; all cores without it
    #[arg(long, short = 'j')]
    jobs: Option<usize>,
    /// Print the study as JSON on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

/// What is refined or varied. Without any of these: the mesh and 20/29 of it, the points and twice as many an axis,
/// and three time steps.
#[derive(Debug, clap::Args)]
struct Ladders {
    /// Cell sizes, e.g. --meshes 0.5,0.25,5/29; h, h/2 and h/4 without values
    #[arg(long, value_name = "H1,H2", num_args = 0..=1, default_missing_value = "")]
    meshes: Option<String>,
    /// Points per cell an axis, e.g. --points 2,3,4; n, n + 1 and n + 2 without values
    #[arg(long, value_name = "N1,N2", num_args = 0..=1, default_missing_value = "")]
    points: Option<String>,
    /// Courant numbers or time steps, whichever the case has, e.g. --steps 0.5,0.25; three halvings without values
    #[arg(long, value_name = "V1,V2", num_args = 0..=1, default_missing_value = "")]
    steps: Option<String>,
    /// Vary a key instead, e.g. --vary boundary.base.coefficient=0.2,0.5 (repeatable)
    #[arg(long, value_name = "KEY=V1,V2", value_parser = variant::parse)]
    vary: Vec<Vec<Variant>>,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let (case, source) = args.case.read()?;
    let ladders = args.ladders.plans(&case).map_err(Failure::Input)?;
    let stem = args.case.case.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{stem}-converge")));
    let write = |e: std::io::Error| Failure::io(&out.display().to_string(), &e);
    let _lock = folder::claim(&out).map_err(write)?;
    let plan = Plan {
        name: source.path.clone(),
        text: source.text.clone(),
        overrides: source.overrides.clone(),
        variants: args.ladders.variants(),
        ladders,
        quantities: args.quantity.clone(),
        draws: draws(args, &case).map_err(Failure::Input)?,
        max_memory: args.case.max_memory,
        threads: args.jobs.unwrap_or(0),
        limits: Limits { interrupt: Some(interrupt::flag()), time_limit: None },
    };
    let study = converge::converge(&plan, &runs_bar(false)).map_err(Failure::Input)?;
    let json = serde_json::to_string_pretty(&study).map_err(|e| write(e.into()))?;
    folder::write_text(&out.join("converge.json"), &(json.clone() + "\n")).map_err(write)?;
    converge::draw(&out, &case, &study).map_err(write)?;
    let table = || format!("{}left in {}\n", converge::table(&study), out.display());
    print(&if args.json { json + "\n" } else { table() })?;
    if interrupt::flag().load(std::sync::atomic::Ordering::Relaxed) {
        return Err(Failure::Interrupted("the runs were cut short; what they had is in the table".to_owned()));
    }
    let failed: usize = study.rows.iter().map(|r| r.failed).sum();
    if failed > 0 { Err(Failure::Partly(format!("{failed} runs failed"))) } else { Ok(()) }
}

fn draws(args: &Args, case: &Case) -> Result<Draws, String> {
    if let Some(runs) = args.realisations {
        return Ok(Draws::Realisations { runs: runs as usize });
    }
    let has_strength = case.material.values().any(Material::yields);
    match args.runs.unwrap_or(if has_strength { RUNS } else { 1 }) {
        1 => Ok(Draws::Single),
        _ if !has_strength => Err("--runs: no soil of the case has a strength to jitter; leave it out".to_owned()),
        runs => Ok(Draws::Jittered { runs: runs as usize, jitter: args.jitter }),
    }
}

impl Ladders {
    /// The case as it is and each key with each value, where keys are varied.
    fn variants(&self) -> Vec<Variant> {
        let varied = self.vary.iter().flatten().cloned();
        if self.vary.is_empty() { Vec::new() } else { std::iter::once(Variant::base()).chain(varied).collect() }
    }

    fn plans(&self, case: &Case) -> Result<Vec<LadderPlan>, String> {
        let wishes = [(Axis::Mesh, &self.meshes), (Axis::Points, &self.points), (Axis::TimeStep, &self.steps)];
        if wishes.iter().any(|(_, wish)| wish.is_some()) || !self.vary.is_empty() {
            return wishes.iter().filter_map(|(axis, wish)| Some(plan(*axis, wish.as_ref()?, case))).collect();
        }
        // a case whose time step is chosen by an error has none to refine; the study says so
        Ok(converge::paper(case).into_iter().chain(Axis::TimeStep.usual(case)).collect())
    }
}

/// A ladder with values `V1,V2,...`, or the usual one where there is none.
fn plan(axis: Axis, values: &str, case: &Case) -> Result<LadderPlan, String> {
    if values.is_empty() {
        return axis.usual(case);
    }
    let levels = values.split(',').map(|value| axis.level(case, value.trim())).collect();
    Ok(LadderPlan { axis, levels })
}
