//! `rmpm solve`.

use std::{
    collections::BTreeMap,
    path::PathBuf,
    time::{Duration, Instant},
};

use super::{Failure, exit::print, input::CaseArgs, interrupt, progress::Progress, summary};
use crate::{
    case::Case,
    math::simd::FpPath,
    output::{
        folder::{self, Folder},
        pictures,
        record::{Record, Timing, cpu_seconds, peak_memory, record},
    },
    run::{self, Limits, Observer, Sample},
    scene::Scene,
    snapshot::Snapshot,
    study::{
        strength_reduction::{self, NoFactor, Trial},
        workers,
    },
};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    case: CaseArgs,
    /// Folder for the results; out/<name of the case> without it
    #[arg(long, short)]
    out: Option<PathBuf>,
    /// Print {record, timing} as JSON on standard output, and nothing else there
    #[arg(long)]
    json: bool,
    /// Stop after this much wall time (s), keeping what was done
    #[arg(long, value_name = "SECONDS")]
    time_limit: Option<f64>,
    /// Threads on which each explicit step is shared (0: one a core); the results do not depend on it. Bodies below 16,384
    /// points, the implicit scheme, XPIC and b_bar take one
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Do not write frames (nor the pictures drawn from them)
    #[arg(long)]
    no_frames: bool,
    /// No progress bar
    #[arg(long, short)]
    quiet: bool,
}

/// Writes to the folder and shows the progress.
struct Watch {
    folder: Folder,
    progress: Progress,
}

impl Observer for Watch {
    fn sample(&mut self, sample: &Sample) -> std::io::Result<()> {
        self.progress.show(sample);
        self.folder.sample(sample)
    }

    fn frame(&mut self, snapshot: &Snapshot) -> std::io::Result<()> {
        self.folder.frame(snapshot)
    }

    fn wants_frames(&self) -> bool {
        self.folder.wants_frames()
    }
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let input = &args.case;
    let time_limit = args.time_limit.map(limit).transpose()?;
    let (case, source) = input.read()?;
    let out = args.out.clone().unwrap_or_else(|| default_out(input));
    let write = |e: std::io::Error| Failure::io(&out.display().to_string(), &e);
    // a folder that may not be taken is told before a search that may take hours
    drop(case.strength_reduction.map(|_| folder::claim(&out)).transpose().map_err(write)?);
    let mut phases = BTreeMap::new();
    let started = Instant::now();
    let (safety, factor) = search(&case, input.max_memory, time_limit, args.quiet)?.unzip();
    let mut scene = input.build_reduced(&case, factor.unwrap_or(1.0))?;
    let threads = share(&mut scene, args.threads)?;
    phases.insert("setup".to_owned(), started.elapsed().as_secs_f64());
    let folder = Folder::open(&out, &case.to_toml(), !args.no_frames).map_err(write)?;
    let mut watch = Watch { folder, progress: Progress::new(case.end.time, args.quiet) };
    let limits = Limits { interrupt: Some(interrupt::flag()), time_limit };
    let (before, cpu_before) = (Instant::now(), cpu_seconds());
    let outcome = run::run(&case, &mut scene, limits, &mut watch).map_err(write)?;
    phases.insert("solve".to_owned(), before.elapsed().as_secs_f64());
    phases.extend(scene.simulation.phases().into_iter().map(|(name, s)| (format!("solve.{name}"), s)));
    let solve_cpu = cpu_seconds().zip(cpu_before).map(|(b, a)| b - a);
    watch.progress.done();
    let mut record = record(&case, &source, &scene, &outcome);
    record.strength_reduction = safety;
    let drawn = finish(&case, &mut watch.folder, &record, &mut phases).map_err(write)?;
    let timing = timing(&record, &scene, started, phases, solve_cpu, threads);
    watch.folder.write_json("timing.json", &timing).map_err(write)?;
    say(args, &record, &timing, &out.display().to_string())?;
    drawn.map_err(write)?;
    // a search has found what it looked for: a run that fails
    let failure = Failure::of(outcome.status, &outcome.message);
    failure.filter(|_| strength_reduction::has_failed(&outcome) != Some(true) || factor.is_none()).map_or(Ok(()), Err)
}

/// Puts the steps on the threads asked for; how many of them find work.
fn share(scene: &mut Scene, wanted: usize) -> Result<usize, Failure> {
    let wanted = workers::count(wanted);
    let threads =
        scene.simulation.share(wanted).map_err(|e| Failure::Solver(format!("a thread cannot be started: {e}")))?;
    if threads < wanted {
        eprintln!("--threads {wanted}: the steps of this run can be shared by {threads}");
    }
    Ok(threads)
}

/// The search for the factor of safety, where the case asks for it, and the factor of the run that is left in
/// the folder: the least that failed. The time limit holds for each run.
fn search(
    case: &Case,
    max_memory: u64,
    time_limit: Option<Duration>,
    quiet: bool,
) -> Result<Option<(serde_json::Value, f64)>, Failure> {
    if case.strength_reduction.is_none() {
        return Ok(None);
    }
    let limits = Limits { interrupt: Some(interrupt::flag()), time_limit };
    let told = |t: &Trial| {
        if !quiet {
            eprintln!("strength / {:.4}: {}", t.factor, if t.failed { "fails" } else { "stands" });
        }
    };
    let safety = strength_reduction::find(case, max_memory, limits, told).map_err(|e| match e {
        NoFactor::Input(text) => Failure::Input(text),
        NoFactor::TooLarge(text) => Failure::Cap(text),
        NoFactor::Trial { status, message } => Failure::of(status, &message).unwrap_or(Failure::Solver(message)),
    })?;
    let value = serde_json::to_value(&safety).map_err(|e| Failure::Solver(e.to_string()))?;
    Ok(Some((value, safety.bracket[1])))
}

fn limit(seconds: f64) -> Result<Duration, Failure> {
    Duration::try_from_secs_f64(seconds).map_err(|_| Failure::Input(format!("--time-limit {seconds} is no time")))
}

fn default_out(input: &CaseArgs) -> PathBuf {
    PathBuf::from("out").join(input.case.file_stem().unwrap_or_default())
}

/// Record first, so that nothing that goes wrong later can lose it; then the pictures, whose
/// failure is handed on inside.
fn finish(
    case: &Case,
    folder: &mut Folder,
    record: &Record,
    phases: &mut BTreeMap<String, f64>,
) -> std::io::Result<std::io::Result<()>> {
    folder.history.flush()?;
    folder.write_json("record.json", record)?;
    let before = Instant::now();
    let drawn =
        pictures::draw(folder.path(), case, &folder.history.rows, folder.frames(), record.measures.onset_time_s);
    phases.insert("pictures".to_owned(), before.elapsed().as_secs_f64());
    Ok(drawn)
}

fn timing(
    record: &Record,
    scene: &Scene,
    started: Instant,
    by_phase: BTreeMap<String, f64>,
    solve_cpu: Option<f64>,
    threads: usize,
) -> Timing {
    Timing {
        wall_s: started.elapsed().as_secs_f64(),
        cpu_s: cpu_seconds(),
        by_phase,
        threads,
        peak_memory_bytes: peak_memory(),
        bytes_per_point: scene.simulation.body.bytes_per_point(),
        particle_steps_per_cpu_s: solve_cpu.filter(|c| *c > 0.0).map(|c| record.work.particle_steps as f64 / c),
        instruction_path: FpPath::best().to_string(),
    }
}

fn say(args: &Args, record: &Record, timing: &Timing, out: &str) -> Result<(), Failure> {
    if args.json {
        print(&format!("{}\n", serde_json::json!({ "record": record, "timing": timing })))
    } else {
        print(&summary::text(record, timing, out))
    }
}
