//! A cantilever with a dead load at its end, bent until it hangs.
//!
//! One run a grid: the load grows to alpha = P L^2 / EI = 10 and the tip is read on the way, against
//! the inextensible elastica. The grid's error in bending, while points and nodes keep their places,
//! is that of four-noded cells with points at 1/4 and 3/4, for h = d / n:
//! ```text
//! EI_h / EI = 1 - 1 / (4 n^2) + 3/4 G / E' / n^2
//! ```
//! (points sample y^2 too low; the shear that a bilinear cell cannot bend without adds to it).

use super::{
    Effort, Files, Problem, Report,
    measure::mean,
    reference::Reference,
    setup::{Run, keys, rectangle},
};
use crate::snapshot::Snapshot;

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
        let mut tips: Vec<Vec<[f64; 2]>> = Vec::new();
        for &cells in cells {
            let beam = Beam { slender, cells };
            let tip = self.bend(beam, reference, report)?;
            for (&alpha, way) in ALPHAS.iter().zip(&tip) {
                beam.rows(alpha, *way, key, reference, report)?;
            }
            tips.push(tip);
        }
        let [.., coarse, fine] = tips.as_slice() else { return Ok(()) };
        for (k, alpha) in ALPHAS.iter().enumerate() {
            let both = coarse.get(k).zip(fine.get(k));
            let change = both.map_or(f64::NAN, |(a, b)| b[1] / a[1] - 1.0);
            report.row_of(reference, "change", &format!("L / d = {slender}, alpha = {alpha}"), None, change)?;
        }
        for (alpha, way) in ALPHAS.iter().zip(fine.iter().map(Some).chain(std::iter::repeat(None))) {
            report.row(reference, &format!("{key}_{alpha}"), way.map_or(f64::NAN, |w| w[1]))?;
        }
        Ok(())
    }

    /// The way of the tip over L at each load: back along the beam, and down. It ends early, with a
    /// note, where the run does.
    fn bend(&self, beam: Beam, reference: &Reference, report: &mut Report) -> Result<Vec<[f64; 2]>, String> {
        let length = reference.given("length")?;
        let mut run = Run::new(self.files().case, &beam.keys(length)?)?;
        let tip = beam.tip(&run.sim.snapshot(), length);
        let mut ways = Vec::new();
        for alpha in ALPHAS {
            if let Err(why) = run.until(f64::from(alpha) / 10.0, |_| ()) {
                report.note(format!("{}: {why}", beam.name()));
                break;
            }
            ways.push(beam.way(&run.sim.snapshot(), &tip, length));
        }
        report.count(&run.sim);
        let work = &run.sim.work;
        let (steps, cut, newton) = (work.steps, work.rejected_steps, work.newton_iterations);
        report.note(format!("{}: {steps} steps, {cut} refused, {newton} iterations", beam.name()));
        Ok(ways)
    }
}

impl Beam {
    fn name(&self) -> String {
        format!("L / d = {}, h = d/{}", self.slender, self.cells)
    }

    fn depth(&self, length: f64) -> f64 {
        length / self.slender
    }

    fn cell(&self, length: f64) -> f64 {
        self.depth(length) / self.cells as f64
    }

    /// From the clamp to the loaded points (m).
    fn arm(&self, length: f64) -> f64 {
        length - 0.25 * self.cell(length)
    }

    /// Lower left and upper right corner of the box of the loaded points: the last cell's outer half.
    fn loaded(&self, length: f64) -> [[f64; 2]; 2] {
        let (d, h) = (self.depth(length), self.cell(length));
        [[length - 0.5 * h, 0.5 * (d - h)], [length, 0.5 * (d + h)]]
    }

    fn keys(&self, length: f64) -> Result<Vec<String>, String> {
        let (d, h) = (self.depth(length), self.cell(length));
        let (case, _) = crate::case::read("cantilever", Cantilever.files().case, &[]).map_err(|e| e.to_string())?;
        let elastic = case.material.get("beam").ok_or("there is no beam")?.elastic();
        let stiffness = elastic.young_modulus * d.powi(3) / 12.0 / (1.0 - elastic.poisson_ratio.powi(2));
        let force = 10.0 * stiffness / self.arm(length).powi(2);
        let [low, high] = self.loaded(length);
        Ok(keys(&[
            ("grid.cell", format!("{h:?}")),
            ("region.beam.polygon", rectangle([0.0, 0.0], [length, d])),
            ("load.tip.box", format!("[{low:?}, {high:?}]")),
            ("load.tip.force", format!("[0.0, {:?}]", -force)),
        ]))
    }

    /// The loaded points.
    fn tip(&self, start: &Snapshot, length: f64) -> Vec<usize> {
        let [low, high] = self.loaded(length);
        let inside = |x: [f64; 2]| (0..2).all(|a| x[a] >= low[a] && x[a] <= high[a]);
        (0..start.len()).filter(|&i| inside(start.position[i])).collect()
    }

    fn way(&self, now: &Snapshot, tip: &[usize], length: f64) -> [f64; 2] {
        [0, 1].map(|axis| -mean(tip.iter().map(|&i| now.displacement(i)[axis])) / self.arm(length))
    }

    fn rows(
        &self,
        alpha: u32,
        way: [f64; 2],
        key: &str,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        let setup = format!("{}, alpha = {alpha}", self.name());
        let (u, v) = (reference.given(&format!("u_{alpha}"))?, reference.exact(&format!("{key}_{alpha}"))?);
        report.row_of(reference, "coarse", &setup, None, way[1] / v)?;
        report.row_of(reference, "shortening", &setup, None, way[0] / u)
    }
}
