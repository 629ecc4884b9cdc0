//! The stability limit of runs against the eigenvalues of the step, and against the program's
//! own estimate.

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    measure::bisect,
    operator::{Operator, Stiffness, bilinear, spline},
    reference::Reference,
    setup::{Run, keys, rectangle},
};
use crate::{
    case::{ShapeFunctions, StressUpdate},
    field::stream::{Purpose, Stream},
};

/// See the module.
pub struct Courant;

impl Problem for Courant {
    fn name(&self) -> &'static str {
        "courant"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/courant/case.toml"),
            reference: include_str!("../../../validation/courant/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let parked = reference.given("parked")?;
        let steps = if effort == Effort::Short { 4000 } else { 20_000 };
        for update in ["musl", "usl"] {
            for (name, layout, shift) in [
                ("even", "even", 0.0),
                ("Gauss", "gauss", 0.0),
                // the last points of the bar then lie that far past a node, alone there
                ("one past a node", "even", 0.25 + parked),
            ] {
                let bar = Bar { text: self.files().case, update, layout, shift, steps, more: &[] };
                bar.rows(name, reference, report)?;
            }
            self.transfers(update, steps, reference, report)?;
            self.clouds(update, "linear", effort, reference, report)?;
            self.clouds(update, "bspline", effort, reference, report)?;
        }
        Ok(())
    }
}

/// Shapes and transfers whose limits are found by runs alone.
const OTHERS: [(&str, &str); 5] =
    [("bspline", "flip"), ("linear", "apic"), ("bspline", "apic"), ("linear", "xpic"), ("bspline", "xpic")];

impl Courant {
    /// The estimate against the limits that runs find, for a bar two cells high.
    fn transfers(&self, update: &str, steps: usize, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for (shape, transfer) in OTHERS {
            let more = keys(&[
                ("solver.shape", shape.into()),
                ("solver.transfer", transfer.into()),
                ("grid.size", "[12.0, 2.0]".into()),
                ("region.bar.polygon", rectangle([1.0, 0.0], [9.0, 2.0])),
            ]);
            let bar = Bar { text: self.files().case, update, layout: "even", shift: 0.0, steps, more: &more };
            let found = bar.limit(reference, report)?;
            let estimate = bar.at(None)?.sim.stable_dt().ok_or("no stable step")?;
            let name = format!("{} {shape} {transfer}", update.to_uppercase());
            report.row_of(reference, "found", &name, None, found)?;
            report.row_of(reference, "safe", &name, None, estimate / found)?;
        }
        Ok(())
    }

    /// The estimate for blocks in the plane whose points lie anywhere near their places: the
    /// worst of many.
    fn clouds(
        &self,
        update: &str,
        shape: &str,
        effort: Effort,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        let seeds = if effort == Effort::Short { 5 } else { 50 };
        let set = keys(&[
            ("explicit.stress_update", update.into()),
            ("solver.shape", shape.into()),
            ("grid.size", "[5.0, 4.0]".into()),
            ("boundary.base", "free".into()),
            ("boundary.top", "free".into()),
            ("material.bar.poisson_ratio", "0.33".into()),
            ("region.bar.polygon", rectangle([1.0, 1.0], [4.0, 3.0])),
        ]);
        let mut ratios = Vec::new();
        for spread in [0.0, 0.2, 0.7] {
            let mut worst: f64 = 0.0;
            for seed in 0..seeds {
                let mut run = Run::new(self.files().case, &set)?;
                scatter_points(&mut run, seed, spread);
                worst = worst.max(estimate_over_limit(&mut run, 2)?);
            }
            let name = format!("{} {shape} block, points moved by up to {spread} h", update.to_uppercase());
            report.row_of(reference, "safe", &name, None, worst)?;
            ratios.push((spread, worst));
        }
        report.figure(
            Figure::new(
                &format!("{}: estimate of the stable step over the exact limit", update.to_uppercase()),
                "the worst of many blocks in the plane whose points are moved at random; a safe estimate lies below 1",
                "points moved by up to (cells)",
                "estimate over exact limit",
            )
            .with("worst", Kind::Marked, ratios)
            .with("exact limit", Kind::Exact, vec![(0.0, 1.0), (0.7, 1.0)]),
        );
        Ok(())
    }
}

/// Moves each point by up to `spread` cells along each axis.
fn scatter_points(run: &mut Run, seed: u64, spread: f64) {
    let mut stream = Stream::new(1, seed, Purpose::Jitter);
    let h = run.grid.h;
    for axis in 0..2 {
        run.sim.body.committed.x[axis].iter_mut().for_each(|x| *x += spread * h * stream.symmetric());
    }
}

/// The exact limit of a run's stress update (s).
fn exact_limit(run: &Run, operator: &Operator) -> f64 {
    match run.case.explicit.stress_update {
        StressUpdate::Musl => operator.musl_limit(),
        StressUpdate::Usl => operator.usl_limit(),
    }
}

fn operator(run: &Run, axes: usize) -> Operator {
    let law = Stiffness::of(run.case.material["bar"].elastic());
    let mean_mass = run.sim.initial_mass / run.sim.body.len() as f64;
    let near = if run.case.solver.shape == ShapeFunctions::Bspline { spline } else { bilinear };
    Operator::of(&run.sim, &run.grid, law, axes, run.case.explicit.mass_floor * mean_mass, near)
}

fn estimate_over_limit(run: &mut Run, axes: usize) -> Result<f64, String> {
    let estimate = run.sim.stable_dt().ok_or("no stable step")?;
    Ok(estimate / exact_limit(run, &operator(run, axes)))
}

struct Bar<'a> {
    text: &'static str,
    update: &'a str,
    layout: &'static str,
    /// Of all points, in cells.
    shift: f64,
    /// Steps that a run is watched for.
    steps: usize,
    /// Further keys.
    more: &'a [String],
}

impl Bar<'_> {
    fn at(&self, dt: Option<f64>) -> Result<Run, String> {
        let mut set = keys(&[("explicit.stress_update", self.update.into()), ("points.layout", self.layout.into())]);
        set.extend(dt.map(|dt| format!("explicit.time_step={dt:?}")));
        set.extend_from_slice(self.more);
        let mut run = Run::new(self.text, &set)?;
        let h = run.grid.h;
        run.shift([self.shift * h, 0.0]);
        Ok(run)
    }

    fn rows(&self, name: &str, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let mut run = self.at(None)?;
        let operator = operator(&run, 1);
        let exact = exact_limit(&run, &operator);
        let estimate = run.sim.stable_dt().ok_or("no stable step")?;
        let found = self.limit(reference, report)?;
        let name = format!("{} {name}", self.update.to_uppercase());
        report.row_of(reference, "limit", &name, Some(exact), found)?;
        report.row_of(reference, "lumped", &name, None, operator.lumped_limit() / exact)?;
        report.row_of(reference, "safe", &name, None, estimate / exact)
    }

    /// The largest stable step between a tenth and four times h/c (s).
    fn limit(&self, reference: &Reference, report: &mut Report) -> Result<f64, String> {
        let courant = 0.1;
        bisect(0.02 * courant, 4.0 * courant, 1e-3, |dt| self.is_stable(dt, reference, report))
    }

    fn is_stable(&self, dt: f64, reference: &Reference, report: &mut Report) -> Result<bool, String> {
        let mut run = self.at(Some(dt))?;
        shake(&mut run, reference.given("noise")?);
        let most = reference.given("growth")? * run.energy();
        for step in 0..self.steps {
            // not a number is not below
            let bounded = step % 50 != 0 || run.energy() < most;
            if !bounded || run.step().is_err() {
                return Ok(false);
            }
        }
        report.count(&run.sim);
        Ok(run.energy() < most)
    }
}

/// Gives the points a random velocity along the bar, a fraction of the wave speed of 10 m/s.
fn shake(run: &mut Run, noise: f64) {
    let mut stream = Stream::new(1, 0, Purpose::Jitter);
    run.sim.body.committed.v[0].iter_mut().for_each(|v| *v = 10.0 * noise * stream.symmetric());
}
