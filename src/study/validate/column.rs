//! A column under its own weight, squeezed to half its height.
//!
//! With nu = 0 the stretch lambda of a point carries the weight above it:
//! ```text
//! sigma = E ln(lambda) / lambda = -rho0 g (l0 - Y)   =>   lambda = W(q) / q,   q = rho0 g (l0 - Y) / E
//! y(Y) = int_0^Y lambda dY = E / (rho0 g) (P(q_0) - P(q)),   P(q) = W + W^2 / 2
//! ```
//! with W = W(q) Lambert's function and q_0 = q at Y = 0; P' = W / q.

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    measure::{mean, order},
    reference::Reference,
    setup::{Run, keys, rectangle},
};
use crate::snapshot::Snapshot;

/// See the module.
pub struct Column;

/// Rows of cells of the published figures.
const ROWS: [usize; 3] = [8, 32, 64];

impl Problem for Column {
    fn name(&self) -> &'static str {
        "column"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/column/case.toml"),
            reference: include_str!("../../../validation/column/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let smooth = self.published(reference, report)?;
        let linear = self.swept(effort, "linear", reference, report)?;
        let splines = self.swept(effort, "bspline", reference, report)?;
        let figure = Figure::convergence(
            "Column under its own weight: error of the stress",
            "implicit, 40 steps; linear cells do not converge where points cross their faces",
            "cell over height",
            "mean error over the largest stress",
        );
        let figure = figure.with("GIMP", Kind::Marked, smooth).with("B-spline", Kind::Marked, splines);
        report.figure(figure.with("linear", Kind::Marked, linear).with_slope(2));
        self.one_point(effort, reference, report)
    }
}

impl Column {
    /// GIMP beside the figures of the other codes. Error of the stress over cell over height.
    fn published(&self, reference: &Reference, report: &mut Report) -> Result<Vec<(f64, f64)>, String> {
        let (mut stress, mut way) = (Vec::new(), Vec::new());
        for rows in ROWS {
            let found = self.squeeze(rows, &[], reference, report)?;
            let setup = format!("{rows} rows");
            report.row(reference, &format!("stress_{rows}"), found.stress)?;
            report.row(reference, &format!("displacement_{rows}"), found.displacement)?;
            report.row_of(reference, "iterations", &setup, None, found.iterations as f64)?;
            report.row_of(reference, "steps", &setup, None, found.steps as f64)?;
            stress.push((1.0 / rows as f64, found.stress));
            way.push((1.0 / rows as f64, found.displacement));
        }
        report.row(reference, "order", order(&stress))?;
        report.row(reference, "displacement_order", order(&way))?;
        Ok(stress)
    }

    /// Other shapes: bilinear functions do not converge here; splines do, while points tile their cells. Errors of the
    /// stress, as above.
    fn swept(
        &self,
        effort: Effort,
        shape: &str,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<Vec<(f64, f64)>, String> {
        let mut errors = Vec::new();
        for &rows in sizes(effort) {
            let set = [("solver.shape", shape.to_owned())];
            let found = self.squeeze(rows, &set, reference, report)?;
            report.row_of(reference, shape, &format!("{rows} rows"), None, found.stress)?;
            errors.push((1.0 / rows as f64, found.stress));
        }
        report.row(reference, &format!("{shape}_order"), order(&errors))?;
        Ok(errors)
    }

    /// One point a cell: how far it comes, and with what error.
    fn one_point(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let length = reference.given("length")?;
        for &rows in sizes(effort) {
            let name = format!("{rows} rows");
            let mut run = self.build(rows, &[("points.per_axis", "1".to_owned())], length)?;
            let end = run.until(run.case.end.time, |_| ());
            report.count(&run.sim);
            report.row_of(reference, "one_point_share", &name, None, run.sim.time / run.case.end.time)?;
            match end {
                Ok(()) => {
                    report.row_of(reference, "one_point", &name, None, Squeezed::read(&run, length)?.stress)?;
                }
                Err(why) => report.note(format!("one point a cell, {name}: {why}")),
            }
        }
        Ok(())
    }

    fn build(&self, rows: usize, more: &[(&str, String)], length: f64) -> Result<Run, String> {
        let h = length / rows as f64;
        let width = 3.0 * h;
        let mut set = keys(&[
            ("grid.cell", format!("{h:?}")),
            ("grid.size", format!("[{width:?}, {length:?}]")),
            ("region.column.polygon", rectangle([0.0, 0.0], [width, length])),
        ]);
        set.extend(keys(more));
        Run::new(self.files().case, &set)
    }

    pub(super) fn squeeze(
        &self,
        rows: usize,
        more: &[(&str, String)],
        reference: &Reference,
        report: &mut Report,
    ) -> Result<Squeezed, String> {
        let length = reference.given("length")?;
        let mut run = self.build(rows, more, length)?;
        run.until(run.case.end.time, |_| ())?;
        report.count(&run.sim);
        Squeezed::read(&run, length)
    }
}

fn sizes(effort: Effort) -> &'static [usize] {
    match effort {
        Effort::Short => &ROWS[..2],
        Effort::Full => &ROWS,
    }
}

/// What came out of one column.
pub(super) struct Squeezed {
    /// sum |sigma_yy - exact| V0 / (rho0 g l0 sum V0).
    pub stress: f64,
    /// Mean |u - exact| / |u of the tip|.
    displacement: f64,
    iterations: u64,
    /// Accepted and refused.
    steps: u64,
}

impl Squeezed {
    fn read(run: &Run, length: f64) -> Result<Self, String> {
        let elastic = run.case.material.get("soil").ok_or("there is no soil")?.elastic();
        let exact = Exact { length, weight: elastic.unit_weight, modulus: elastic.young_modulus };
        let after = run.sim.snapshot();
        let work = &run.sim.work;
        Ok(Squeezed {
            stress: exact.stress_error(&after),
            displacement: exact.displacement_error(&after),
            iterations: work.newton_iterations,
            steps: work.steps + work.rejected_steps,
        })
    }
}

/// The exact column.
struct Exact {
    /// l0 (m).
    length: f64,
    /// rho0 g (kN/m3).
    weight: f64,
    /// E (kPa).
    modulus: f64,
}

impl Exact {
    fn stress(&self, y: f64) -> f64 {
        -self.weight * (self.length - y)
    }

    /// Displacement of the point that starts at height `y` (m).
    fn displacement(&self, y: f64) -> f64 {
        let path = |y: f64| {
            let w = lambert(self.weight * (self.length - y) / self.modulus);
            w + 0.5 * w * w
        };
        self.modulus / self.weight * (path(0.0) - path(y)) - y
    }

    fn stress_error(&self, s: &Snapshot) -> f64 {
        let error = |i: usize| (s.stress[i].yy - self.stress(s.reference[i][1])).abs() * s.initial_volume[i];
        let volume: f64 = s.initial_volume.iter().sum();
        (0..s.len()).map(error).sum::<f64>() / (self.weight * self.length * volume)
    }

    fn displacement_error(&self, s: &Snapshot) -> f64 {
        let error = |i: usize| (s.displacement(i)[1] - self.displacement(s.reference[i][1])).abs();
        mean((0..s.len()).map(error)) / self.displacement(self.length).abs()
    }
}

/// W(q) for q >= 0, W exp(W) = q, by Newton's method from above.
fn lambert(q: f64) -> f64 {
    let mut w = q.ln_1p();
    for _ in 0..50 {
        let e = w.exp();
        let step = (w * e - q) / (e * (1.0 + w));
        w -= step;
        if step.abs() <= 1e-16 * w.abs() {
            break;
        }
    }
    w
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lamberts_function() {
        assert_eq!(lambert(0.0), 0.0);
        assert!((lambert(1.0) - 0.567_143_290_409_783_8).abs() < 1e-15);
        let w = lambert(4.0);
        assert!((w * w.exp() - 4.0).abs() < 1e-14);
    }

    /// The published displacement of the tip; and y' = lambda.
    #[test]
    fn the_exact_column() {
        let exact = Exact { length: 50.0, weight: 0.8, modulus: 10.0 };
        assert!((exact.displacement(50.0) + 25.9404).abs() < 5e-5);
        let (y, d) = (20.0, 1e-4);
        let stretch = 1.0 + (exact.displacement(y + d) - exact.displacement(y - d)) / (2.0 * d);
        assert!((exact.modulus * stretch.ln() / stretch - exact.stress(y)).abs() < 1e-6);
    }
}
