//! Loads beyond what a body bears: the run ends clearly, whatever becomes of the body.

use super::{Effort, Files, Problem, Report, measure::mean, reference::Reference, setup::keys};
use crate::{
    case,
    run::{self, Blind, Limits, Outcome, Status},
    scene,
    sim::Simulation,
    snapshot::Snapshot,
};

/// See the module.
pub struct HardCases;

/// Memory that a run may take (bytes).
const MEMORY: u64 = 1 << 30;

const BAR: &str = include_str!("../../../validation/hard-cases/bar.toml");

/// Shape functions, and points an axis and cell, of the pulled bars.
const BARS: [(&str, u32); 6] =
    [("linear", 2), ("gimp", 2), ("gimp_wide", 2), ("linear", 4), ("gimp", 4), ("gimp_wide", 4)];

impl Problem for HardCases {
    fn name(&self) -> &'static str {
        "hard-cases"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/hard-cases/case.toml"),
            reference: include_str!("../../../validation/hard-cases/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        self.crush(effort, reference, report)?;
        let bars = if effort == Effort::Full { &BARS[..] } else { &BARS[..3] };
        for regime in ["quasi_static", "backward_euler"] {
            for (shape, points) in bars {
                self.pull(regime, shape, *points, reference, report)?;
            }
        }
        Ok(())
    }
}

impl HardCases {
    /// Twenty times gravity, without inertia and with it.
    fn crush(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let regimes: &[&str] = match effort {
            Effort::Short => &["quasi_static", "auto"],
            Effort::Full => &["quasi_static", "auto", "newmark", "hht", "backward_euler"],
        };
        for regime in regimes {
            let end = End::of(self.files().case, &[("implicit.regime", (*regime).to_owned())])?;
            end.rows(&format!("20 g, {regime}"), reference, report)?;
        }
        let end = End::of(self.files().case, &[("solver.scheme", "explicit".to_owned())])?;
        end.rows("20 g, explicit", reference, report)
    }

    fn pull(
        &self,
        regime: &str,
        shape: &str,
        points: u32,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        let set = [
            ("implicit.regime", regime.to_owned()),
            ("solver.shape", shape.to_owned()),
            ("points.per_axis", points.to_string()),
        ];
        let end = End::of(BAR, &set)?;
        let name = format!("bar to 3 l, {regime}, {shape}, {points} x {points} points");
        end.rows(&name, reference, report)?;
        let free: Vec<usize> = (0..end.state.len()).filter(|&i| end.state.reference[i][0] < FREE).collect();
        report.row_of(reference, "stretch", &name, None, 1.0 + end.outcome.time / GRIP)?;
        // nu = 0: J is the stretch along the bar
        report.row_of(reference, "points", &name, None, mean(free.iter().map(|&i| end.state.jacobian[i])))
    }
}

/// Place of the grip at the start (m), and up to where the bar is looked at: the cells next to the grip
/// are pulled by nodes that it holds.
const GRIP: f64 = 10.0;
const FREE: f64 = 8.0;

/// A run that is over.
struct End {
    outcome: Outcome,
    state: Snapshot,
    share: f64,
    particle_steps: u64,
}

impl End {
    fn of(text: &str, set: &[(&str, String)]) -> Result<Self, String> {
        let (case, _) = case::read("case.toml", text, &keys(set)).map_err(|e| e.to_string())?;
        let mut scene = scene::build(&case, MEMORY).map_err(|e| e.to_string())?;
        let outcome = run::run(&case, &mut scene, Limits::NONE, &mut Blind).map_err(|e| e.to_string())?;
        let Simulation { work, .. } = &scene.simulation;
        Ok(End {
            share: outcome.time / case.end.time,
            state: scene.simulation.snapshot(),
            particle_steps: work.particle_steps,
            outcome,
        })
    }

    fn rows(&self, name: &str, reference: &Reference, report: &mut Report) -> Result<(), String> {
        report.particle_steps += self.particle_steps;
        report.row_of(reference, "clear", name, None, f64::from(u8::from(self.is_clear())))?;
        report.row_of(reference, "wrong", name, None, self.wrong() as f64)?;
        report.row_of(reference, "reached", name, None, self.share)?;
        report.note(format!("{name}: {}", self.outcome.message));
        Ok(())
    }

    fn is_clear(&self) -> bool {
        match self.outcome.status {
            Status::EndTime | Status::AtRest | Status::SlopeFailed => true,
            Status::Failed => self.outcome.fault.is_some(),
            Status::Interrupted | Status::ResourceCap => false,
        }
    }

    /// Numbers of the state that are not finite.
    fn wrong(&self) -> usize {
        let s = &self.state;
        let vectors = s.position.iter().chain(&s.velocity).flatten().copied();
        let stresses = s.stress.iter().flat_map(|s| [s.xx, s.yy, s.zz, s.xy]);
        vectors.chain(stresses).chain(s.jacobian.iter().copied()).filter(|v| !v.is_finite()).count()
    }
}
