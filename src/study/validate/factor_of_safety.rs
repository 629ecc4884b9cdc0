//! The factor of safety of undrained slopes by strength reduction.
//!
//! The limit is found twice: strengths are divided under full gravity, and gravity grows with the strength as it
//! is. In a perfectly plastic soil the two are the same limit.

use super::{
    Effort, Files, Problem, Report,
    limit::last_equilibrium,
    reference::Reference,
    setup::{MEMORY, Run, keys},
    undrained_slopes::{SLOPES, Slope},
};
use crate::{case, run::Limits, study::strength_reduction};

/// See the module.
pub struct FactorOfSafety;

impl Problem for FactorOfSafety {
    fn name(&self) -> &'static str {
        "factor-of-safety"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/factor-of-safety/case.toml"),
            reference: include_str!("../../../validation/factor-of-safety/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let (tolerance, sizes): (f64, [&[u32]; 2]) = match effort {
            Effort::Short => (0.02, [&[10], &[20]]),
            Effort::Full => (0.005, [&[10, 20, 30], &[10, 20, 40]]),
        };
        for (key, sizes) in ["gentle_2", "steep_1"].into_iter().zip(sizes) {
            let slope = SLOPES.iter().find(|s| s.key == key).ok_or("no such slope")?;
            for &rows in sizes {
                let finest = Some(&rows) == sizes.last();
                let found = self.factor(slope, rows, tolerance, reference, report)?;
                if Some(&rows) == sizes.first() {
                    let gravity = self.by_gravity(slope, rows, report)?;
                    report.row_of(reference, "gravity", &slope.name(rows), None, found / gravity)?;
                }
                let exact = (!finest).then(|| reference.exact(key)).transpose()?;
                report.row_of(reference, if finest { key } else { "coarse" }, &slope.name(rows), exact, found)?;
            }
        }
        Ok(())
    }
}

impl FactorOfSafety {
    fn factor(
        &self,
        slope: &Slope,
        rows: u32,
        tolerance: f64,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<f64, String> {
        let mut set = slope.keys(rows);
        set.extend(keys(&[("strength_reduction.tolerance", format!("{tolerance:?}"))]));
        let (case, _) = case::read("case.toml", self.files().case, &set).map_err(|e| e.to_string())?;
        let found = strength_reduction::find(&case, MEMORY, Limits::NONE, |_| {}).map_err(|e| format!("{e:?}"))?;
        let [low, high] = found.bracket;
        report.row_of(reference, "bracket", &slope.name(rows), None, (high - low) / tolerance)?;
        Ok(found.factor_of_safety)
    }

    /// The factor that gravity gives: with half the strength the slope fails under half the factor of it.
    fn by_gravity(&self, slope: &Slope, rows: u32, report: &mut Report) -> Result<f64, String> {
        let mut set = slope.keys(rows);
        set.extend(keys(&[("material.clay.cohesion", "25.0".to_owned()), ("implicit.time_step", "0.1".to_owned())]));
        let mut run = Run::new(self.files().case, &set)?;
        let bracket = last_equilibrium(&mut run)?.ok_or("the slope stands with half its strength")?;
        report.count(&run.sim);
        Ok(2.0 * bracket.middle())
    }
}
