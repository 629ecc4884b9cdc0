//! A perfectly plastic block that flows under its own weight until it is flat enough to stand.
//!
//! The published codes have no inertia. Here it may come in, over steps so long that it only helps
//! from one equilibrium to the next; how far a run comes without it is told beside.

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    measure::largest,
    reference::Reference,
    setup::{Run, keys},
};

/// See the module.
pub struct BlockCollapse;

/// Other readings of "cu = 20 / sqrt(2)" than that of the case: what it is called, and the keys.
const READINGS: [(&str, &[(&str, &str)]); 3] = [
    ("q = 2 c", &[("material.clay.yield_constant", "2.0")]),
    ("|s| = 20 / sqrt(2) kPa", &[("material.clay.cohesion", "10.0"), ("material.clay.residual_cohesion", "10.0")]),
    ("c against the Cauchy stress", &[("material.clay.strength_measure", "cauchy")]),
];

/// One block.
#[derive(Clone, Copy)]
pub(super) struct Block {
    /// Cell size (m).
    pub cell: u32,
    /// Points an axis and cell.
    pub points: u32,
}

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
            let block = Block { cell, points: 3 };
            let end = self.collapse(block, &[], report)?;
            report.figure(end.shape(cell));
            report.row(reference, &format!("runout_{cell}"), end.runout)?;
            report.row(reference, &format!("height_{cell}"), end.height)?;
            block.rows(&end, reference, report)?;
            self.few_points(cell, reference, report)?;
        }
        self.without_inertia(reference, report)?;
        if effort == Effort::Full {
            self.readings(reference, report)?;
        }
        Ok(())
    }
}

impl BlockCollapse {
    /// With 2 x 2 points, where others diverge.
    fn few_points(&self, cell: u32, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let block = Block { cell, points: 2 };
        let end = self.collapse(block, &[], report)?;
        block.rows(&end, reference, report)?;
        report.row_of(reference, "runout", &block.name(), None, end.runout)?;
        report.row_of(reference, "height", &block.name(), None, end.height)
    }

    /// As the published codes do it, with and without the line search that they do not have.
    fn without_inertia(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for (cell, points) in [(2, 3), (1, 3), (2, 2), (1, 2)] {
            let block = Block { cell, points };
            for search in [true, false] {
                let set = [("implicit.regime", "quasi_static"), ("implicit.line_search", word(search))];
                let end = self.collapse(block, &set, report)?;
                let setup = format!("{}, line search {}", block.name(), if search { "on" } else { "off" });
                report.row_of(reference, "still", &setup, None, end.share)?;
                report.row_of(reference, "still_runout", &setup, None, end.runout)?;
            }
        }
        Ok(())
    }

    fn readings(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for (name, set) in READINGS {
            let end = self.collapse(Block { cell: 2, points: 3 }, set, report)?;
            report.row_of(reference, "reading", name, None, end.runout / reference.exact("runout_2")?)?;
        }
        Ok(())
    }

    pub(super) fn collapse(&self, block: Block, set: &[(&str, &str)], report: &mut Report) -> Result<End, String> {
        let mut all =
            keys(&[("grid.cell", format!("{}.0", block.cell)), ("points.per_axis", block.points.to_string())]);
        all.extend(set.iter().map(|(key, value)| format!("{key}={value}")));
        let mut run = Run::new(self.files().case, &all)?;
        if let Err(why) = run.until(run.case.end.time, |_| ()) {
            report.note(format!("{}: {why}", block.name()));
        }
        report.count(&run.sim);
        Ok(End::read(&run))
    }
}

fn word(flag: bool) -> &'static str {
    if flag { "true" } else { "false" }
}

impl Block {
    fn name(&self) -> String {
        format!("{0} x {0} points, h = {1} m", self.points, self.cell)
    }

    /// How the run went.
    fn rows(&self, end: &End, reference: &Reference, report: &mut Report) -> Result<(), String> {
        report.row_of(reference, "share", &self.name(), None, end.share)?;
        report.row_of(reference, "inertia", &self.name(), None, end.kinetic)?;
        report.note(format!("{}: {}", self.name(), end.work));
        Ok(())
    }
}

/// What a run came to.
pub(super) struct End {
    /// Share of gravity.
    pub share: f64,
    runout: f64,
    height: f64,
    /// Kinetic energy over the work of gravity.
    kinetic: f64,
    /// Steps, cuts and iterations, in words.
    work: String,
    /// Newton iterations.
    pub iterations: u64,
    /// Places of the points (m).
    places: Vec<(f64, f64)>,
}

impl End {
    fn shape(&self, cell: u32) -> Figure {
        Figure::new(
            &format!("Block under its own weight, h = {cell} m"),
            "half of the block, smooth base, quasi-static up to where equilibrium is lost",
            "x (m)",
            "y (m)",
        )
        .with("points at the end", Kind::Points, self.places.clone())
        .with("at the start", Kind::Exact, vec![(0.0, 8.0), (8.0, 8.0), (8.0, 0.0)])
    }

    fn read(run: &Run) -> Self {
        let after = run.sim.snapshot();
        let most = |axis: usize| largest(after.position.iter().map(|x| x[axis]));
        let (work, energies) = (&run.sim.work, run.sim.energies());
        let (steps, cut, newton) = (work.steps, work.rejected_steps, work.newton_iterations);
        End {
            share: (run.sim.time / run.case.end.time).min(1.0),
            runout: most(0),
            height: most(1),
            kinetic: energies.kinetic / energies.external,
            work: format!("{steps} steps, {cut} refused, {newton} iterations, {} domains cut", work.domain_clamps),
            iterations: newton,
            places: after.position.iter().map(|x| (x[0], x[1])).collect(),
        }
    }
}
