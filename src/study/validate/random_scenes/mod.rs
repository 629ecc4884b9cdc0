//! Random scenes: each ends at its end, or with an error that has a type; none panics, hangs, or yields what is no
//! number, and the guard on the energy speaks where energy was made.

mod draw;
mod outline;
mod text;

use std::{
    collections::BTreeMap,
    panic::{AssertUnwindSafe, catch_unwind},
    time::Duration,
};

use super::{Effort, Files, Problem, Report, reference::Reference};
use crate::{
    case,
    run::{self, Limits, Observer, Outcome, Sample, Status},
    scene,
    sim::{Energies, Simulation},
    study::workers,
    work::Work,
};

/// See the module.
pub struct RandomScenes;

/// Master seed of the scenes.
const SEED: u64 = 1;
/// Memory that a scene may take (bytes).
const MEMORY: u64 = 1 << 30;
/// Time that a scene may take: a few hundred steps of a few hundred points take less than a second.
const TIME: Duration = Duration::from_secs(60);
/// Share of the energy supplied that may be made without a word of the guard: five times its level, as the largest
/// supply is looked at at other times here.
const SILENT: f64 = 0.1;

impl Problem for RandomScenes {
    fn name(&self) -> &'static str {
        "random-scenes"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../../validation/random-scenes/case.toml"),
            reference: include_str!("../../../../validation/random-scenes/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let first = reference.given("first")? as u64;
        let key = if effort == Effort::Full { "scenes_full" } else { "scenes_short" };
        let numbers: Vec<u64> = (first..first + reference.given(key)? as u64).collect();
        let ends = workers::all(0, &numbers, &|_, _| {}, &|n| Ok(end_of(&text::scene(SEED, *n))))?;
        ends.iter().for_each(|end| report.count_work(&end.work));
        rows(&ends, reference, report)?;
        for (number, end) in numbers.iter().zip(&ends).filter(|(_, e)| e.wrong.is_some()) {
            let file = format!("scene-{number}.toml");
            report.note(format!("{file}: {} ({})", end.wrong.as_deref().unwrap_or_default(), end.how));
            report.files.insert(file, text::scene(SEED, *number));
        }
        Ok(())
    }
}

fn rows(ends: &[End], reference: &Reference, report: &mut Report) -> Result<(), String> {
    let count = |f: &dyn Fn(&End) -> bool| ends.iter().filter(|e| f(e)).count() as f64;
    report.row(reference, "scenes", ends.len() as f64)?;
    for key in ["panics", "not_finite", "silent", "too_long"] {
        report.row(reference, key, count(&|e| e.wrong_key() == Some(key)))?;
    }
    report.row(reference, "guard", count(&|e| e.guard_spoke))?;
    let mut hows = BTreeMap::new();
    ends.iter().for_each(|e| *hows.entry(e.how.as_str()).or_insert(0u32) += 1);
    hows.iter().try_for_each(|(how, n)| report.row_of(reference, "how", how, None, f64::from(*n)))?;
    let mut codes = BTreeMap::new();
    ends.iter().flat_map(|e| &e.warnings).for_each(|code| *codes.entry(code.as_str()).or_insert(0u32) += 1);
    codes.iter().try_for_each(|(code, n)| report.row_of(reference, "warning", code, None, f64::from(*n)))
}

/// What became of a scene.
#[derive(Clone, Debug, Default)]
struct End {
    /// In words: completed, refused, or the kind of the fault.
    how: String,
    warnings: Vec<String>,
    guard_spoke: bool,
    /// What must not be: the key of its row, and more words.
    wrong: Option<String>,
    work: Work,
}

impl End {
    fn new(how: impl Into<String>) -> Self {
        End { how: how.into(), ..End::default() }
    }

    fn wrong_key(&self) -> Option<&str> {
        self.wrong.as_deref().and_then(|w| w.split(':').next())
    }
}

/// Plays a scene; a panic is an end as well.
fn end_of(text: &str) -> End {
    catch_unwind(AssertUnwindSafe(|| play(text))).unwrap_or_else(|cause| {
        let words = cause.downcast_ref::<String>().map(String::as_str);
        let words = words.or(cause.downcast_ref::<&str>().copied()).unwrap_or("no message");
        End { wrong: Some(format!("panics: {words}")), ..End::new("panic") }
    })
}

fn play(text: &str) -> End {
    let case = match case::read("scene.toml", text, &[]) {
        Ok((case, _)) => case,
        Err(errors) => {
            let kind = errors.errors().first().map(|e| e.key.clone()).unwrap_or_default();
            return End::new(format!("refused by the reader: {}", without_numbers(&kind)));
        }
    };
    let mut scene = match scene::build(&case, MEMORY) {
        Ok(scene) => scene,
        Err(error) => return End::new(format!("refused by the scene: {}", without_numbers(&error.key))),
    };
    let mut watch = Supply(run::least_supply(&case, scene.simulation.initial_mass));
    let limits = Limits { interrupt: None, time_limit: Some(TIME) };
    match run::run(&case, &mut scene, limits, &mut watch) {
        Ok(outcome) => End {
            warnings: scene.warnings.iter().map(|w| w.code.clone()).collect(),
            ..judge(&scene.simulation, &outcome, &watch)
        },
        Err(error) => End::new(format!("input/output: {error}")),
    }
}

/// A key without the numbers of its items.
fn without_numbers(key: &str) -> String {
    key.chars().filter(|c| !c.is_ascii_digit()).collect()
}

fn judge(sim: &Simulation, outcome: &Outcome, watch: &Supply) -> End {
    let fault = outcome.fault.as_ref();
    let how = match (outcome.status, fault) {
        (Status::Failed, Some(fault)) => format!("{:?}", fault.kind),
        (status, _) => format!("{status:?}"),
    };
    let e = outcome.measures.energy_kj_per_m;
    let guard_spoke = outcome.drift.is_some() || fault.is_some_and(|f| f.kind == crate::fault::FaultKind::EnergyDrift);
    let wrong = if numbers(sim, &e).any(|v| !v.is_finite()) {
        Some("not_finite: in the last state or its energies".to_owned())
    } else if outcome.status == Status::ResourceCap {
        Some(format!("too_long: {} steps", sim.work.steps))
    } else if fault.is_none() && !guard_spoke && -e.numerical > SILENT * watch.0 {
        Some(format!("silent: {} kJ/m made of {} supplied", -e.numerical, e.external))
    } else {
        None
    };
    End { guard_spoke, wrong, work: sim.work.clone(), ..End::new(how) }
}

/// Every number of the last state and of its energies.
fn numbers(sim: &Simulation, e: &Energies) -> impl Iterator<Item = f64> {
    let s = sim.snapshot();
    let energies = [e.kinetic, e.strain, e.external, e.dissipated, e.numerical, e.transfer, e.impact, e.integrator];
    let vectors: Vec<f64> = s.position.iter().chain(&s.velocity).flatten().copied().collect();
    let stresses: Vec<f64> = s.stress.iter().flat_map(|s| s.to_array()).collect();
    vectors.into_iter().chain(stresses).chain(s.jacobian).chain(s.plastic_strain).chain(energies)
}

/// The largest energy supplied (kJ/m), by the rows of the history; no less than the guard takes.
struct Supply(f64);

impl Observer for Supply {
    fn sample(&mut self, sample: &Sample) -> std::io::Result<()> {
        self.0 = self.0.max(sample.energies.external.abs());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_the_same_each_time_and_another_number_another_scene() {
        assert_eq!(text::scene(1, 7), text::scene(1, 7));
        assert_ne!(text::scene(1, 7), text::scene(1, 8));
    }

    #[test]
    fn most_scenes_are_read_and_built() {
        let built = |n: &u64| {
            let (case, _) = case::read("scene.toml", &text::scene(1, *n), &[]).ok()?;
            scene::build(&case, MEMORY).ok()
        };
        let count = (0..60).filter(|n| built(n).is_some()).count();
        assert!(count >= 40, "{count} of 60");
    }

    #[test]
    fn what_is_wrong_with_a_run_is_told_by_its_row() {
        let end = End { wrong: Some("silent: much".to_owned()), ..End::new("EndTime") };
        assert_eq!((end.wrong_key(), End::new("EndTime").wrong_key()), (Some("silent"), None));
    }
}
