//! What one draw came to.

use std::{
    collections::BTreeMap,
    panic::{AssertUnwindSafe, catch_unwind},
    time::Instant,
};

use serde::{Deserialize, Serialize};

use super::{
    measures::{self, Measure},
    realise::{Draw, partner, realise},
};
use crate::{
    case::Case,
    run::{self, Blind, Limits, Outcome, Status},
    scene::{self, FieldNote, Fields, Scene, SceneError},
    study::clock,
    work::Work,
};

/// The result of a draw. It depends on the case alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub realisation: Draw,
    /// The realisation with the opposite numbers.
    pub antithetic: Option<u64>,
    pub status: Status,
    /// Why it failed.
    pub fault: Option<String>,
    /// Measures by name; absent where one is not defined, or the run failed.
    pub measures: BTreeMap<String, f64>,
    /// Counters of work by name.
    pub work: BTreeMap<String, f64>,
}

/// What it took. It depends on the machine and the hour.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    pub cpu_s: Option<f64>,
    pub wall_s: f64,
    /// Number of the worker, from 0.
    pub worker: usize,
}

/// A draw that is done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Done {
    pub row: Row,
    pub cost: Cost,
}

impl Row {
    /// A measure of a run that did not fail.
    pub fn measure(&self, name: &str) -> Option<f64> {
        self.measures.get(name).copied()
    }

    fn failed(case: &Case, realisation: Draw, fault: String) -> Self {
        Row {
            realisation,
            antithetic: realisation.and_then(|k| partner(case, k)),
            status: Status::Failed,
            fault: Some(fault),
            measures: BTreeMap::new(),
            work: BTreeMap::new(),
        }
    }

    fn new(case: &Case, realisation: Draw, measures: &[Measure], outcome: &Outcome, scene: &Scene) -> Self {
        let sound = outcome.fault.is_none();
        // what a run had when it failed is no result
        let value = |m: &Measure| m.of(outcome).filter(|_| sound).map(|v| (m.name.clone(), v));
        Row {
            status: outcome.status,
            fault: outcome.fault.as_ref().map(|fault| fault.to_string()),
            measures: measures.iter().filter_map(value).collect(),
            work: counters(&scene.simulation.work, &scene.fields),
            ..Row::failed(case, realisation, String::new())
        }
    }
}

/// Counters by name, and what was done to the cells of the fields; one that is no finite number is left out.
pub fn counters(work: &Work, fields: &[FieldNote]) -> BTreeMap<String, f64> {
    let Ok(serde_json::Value::Object(map)) = serde_json::to_value(work) else { return BTreeMap::new() };
    let sum = |of: fn(&FieldNote) -> u64| fields.iter().map(of).sum::<u64>() as f64;
    let cells = [("floored_cells", sum(|f| f.counts.floored)), ("redrawn_fields", sum(|f| f.counts.redrawn))];
    let cells = cells.map(|(name, count)| (name.to_owned(), count));
    map.into_iter().filter_map(|(name, value)| Some((name, value.as_f64()?))).chain(cells).collect()
}

/// What all draws of an ensemble share.
pub struct Realiser<'a> {
    case: &'a Case,
    measures: Vec<Measure>,
    /// The generators of the fields, and those at the mean.
    fields: [Fields; 2],
    max_memory: u64,
    limits: Limits<'a>,
}

impl<'a> Realiser<'a> {
    /// Makes the generators of the random fields.
    ///
    /// # Errors
    /// A field that cannot be made.
    pub fn new(case: &'a Case, max_memory: u64, limits: Limits<'a>) -> Result<Self, SceneError> {
        let fields = [Fields::of(case)?, Fields::of(&realise(case, None))?];
        Ok(Realiser { case, measures: measures::list(case), fields, max_memory, limits })
    }

    /// The scene of a draw.
    ///
    /// # Errors
    /// One that cannot be built.
    pub fn scene(&self, draw: Draw) -> Result<(Case, Scene), SceneError> {
        let case = realise(self.case, draw);
        let fields = &self.fields[usize::from(draw.is_none())];
        let scene = scene::build_with(&case, self.max_memory, fields)?;
        Ok((case, scene))
    }

    /// Runs one draw. A scene that cannot be built, a fault and a panic all become rows with their
    /// reasons; `None`: it was abandoned.
    pub fn run(&self, draw: Draw, worker: usize) -> Option<Done> {
        let (started, before) = (Instant::now(), clock::thread_seconds());
        let row = guarded(|| self.solve(draw)).unwrap_or_else(|fault| Row::failed(self.case, draw, fault));
        let cpu_s = clock::thread_seconds().zip(before).map(|(b, a)| b - a);
        let cost = Cost { cpu_s, wall_s: started.elapsed().as_secs_f64(), worker };
        (row.status != Status::Interrupted).then_some(Done { row, cost })
    }

    fn solve(&self, draw: Draw) -> Result<Row, String> {
        let (case, mut scene) = self.scene(draw).map_err(|e| e.to_string())?;
        let outcome = run::run(&case, &mut scene, self.limits, &mut Blind).map_err(|e| e.to_string())?;
        Ok(Row::new(self.case, draw, &self.measures, &outcome, &scene))
    }
}

/// A panic as an error: a bug in one realisation must not take the others along.
fn guarded<R>(work: impl FnOnce() -> Result<R, String>) -> Result<R, String> {
    // nothing of a broken run is used again, so it may be left in any state
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| {
        let text = payload.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("no message");
        Err(format!("a bug in rmpm (panic): {text}"))
    })
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A realisation at rest with one measure.
    pub fn done_with(k: u64, name: &str, value: f64) -> Done {
        let row = Row {
            realisation: Some(k),
            antithetic: None,
            status: Status::AtRest,
            fault: None,
            measures: BTreeMap::from([(name.to_owned(), value)]),
            work: counters(&Work { steps: 10 + k, ..Work::default() }, &[]),
        };
        Done { row, cost: Cost { cpu_s: Some(0.5), wall_s: 0.6, worker: 1 } }
    }

    #[test]
    fn a_panic_becomes_a_reason() {
        assert_eq!(guarded(|| Ok(3)), Ok(3));
        let index = 7;
        let found = guarded::<u8>(|| panic!("index {index}"));
        assert_eq!(found, Err("a bug in rmpm (panic): index 7".to_owned()));
        assert!(guarded::<u8>(|| panic!("plain")).is_err_and(|text| text.ends_with("plain")));
    }

    #[test]
    fn counters_have_the_names_of_the_record() {
        let work = Work { steps: 12, max_solve_residual: f64::NAN, ..Work::default() };
        let map = counters(&work, &[]);
        assert_eq!(map.get("steps"), Some(&12.0));
        assert!(map.contains_key("particle_steps") && !map.contains_key("max_solve_residual"));
    }
}
