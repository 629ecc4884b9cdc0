//! A perfectly plastic block that flows under its own weight until it is flat enough to stand.

use super::{
    Effort, Files, Problem, Report,
    measure::largest,
    reference::Reference,
    setup::{Run, keys},
};

/// See the module.
pub struct BlockCollapse;

impl Problem for BlockCollapse {
    fn name(&self) -> &'static str {
        "block-collapse"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/block-collapse/case.toml"),
            reference: include_str!("../../../validation/block-collapse/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for cell in [2, 1] {
            let end = self.collapse(cell, 3, "quasi_static", report)?;
            report.row(reference, &format!("runout_{cell}"), end.runout)?;
            report.row(reference, &format!("height_{cell}"), end.height)?;
        }
        self.few_points(2, reference, report)?;
        if effort == Effort::Full {
            self.few_points(1, reference, report)?;
        }
        Ok(())
    }
}

impl BlockCollapse {
    /// With 2 x 2 points, where others diverge: without inertia as far as it goes, and with inertia
    /// where there is no equilibrium.
    fn few_points(&self, cell: u32, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for (regime, key) in [("quasi_static", "still"), ("auto", "share")] {
            let end = self.collapse(cell, 2, regime, report)?;
            let setup = format!("2 x 2 points, h = {cell} m, {regime}");
            report.row_of(reference, key, &setup, None, end.share)?;
            report.row_of(reference, "runout", &setup, None, end.runout)?;
            report.row_of(reference, "height", &setup, None, end.height)?;
        }
        Ok(())
    }

    fn collapse(&self, cell: u32, per_axis: u32, regime: &str, report: &mut Report) -> Result<End, String> {
        let set = keys(&[
            ("grid.cell", format!("{cell}.0")),
            ("points.per_axis", per_axis.to_string()),
            ("implicit.regime", regime.to_owned()),
        ]);
        let mut run = Run::new(self.files().case, &set)?;
        let name = format!("{per_axis} x {per_axis} points, h = {cell} m, {regime}");
        if let Err(why) = run.until(run.case.end.time, |_| ()) {
            report.note(format!("{name}: {why}"));
        }
        report.count(&run.sim);
        let end = End::read(&run);
        report.note(format!("{name}: {}", end.work));
        Ok(end)
    }
}

/// What a run came to.
struct End {
    /// Share of gravity.
    share: f64,
    runout: f64,
    height: f64,
    /// Steps, cuts and iterations, in words.
    work: String,
}

impl End {
    fn read(run: &Run) -> Self {
        let after = run.sim.snapshot();
        let most = |axis: usize| largest(after.position.iter().map(|x| x[axis]));
        let work = &run.sim.work;
        let (steps, cut, newton) = (work.steps, work.rejected_steps, work.newton_iterations);
        End {
            share: (run.sim.time / run.case.end.time).min(1.0),
            runout: most(0),
            height: most(1),
            work: format!(
                "{steps} steps, {cut} refused, {newton} iterations, {} domains cut at most",
                work.domain_clamps
            ),
        }
    }
}
