//! `rmpm study` and `rmpm compare rfem`: ensembles of one case side by side, each with some keys
//! changed, and RFEM beside RMPM on the same random fields.

mod figures;
mod pairs;
mod picture;
mod remarks;
mod report;

pub use figures::Figures;
pub use pairs::Pairs;
pub use picture::draw;
pub use report::{markdown, table};

use std::{path::Path, time::Instant};

use serde::Serialize;

use super::ensemble::{self, Conduct, Ended, Problem, Shard, Start, Watch};
use crate::{
    case::{self, Arm, Case, Study},
    output::{
        folder::{claim, write_text},
        record::{Build, SCHEMA_VERSION},
    },
};

/// The keys that turn a case into RFEM: small strain on the fixed mesh of the same cells, points at
/// their Gauss positions, the same strengths, base and gravity; equilibrium up to the onset of failure,
/// then backward Euler until the slide is plain.
pub const RFEM: [&str; 8] = [
    "solver.scheme=implicit",
    "solver.kinematics=small",
    "solver.locking=b_bar",
    "implicit.regime=auto",
    "implicit.inertia=backward_euler",
    "implicit.time_step=0.05",
    "implicit.min_time_step=0.005",
    "implicit.residual=1e-6",
];

/// What is run, and how.
#[derive(Clone, Debug)]
pub struct Plan {
    pub study: Study,
    /// Name and text of the case file.
    pub name: String,
    pub text: String,
    /// Realisations of all arms, in place of those of the study.
    pub realisations: Option<u64>,
    pub conduct: Conduct,
}

/// An arm that has been run.
pub struct Ran {
    pub arm: Arm,
    pub case: Case,
    pub rmpm: Ended,
    pub rfem: Option<Ended>,
}

/// The study, as `study.json` holds it.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    pub schema_version: u32,
    pub build: Build,
    pub title: String,
    pub case: String,
    pub arms: Vec<ArmReport>,
    /// What the figures say and do not say, in plain words.
    pub remarks: Vec<String>,
}

/// One arm in figures.
#[derive(Clone, Debug, Serialize)]
pub struct ArmReport {
    #[serde(flatten)]
    pub arm: Arm,
    pub folder: String,
    pub rmpm: Figures,
    pub rfem: Option<Figures>,
    pub pairs: Option<Pairs>,
}

/// Is told how many of how many draws are done.
pub type Progress = Box<dyn Fn(usize, usize)>;

/// Who is told how a study goes.
pub struct Viewer<'a> {
    /// An ensemble begins, by its name.
    pub begin: &'a dyn Fn(&str) -> Progress,
    /// What the user should know at once.
    pub note: &'a dyn Fn(&str),
}

/// Runs the arms one after another, each on all threads. What is done is kept, so that an interrupted study
/// can be gone on with; the arms after an interrupt are left out of the result.
///
/// # Errors
/// A case or a change that cannot be read or built, a folder that may not be taken, before anything is run;
/// those of the ensembles.
pub fn study(plan: &Plan, out: &Path, viewer: &Viewer) -> Result<Vec<Ran>, Problem> {
    let arms = &plan.study.arms;
    let cases = arms.iter().map(|arm| cases(plan, arm)).collect::<Result<Vec<_>, _>>()?;
    ready(plan, &cases, out)?;
    let began = Instant::now();
    let (mut plan, limit) = (plan.clone(), plan.conduct.time_limit);
    let mut run = |arm: &Arm, case: &Case, label: &str, folder: String| {
        // the limit is that of the study
        plan.conduct.time_limit = limit.map(|limit| limit.saturating_sub(began.elapsed()));
        run(&plan, arm, case, label, &out.join(folder), viewer)
    };
    let mut done = Vec::new();
    for (arm, (case, rfem_case)) in arms.iter().zip(cases) {
        let rmpm = run(arm, &case, &arm.name, arm.folder())?;
        let whole = rmpm.results.complete();
        let rfem =
            rfem_case.filter(|_| whole).map(|case| run(arm, &case, &format!("{}, RFEM", arm.name), arm.rfem_folder()));
        let rfem = rfem.transpose()?;
        let whole = whole && rfem.as_ref().is_none_or(|e| e.results.complete());
        done.push(Ran { arm: arm.clone(), case, rmpm, rfem });
        if !whole {
            break;
        }
    }
    Ok(done)
}

/// The case of an arm, and that of RFEM beside it.
fn cases(plan: &Plan, arm: &Arm) -> Result<(Case, Option<Case>), Problem> {
    let own: Vec<String> = plan.study.set.iter().chain(&arm.set).cloned().collect();
    let read = |more: &[&str]| {
        let sets: Vec<String> = own.iter().cloned().chain(more.iter().map(|s| (*s).to_owned())).collect();
        let refused = |e: case::Diagnostics| Problem::Refused(format!("arm \"{}\":\n{}", arm.name, e.render(false)));
        case::read(&plan.name, &plan.text, &sets).map(|(case, _)| case).map_err(refused)
    };
    Ok((read(&[])?, if arm.rfem { Some(read(&RFEM)?) } else { None }))
}

/// Looks at all ensembles before the first is run: one that cannot be built, or whose folder may not be taken,
/// must not be found after hours; and a study that was begun must not lose what it has.
fn ready(plan: &Plan, cases: &[(Case, Option<Case>)], out: &Path) -> Result<(), Problem> {
    let (mut held, mut of) = (0, 0);
    for (arm, (case, rfem)) in plan.study.arms.iter().zip(cases) {
        let both = std::iter::once((case, arm.folder())).chain(rfem.as_ref().map(|case| (case, arm.rfem_folder())));
        for (case, folder) in both {
            if case.slide.is_none() {
                let text = "a study compares sliding distances: add the table `slide` to the case".to_owned();
                return Err(named(arm, Problem::Refused(text)));
            }
            let found = ensemble::ready(&single(plan, arm, case), &out.join(folder)).map_err(|e| named(arm, e))?;
            held += usize::from(found);
            of += 1;
        }
    }
    if plan.conduct.start == Start::New && 0 < held && held < of {
        let text = format!(
            "'{}' holds {held} of {of} ensembles of a study: go on with --resume, or start over with --fresh",
            out.display()
        );
        return Err(Problem::Refused(text));
    }
    Ok(())
}

fn named(arm: &Arm, problem: Problem) -> Problem {
    match problem {
        Problem::Refused(text) => Problem::Refused(format!("arm \"{}\": {text}", arm.name)),
        Problem::TooLarge(text) => Problem::TooLarge(format!("arm \"{}\": {text}", arm.name)),
        Problem::Io(error) => Problem::Io(error),
    }
}

fn run(plan: &Plan, arm: &Arm, case: &Case, label: &str, out: &Path, viewer: &Viewer) -> Result<Ended, Problem> {
    let _lock = claim(out)?;
    let progress = (viewer.begin)(label);
    ensemble::ensemble(&single(plan, arm, case), out, &Watch { progress: &progress, note: viewer.note })
}

/// The ensemble of an arm.
fn single(plan: &Plan, arm: &Arm, case: &Case) -> ensemble::Plan {
    let realisations = plan.realisations.or(arm.realisations).or(plan.study.realisations);
    ensemble::Plan {
        case: case.clone(),
        first: 0,
        realisations: realisations.unwrap_or(case.ensemble.realisations),
        shard: Shard::WHOLE,
        conduct: plan.conduct,
    }
}

/// The study in figures.
pub fn report(plan: &Plan, ran: &[Ran]) -> Report {
    let arms: Vec<ArmReport> = ran.iter().map(arm_report).collect();
    Report {
        schema_version: SCHEMA_VERSION,
        build: Build::current(),
        title: plan.study.title.clone(),
        case: plan.name.clone(),
        remarks: remarks::remarks(&arms),
        arms,
    }
}

fn arm_report(ran: &Ran) -> ArmReport {
    ArmReport {
        arm: ran.arm.clone(),
        folder: ran.arm.folder(),
        rmpm: Figures::of(&ran.rmpm),
        rfem: ran.rfem.as_ref().map(Figures::of),
        pairs: ran.rfem.as_ref().map(|rfem| Pairs::of(&ran.rmpm, rfem)),
    }
}

/// Writes `study.json`, the pairs of each arm with RFEM, and the report.
///
/// # Errors
/// Those of the file system.
pub fn write(out: &Path, report: &Report) -> std::io::Result<()> {
    let json = serde_json::to_string_pretty(report).map_err(std::io::Error::other)?;
    write_text(&out.join("study.json"), &(json + "\n"))?;
    for arm in &report.arms {
        if let Some(pairs) = &arm.pairs {
            write_text(&out.join(format!("{}-pairs.csv", arm.folder)), &pairs.csv())?;
        }
    }
    write_text(&out.join("report.md"), &markdown(report))
}
