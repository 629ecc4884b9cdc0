//! Orders of the integrators in time.
//!
//! A bar, fixed on the left, is at rest when the body force b = g sin(k X) sets in, k = pi / 2 L. It moves in its first
//! mode alone:
//! ```text
//! u = (g / w^2) (1 - cos w t) sin(k X),   w = k sqrt(E / rho)
//! ```
//! so small that no point crosses a face. The force at t = 0 tells a scheme that staggers velocities from one that
//! does not: leapfrog has v(-dt/2) = -g dt / 2 sin(k X), and with v = 0 instead velocities are late by half a step.
//!
//! Implicit steps are halved on one grid. Explicit ones are bound by the grid, and what a step maps to the points and
//! back it smooths, at a rate of dt h^2: cells are halved with them, and the error is that against the exact bar.

use std::f64::consts::PI;

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    measure::{mean, order},
    reference::Reference,
    setup::{Run, keys, rectangle},
};
use crate::{
    body::Body,
    effect::{BodyForce, Effect},
};

/// See the module.
pub struct TimeOrder;

/// The implicit integrators, by key of their answer and `implicit.regime`.
const IMPLICIT: [(&str, &str); 3] = [("newmark", "newmark"), ("hht", "hht"), ("backward_euler", "backward_euler")];

/// The explicit ones: key and `explicit.stress_update`.
const EXPLICIT: [(&str, &str); 2] = [("usl", "usl"), ("musl", "musl")];

impl Problem for TimeOrder {
    fn name(&self) -> &'static str {
        "time-order"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/time-order/case.toml"),
            reference: include_str!("../../../validation/time-order/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let bar = Bar::read(reference)?;
        let halvings = if effort == Effort::Full { 4 } else { 3 };
        let mut figure = Figure::convergence(
            "Error of the displacement over the time step",
            "implicit: steps halved on one grid, error against the limit of small steps on it; explicit: cells halved with the steps, error against the exact bar; late start: what it changes if velocities start with the positions",
            "time step (s)",
            "error of the mean displacement, relative",
        );
        for (key, regime) in IMPLICIT {
            let errors = bar.on_one_grid(self.files().case, regime, halvings, report)?;
            report.row(reference, key, order(&errors))?;
            figure = figure.with(key.replace('_', " "), Kind::Marked, errors);
        }
        for (key, update) in EXPLICIT {
            let (errors, late) = bar.with_the_grid(self.files().case, update, halvings, report)?;
            report.row(reference, key, order(&errors))?;
            report.row(reference, &format!("{key}_late"), order(&late))?;
            figure = figure.with(update.to_uppercase(), Kind::Marked, errors);
            figure = figure.with(format!("{}, late start", update.to_uppercase()), Kind::Marked, late);
        }
        report.figure(figure.with_slope(1).with_slope(2));
        Ok(())
    }
}

/// Errors over steps (s), of two kinds.
type Both = (Vec<(f64, f64)>, Vec<(f64, f64)>);

struct Bar {
    /// L (m).
    length: f64,
    /// g (m/s2).
    force: f64,
    /// w (rad/s).
    frequency: f64,
    /// Time at which the displacement is read (s).
    time: f64,
}

impl Bar {
    fn read(reference: &Reference) -> Result<Self, String> {
        Ok(Bar {
            length: reference.given("length")?,
            force: reference.given("force")?,
            frequency: reference.given("frequency")?,
            time: reference.given("time")?,
        })
    }

    /// Errors against the limit of the grid, which the steps beyond the last error give: of dt^2, Richardson's from
    /// the last two; backward Euler's of dt and dt^2 from the last three.
    fn on_one_grid(
        &self,
        text: &str,
        regime: &str,
        halvings: usize,
        report: &mut Report,
    ) -> Result<Vec<(f64, f64)>, String> {
        let steps: Vec<f64> = (0..halvings + 2).map(|k| self.time / f64::from(20u32 << k)).collect();
        let mut values = Vec::new();
        for &dt in &steps {
            let set = [
                ("solver.scheme", "implicit".to_owned()),
                ("implicit.regime", regime.to_owned()),
                ("implicit.time_step", format!("{dt:?}")),
            ];
            values.push(self.displacement(text, &keys(&set), 1.0, 0.0, report)?);
        }
        let [.., a, b, c] = values[..] else { return Err("too few steps".into()) };
        let limit = if regime == "backward_euler" { (a - 6.0 * b + 8.0 * c) / 3.0 } else { c + (c - b) / 3.0 };
        let error = |value: f64| (value / limit - 1.0).abs();
        Ok(steps.iter().zip(&values).take(halvings).map(|(dt, value)| (*dt, error(*value))).collect())
    }

    /// Errors against the exact bar, cells being halved with the steps; and what it changes if velocities start with
    /// the positions.
    fn with_the_grid(&self, text: &str, update: &str, halvings: usize, report: &mut Report) -> Result<Both, String> {
        let (mut errors, mut late) = (Vec::new(), Vec::new());
        for k in 0..halvings {
            let h = 2.5 / f64::from(1u32 << k);
            let dt = self.time / f64::from(40u32 << k);
            let set = keys(&[("explicit.stress_update", update.to_owned()), ("explicit.time_step", format!("{dt:?}"))]);
            let found = self.displacement(text, &set, h, 0.5 * dt, report)?;
            let unstaggered = self.displacement(text, &set, h, 0.0, report)?;
            errors.push((dt, (found / self.exact() - 1.0).abs()));
            late.push((dt, ((unstaggered - found) / self.exact()).abs()));
        }
        Ok((errors, late))
    }

    /// Mean of u over the bar (m): that of sin(k X) is 2 / pi.
    fn exact(&self) -> f64 {
        let w = self.frequency;
        2.0 / PI * self.force / (w * w) * (1.0 - (w * self.time).cos())
    }

    /// Mean displacement (m) with cells of `h` (m) and velocities that start `lag` (s) before the positions.
    fn displacement(&self, text: &str, set: &[String], h: f64, lag: f64, report: &mut Report) -> Result<f64, String> {
        let mut all = keys(&[
            ("grid.cell", format!("{h:?}")),
            ("grid.size", format!("[{:?}, {h:?}]", self.length + h)),
            ("region.bar.polygon", rectangle([0.0, 0.0], [self.length, h])),
        ]);
        all.extend_from_slice(set);
        let mut run = Run::adding(text, &all, &|body| self.pull(lag, body))?;
        run.until(self.time, |_| ())?;
        report.count(&run.sim);
        let mut way = vec![[0.0; 2]; run.sim.body.len()];
        run.sim.body.displacements(&mut way);
        Ok(mean(way.iter().map(|u| u[0])))
    }

    fn pull(&self, lag: f64, body: &mut Body) -> Vec<Box<dyn Effect>> {
        let (force, number) = (self.force, 0.5 * PI / self.length);
        let field = move |x: [f64; 2], _: f64| [force * (number * x[0]).sin(), 0.0];
        for i in 0..body.len() {
            body.committed.v[0][i] = -lag * field(body.reference(i), 0.0)[0];
        }
        vec![Box::new(BodyForce::new(field))]
    }
}
