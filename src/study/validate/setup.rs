//! From the embedded case to a run, with a few keys changed.

use crate::{
    case::{self, Case},
    scene::{self, Addition},
    sim::Simulation,
    space::Grid,
};

/// A simulation of a problem, with what is asked about it again and again.
pub(super) struct Run {
    pub case: Case,
    pub grid: Grid,
    pub sim: Simulation,
}

/// Memory that a validation run may take (bytes); the largest takes a few megabytes.
pub(super) const MEMORY: u64 = 1 << 30;

impl Run {
    /// The scene of a case file with some keys set.
    pub fn new(text: &str, keys: &[String]) -> Result<Self, String> {
        Self::adding(text, keys, &|_| Vec::new())
    }

    /// As [`Run::new`], with what the problem adds to the scene.
    pub fn adding(text: &str, keys: &[String], addition: Addition<'_>) -> Result<Self, String> {
        let (case, _) = case::read("case.toml", text, keys).map_err(|e| e.to_string())?;
        let scene = scene::build_adding(&case, MEMORY, addition).map_err(|e| e.to_string())?;
        Ok(Run { case, grid: scene.grid, sim: scene.simulation })
    }

    /// One step; a fault becomes its message.
    pub fn step(&mut self) -> Result<(), String> {
        self.sim.step(f64::MAX).map_err(|fault| fault.to_string())
    }

    /// Steps until `time` (s), ending there exactly, and shows each step to `watch`.
    pub fn until(&mut self, time: f64, mut watch: impl FnMut(&Simulation)) -> Result<(), String> {
        // a remainder below rounding is no step
        while self.sim.time < time * (1.0 - 1e-12) {
            self.sim.step(time - self.sim.time).map_err(|fault| fault.to_string())?;
            watch(&self.sim);
        }
        Ok(())
    }

    /// Moves all points by the same vector, before the first step (m).
    pub fn shift(&mut self, by: [f64; 2]) {
        for axis in 0..2 {
            self.sim.body.committed.x[axis].iter_mut().for_each(|x| *x += by[axis]);
        }
    }

    /// Kinetic and elastic energy together (kJ/m).
    pub fn energy(&self) -> f64 {
        let e = self.sim.energies();
        e.kinetic + e.strain
    }
}

/// `path=value` for each pair.
pub(super) fn keys(pairs: &[(&str, String)]) -> Vec<String> {
    pairs.iter().map(|(path, value)| format!("{path}={value}")).collect()
}

/// A rectangle as the polygon of a region.
pub(super) fn rectangle(low: [f64; 2], high: [f64; 2]) -> String {
    let ([a, b], [c, d]) = (low, high);
    format!("[[{a:?}, {b:?}], [{c:?}, {b:?}], [{c:?}, {d:?}], [{a:?}, {d:?}]]")
}
