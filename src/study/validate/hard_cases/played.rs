//! A case played to its end, whatever the end is.

use super::super::{remedy::Bench, setup::MEMORY};
use crate::{
    case::{self, Case},
    fault::FaultKind,
    run::{self, Blind, Limits, Outcome, Status},
    scene::{self, Scene},
    sim::Simulation,
    snapshot::Snapshot,
    work::Work,
};

/// A run that is over.
pub(super) struct Played {
    pub outcome: Outcome,
    pub state: Snapshot,
    pub work: Work,
    /// Share of the time.
    pub share: f64,
}

impl Played {
    /// A case file with some keys set.
    pub fn of(text: &str, set: &[String]) -> Result<Self, String> {
        let (case, _) = case::read("case.toml", text, set).map_err(|e| e.to_string())?;
        let scene = scene::build(&case, MEMORY).map_err(|e| e.to_string())?;
        Self::to_the_end(&case, scene)
    }

    /// A scene of a case.
    pub fn to_the_end(case: &Case, mut scene: Scene) -> Result<Self, String> {
        let outcome = run::run(case, &mut scene, Limits::NONE, &mut Blind).map_err(|e| e.to_string())?;
        let Simulation { work, .. } = &scene.simulation;
        let (state, work) = (scene.simulation.snapshot(), work.clone());
        Ok(Played { share: outcome.time / case.end.time, state, work, outcome })
    }

    /// Rows on how it ended, and a note.
    pub fn rows(&self, name: &str, bench: &mut Bench<'_>) -> Result<(), String> {
        bench.report.count_work(&self.work);
        bench.judge("clear", name, f64::from(u8::from(self.is_clear())))?;
        bench.judge("wrong", name, self.wrong() as f64)?;
        bench.judge("reached", name, self.share)?;
        bench.report.note(format!("{name}: {}", self.outcome.message));
        Ok(())
    }

    /// Whether it came to its end, or stopped with a cause that is known before a number is lost.
    pub fn is_clear(&self) -> bool {
        match self.outcome.status {
            Status::EndTime | Status::AtRest | Status::SlopeFailed => true,
            Status::Failed => self.outcome.fault.as_ref().is_some_and(|f| f.kind != FaultKind::NonFinite),
            Status::Interrupted | Status::ResourceCap => false,
        }
    }

    /// Numbers of the state that are not finite.
    pub fn wrong(&self) -> usize {
        let s = &self.state;
        let vectors = s.position.iter().chain(&s.velocity).flatten().copied();
        let stresses = s.stress.iter().flat_map(|s| [s.xx, s.yy, s.zz, s.xy]);
        vectors.chain(stresses).chain(s.jacobian.iter().copied()).filter(|v| !v.is_finite()).count()
    }
}
