//! `rmpm converge`.

use std::path::{Path, PathBuf};

use super::{Failure, exit::print, input::CaseArgs, interrupt, progress::runs_bar};
use crate::{
    case::Case,
    output::{
        folder, pictures,
        plot::{self, AxisSpec, FieldKind, Interval, IntervalPlot},
    },
    run::Limits,
    snapshot::Snapshot,
    study::{
        converge::{self, Plan, Study, typical},
        variant::{self, Variant},
    },
};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    case: CaseArgs,
    /// Folder for table and pictures; out/<name of the case>-converge without it
    #[arg(long, short)]
    out: Option<PathBuf>,
    /// Jittered runs a variant
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    /// Largest relative change of strength between runs
    #[arg(long, default_value_t = 0.0005)]
    jitter: f64,
    /// Vary a key instead of mesh and points, e.g. --vary boundary.base.coefficient=0.2,0.5 (repeatable)
    #[arg(long, value_name = "KEY=V1,V2", value_parser = variant::parse)]
    vary: Vec<Vec<Variant>>,
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
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{stem}-converge")));
    let write = |e: std::io::Error| Failure::io(&out.display().to_string(), &e);
    let _lock = folder::claim(&out).map_err(write)?;
    let plan = Plan {
        name: source.path.clone(),
        text: source.text.clone(),
        overrides: source.overrides.clone(),
        variants: variants(&args.vary, &case),
        runs: args.runs as usize,
        jitter: args.jitter,
        max_memory: args.case.max_memory,
        threads: args.jobs.unwrap_or(0),
        limits: Limits { interrupt: Some(interrupt::flag()), time_limit: None },
    };
    let study = converge::converge(&plan, &runs_bar(false)).map_err(Failure::Input)?;
    let json = serde_json::to_string_pretty(&study).map_err(|e| write(e.into()))?;
    folder::write_text(&out.join("converge.json"), &(json.clone() + "\n")).map_err(write)?;
    draw(&out, &case, &study).map_err(write)?;
    let table = || format!("{}left in {}\n", converge::table(&study), out.display());
    print(&if args.json { json + "\n" } else { table() })?;
    if interrupt::flag().load(std::sync::atomic::Ordering::Relaxed) {
        return Err(Failure::Interrupted("the runs were cut short; what they had is in the table".to_owned()));
    }
    let failed: usize = study.rows.iter().map(|r| r.failed).sum();
    if failed > 0 { Err(Failure::Partly(format!("{failed} runs failed"))) } else { Ok(()) }
}

fn variants(vary: &[Vec<Variant>], case: &Case) -> Vec<Variant> {
    if vary.is_empty() {
        return converge::usual_variants(case.grid.cell, case.points.per_axis);
    }
    std::iter::once(Variant::base()).chain(vary.iter().flatten().cloned()).collect()
}

fn draw(out: &Path, case: &Case, study: &Study) -> std::io::Result<()> {
    plot::intervals(&out.join("converge.png"), &intervals(study))?;
    let shown: Vec<(String, &Snapshot)> = study
        .rows
        .iter()
        .filter_map(|row| {
            let run = typical(row)?;
            let r = run.sliding_distance_m.map(|r| format!(", r = {r:.2} m")).unwrap_or_default();
            Some((format!("{}: the run nearest to the median{r}", row.variant), run.snapshot.as_ref()?))
        })
        .collect();
    let kind =
        if crate::run::residual_strain(case).is_some() { FieldKind::PlasticStrain } else { FieldKind::Displacement };
    let mut options = pictures::options(case, kind);
    options.range = pictures::range(case, kind);
    options.captions = shown.iter().map(|(caption, _)| caption.clone()).collect();
    let views: Vec<&Snapshot> = shown.iter().map(|(_, s)| *s).collect();
    plot::field(&out.join("shapes.png"), &views, &options)
}

fn intervals(study: &Study) -> IntervalPlot {
    let has_slide = study.rows.iter().any(|r| r.sliding_distance_m.is_some());
    let item = |row: &converge::Row| {
        let s = if has_slide { row.sliding_distance_m } else { row.runout_m };
        let pick = |r: &converge::Run| if has_slide { r.sliding_distance_m } else { Some(r.runout_m) };
        Interval {
            label: row.variant.clone(),
            low: s.map_or(f64::NAN, |s| s.lower_quartile),
            median: s.map_or(f64::NAN, |s| s.median),
            high: s.map_or(f64::NAN, |s| s.upper_quartile),
            values: row.runs.iter().filter_map(pick).collect(),
        }
    };
    IntervalPlot {
        title: Some(format!("Median, quartiles and single runs; strength jittered by +-{} %", 100.0 * study.jitter)),
        x_label: "variant".to_owned(),
        y: AxisSpec::linear(if has_slide { "sliding distance r (m)" } else { "run-out (m)" }),
        items: study.rows.iter().map(item).collect(),
        ..IntervalPlot::default()
    }
}
