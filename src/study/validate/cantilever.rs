//! A cantilever with a dead load at its end, bent until it hangs.
//!
//! One run a grid: the load grows to alpha = P L^2 / EI = 10 and the tip is read on the way, against
//! the inextensible elastica.

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    measure::mean,
    reference::Reference,
    setup::{Run, keys, rectangle},
};
use crate::{case, snapshot::Snapshot};

/// See the module.
pub struct Cantilever;

/// Values of P L^2 / EI at which the tip is read.
const ALPHAS: [u32; 3] = [1, 4, 10];

/// A beam on a grid.
#[derive(Clone, Copy)]
struct Beam {
    /// L / d.
    slender: f64,
    /// Cells over the depth.
    cells: usize,
    /// Points an axis and cell.
    points: usize,
    shape: &'static str,
}

impl Problem for Cantilever {
    fn name(&self) -> &'static str {
        "cantilever"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/cantilever/case.toml"),
            reference: include_str!("../../../validation/cantilever/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let (thick, slim): (&[usize], &[usize]) = match effort {
            Effort::Short => (&[2, 4, 8], &[]),
            Effort::Full => (&[2, 4, 8, 16], &[4, 8]),
        };
        self.refine(10.0, "v", thick, reference, report)?;
        self.few_points(reference, report)?;
        self.splines(reference, report)?;
        self.refine(40.0, "slim", slim, reference, report)
    }
}

impl Cantilever {
    /// One beam on finer and finer grids; the finest is judged against the answers `key`_alpha.
    fn refine(
        &self,
        slender: f64,
        key: &str,
        cells: &[usize],
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        let mut bent = Vec::new();
        for &cells in cells {
            let beam = Beam { slender, cells, points: 4, shape: "gimp" };
            let tip = self.bend(beam, reference, report)?;
            tip.rows(&beam.name(), reference, report)?;
            bent.push(tip);
        }
        let [.., coarse, fine] = bent.as_slice() else { return Ok(()) };
        report.figure(deflections(slender, coarse, fine, reference)?);
        for (k, alpha) in ALPHAS.iter().enumerate() {
            report.row(reference, &format!("{key}_{alpha}"), fine.down(k))?;
            let setup = format!("L / d = {slender}, alpha = {alpha}");
            report.row_of(reference, "change", &setup, None, fine.down(k) / coarse.down(k) - 1.0)?;
        }
        Ok(())
    }

    /// What two points an axis and cell come to.
    fn few_points(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for cells in [4, 8] {
            let beam = Beam { slender: 10.0, cells, points: 2, shape: "gimp" };
            let tip = self.bend(beam, reference, report)?;
            report.row_of(reference, "reached", &beam.name(), None, tip.share)?;
            for (k, alpha) in ALPHAS.iter().enumerate().take(tip.ways.len()) {
                let exact = reference.exact(&format!("v_{alpha}"))?;
                report.row_of(
                    reference,
                    "few",
                    &format!("{}, alpha = {alpha}", beam.name()),
                    None,
                    tip.down(k) / exact,
                )?;
            }
        }
        Ok(())
    }

    /// How far splines come, which do not follow the stretch of the points.
    fn splines(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for cells in [2, 4, 8] {
            let beam = Beam { slender: 10.0, cells, points: 4, shape: "bspline" };
            self.bend(beam, reference, report)?.rows(&beam.name(), reference, report)?;
        }
        Ok(())
    }

    /// Loads a beam as far as it goes; where that is not to the end, a note says why.
    fn bend(&self, beam: Beam, reference: &Reference, report: &mut Report) -> Result<Tip, String> {
        let length = reference.given("length")?;
        let mut run = Run::new(self.files().case, &beam.keys(length)?)?;
        let loaded = beam.loaded_points(&run.sim.snapshot(), length);
        let mut tip = Tip::default();
        for alpha in ALPHAS {
            if let Err(why) = run.until(f64::from(alpha) / 10.0, |_| ()) {
                report.note(format!("{}: {why}", beam.name()));
                break;
            }
            tip.ways.push(beam.way(&run.sim.snapshot(), &loaded, length));
        }
        report.count(&run.sim);
        let work = &run.sim.work;
        let (steps, cut, newton) = (work.steps, work.rejected_steps, work.newton_iterations);
        report.note(format!("{}: {steps} steps, {cut} refused, {newton} iterations", beam.name()));
        tip.share = run.sim.time.min(1.0);
        Ok(tip)
    }
}

/// Deflection over the load on the two finest grids.
fn deflections(slender: f64, coarse: &Tip, fine: &Tip, reference: &Reference) -> Result<Figure, String> {
    let loads = || ALPHAS.iter().map(|alpha| f64::from(*alpha));
    let ours = |tip: &Tip| loads().enumerate().map(|(k, alpha)| (alpha, tip.down(k))).collect();
    let answers = ALPHAS.iter().map(|alpha| reference.exact(&format!("v_{alpha}"))).collect::<Result<Vec<_>, _>>()?;
    Ok(Figure::new(
        &format!("Cantilever: deflection of the tip, L / d = {slender}"),
        "the elastica has neither shear nor stretch; it is known at the three loads, and the line between them is a guide",
        "P L^2 / EI",
        "deflection over L",
    )
    .with("finest grid", Kind::Points, ours(fine))
    .with("cells twice as large", Kind::Points, ours(coarse))
    .with("elastica", Kind::Exact, std::iter::once((0.0, 0.0)).chain(loads().zip(answers)).collect()))
}

/// Where the tip has gone.
#[derive(Default)]
struct Tip {
    /// Its way over L at each of [`ALPHAS`] that was reached: back along the beam, and down.
    ways: Vec<[f64; 2]>,
    /// Share of the load that was reached.
    share: f64,
}

impl Tip {
    /// Deflection over L at load `k`; not a number where that was not reached.
    fn down(&self, k: usize) -> f64 {
        self.ways.get(k).map_or(f64::NAN, |way| way[1])
    }

    /// Beside the elastica.
    fn rows(&self, name: &str, reference: &Reference, report: &mut Report) -> Result<(), String> {
        report.row_of(reference, "reached", name, None, self.share)?;
        for (alpha, way) in ALPHAS.iter().zip(&self.ways) {
            let setup = format!("{name}, alpha = {alpha}");
            let (u, v) = (reference.given(&format!("u_{alpha}"))?, reference.exact(&format!("v_{alpha}"))?);
            report.row_of(reference, "coarse", &setup, None, way[1] / v)?;
            report.row_of(reference, "shortening", &setup, None, way[0] / u)?;
        }
        Ok(())
    }
}

impl Beam {
    fn name(&self) -> String {
        let shape = if self.shape == "gimp" { "" } else { ", splines" };
        format!("L / d = {}, h = d/{}, {2} x {2} points{shape}", self.slender, self.cells, self.points)
    }

    fn depth(&self, length: f64) -> f64 {
        length / self.slender
    }

    fn cell(&self, length: f64) -> f64 {
        self.depth(length) / self.cells as f64
    }

    /// From the clamp to the middle of the loaded points (m).
    fn arm(&self, length: f64) -> f64 {
        length - 0.25 * self.cell(length)
    }

    /// Lower left and upper right corner of the box of the loaded points: half a cell at the end,
    /// one cell high.
    fn loaded(&self, length: f64) -> [[f64; 2]; 2] {
        let (d, h) = (self.depth(length), self.cell(length));
        [[length - 0.5 * h, 0.5 * (d - h)], [length, 0.5 * (d + h)]]
    }

    fn keys(&self, length: f64) -> Result<Vec<String>, String> {
        let (d, h) = (self.depth(length), self.cell(length));
        let (case, _) = case::read("cantilever", Cantilever.files().case, &[]).map_err(|e| e.to_string())?;
        let elastic = case.material.get("beam").ok_or("there is no beam")?.elastic();
        let stiffness = elastic.young_modulus * d.powi(3) / 12.0 / (1.0 - elastic.poisson_ratio.powi(2));
        let force = 10.0 * stiffness / self.arm(length).powi(2);
        let [low, high] = self.loaded(length);
        Ok(keys(&[
            ("grid.cell", format!("{h:?}")),
            ("points.per_axis", self.points.to_string()),
            ("solver.shape", self.shape.to_owned()),
            ("region.beam.polygon", rectangle([0.0, 0.0], [length, d])),
            ("load.tip.box", format!("[{low:?}, {high:?}]")),
            ("load.tip.force", format!("[0.0, {:?}]", -force)),
        ]))
    }

    fn loaded_points(&self, start: &Snapshot, length: f64) -> Vec<usize> {
        let [low, high] = self.loaded(length);
        let inside = |x: [f64; 2]| (0..2).all(|a| x[a] >= low[a] && x[a] <= high[a]);
        (0..start.len()).filter(|&i| inside(start.position[i])).collect()
    }

    fn way(&self, now: &Snapshot, tip: &[usize], length: f64) -> [f64; 2] {
        [0, 1].map(|axis| -mean(tip.iter().map(|&i| now.displacement(i)[axis])) / self.arm(length))
    }
}
