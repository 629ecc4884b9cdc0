//! Rigid motions of a disc.

use nalgebra::Vector2;

use super::{
    Effort, Files, Problem, Report,
    measure::{largest, mean, order},
    patch::strain,
    reference::Reference,
    setup::{Run, keys},
};
use crate::{math::tensor::Voigt, sim::Simulation, work::Work};

/// See the module.
pub struct Rigid;

/// Every stress update with every strain measure.
const WAYS: [(&str, &str); 4] = [("musl", "hencky"), ("musl", "rate"), ("usl", "hencky"), ("usl", "rate")];

impl Problem for Rigid {
    fn name(&self) -> &'static str {
        "rigid"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/rigid/case.toml"),
            reference: include_str!("../../../validation/rigid/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for way in WAYS {
            self.translation(way, reference, report)?;
            self.fall(way, reference, report)?;
        }
        self.prescribed_turn(effort, reference, report)?;
        let spun = if effort == Effort::Short { &WAYS[..1] } else { &WAYS[..] };
        for &way in spun {
            self.spin(way, effort, reference, report)?;
        }
        let slow = self.turn(WAYS[0], 0.25, &[("explicit.pic_rate", "0.5".into())], report)?;
        report.row(reference, "spin_pic", slow.lost)?;
        for (shape, transfer) in [("bspline", "flip"), ("linear", "apic"), ("bspline", "apic"), ("bspline", "xpic")] {
            let set = [("solver.shape", shape.to_owned()), ("solver.transfer", transfer.to_owned())];
            let turn = self.turn(WAYS[0], 0.25, &set, report)?;
            let name = format!("{shape} {transfer}");
            report.row_of(reference, "spin_momentum", &name, None, turn.lost.abs())?;
            report.row_of(reference, "spin_stress", &name, None, turn.stress_error)?;
        }
        Ok(())
    }
}

fn named((update, kinematics): (&str, &str)) -> String {
    format!("{} {kinematics}", update.to_uppercase())
}

impl Rigid {
    fn disc(&self, (update, kinematics): (&str, &str), more: &[(&str, String)]) -> Result<Run, String> {
        let mut set = vec![("explicit.stress_update", update.to_owned()), ("solver.kinematics", kinematics.to_owned())];
        set.extend_from_slice(more);
        Run::new(self.files().case, &keys(&set))
    }

    fn translation(&self, way: (&str, &str), reference: &Reference, report: &mut Report) -> Result<(), String> {
        let v = [reference.given("speed_x")?, reference.given("speed_y")?];
        let mut run = self.disc(way, &[("region.disc.velocity", format!("{v:?}"))])?;
        let before = run.sim.body.momentum();
        run.until(reference.given("time")?, |_| ())?;
        let after = run.sim.body.momentum();
        report.count(&run.sim);
        let name = format!("translation, {}", named(way));
        report.row_of(reference, "stress", &name, None, largest_stress(&run))?;
        let change = (after[0] - before[0]).hypot(after[1] - before[1]) / before[0].hypot(before[1]);
        report.row_of(reference, "momentum", &name, None, change)
    }

    fn fall(&self, way: (&str, &str), reference: &Reference, report: &mut Report) -> Result<(), String> {
        let dt = 1.0 / 1024.0;
        let mut run =
            self.disc(way, &[("gravity.schedule", "at_once".into()), ("explicit.time_step", format!("{dt:?}"))])?;
        run.until(reference.given("time")?, |_| ())?;
        let (t, g) = (run.sim.time, run.case.gravity.acceleration);
        let mut way_down = vec![[0.0; 2]; run.sim.body.len()];
        run.sim.body.displacements(&mut way_down);
        let fallen = -mean(way_down.iter().map(|u| u[1]));
        report.count(&run.sim);
        let name = named(way);
        let velocity = -run.sim.body.momentum()[1] / run.sim.initial_mass;
        report.row_of(reference, "fall_velocity", &name, None, velocity / (g * t))?;
        report.row_of(reference, "fall_position", &name, None, (fallen - 0.5 * g * t * t) / (0.5 * g * t * dt))?;
        report.row_of(reference, "stress", &format!("free fall, {name}"), None, largest_stress(&run))
    }

    /// One turn at 1 rad/s with the exact velocity at the nodes and points that stay where they
    /// are: what the strain measure alone makes of a rotation.
    fn prescribed_turn(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let steps: &[usize] = if effort == Effort::Short { &[200, 400] } else { &[200, 400, 800, 1600] };
        let mut errors = Vec::new();
        for &n in steps {
            let dt = std::f64::consts::TAU / n as f64;
            let hencky = self.turned("hencky", n, dt, report)?;
            let log = 0.5 * n as f64 * (dt * dt).ln_1p();
            let (lambda, shear) = (1000.0 * 0.3 / (1.3 * 0.4), 1000.0 / 2.6);
            let exact = (2.0 * lambda + 2.0 * shear) * log * (-2.0 * log).exp();
            let name = format!("{n} steps");
            report.row_of(reference, "kernel_stress", &name, None, hencky / exact)?;
            errors.push((dt, log));
            let rate = self.turned("rate", n, dt, report)?;
            report.row_of(reference, "kernel_rate", &name, None, rate / 1000.0)?;
        }
        report.row(reference, "kernel_order", order(&errors))
    }

    /// sigma_xx (kPa) of the point with the largest.
    fn turned(&self, kinematics: &str, n: usize, dt: f64, report: &mut Report) -> Result<f64, String> {
        let mut run = self.disc(("musl", kinematics), &[])?;
        for _ in 0..n {
            strain(&mut run, dt, |x| Vector2::new(-x[1], x[0]))?;
        }
        let (steps, points) = (n as u64, run.sim.body.len() as u64);
        report.count_work(&Work { steps, particle_steps: steps * points, ..Work::default() });
        Ok(largest(run.sim.snapshot().stress.iter().map(|s| s.xx.abs())))
    }

    fn spin(
        &self,
        way: (&str, &str),
        effort: Effort,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        let cells: &[f64] = if effort == Effort::Short { &[0.25, 0.125] } else { &[0.25, 0.125, 0.0625] };
        let mut losses = Vec::new();
        for &h in cells {
            let turn = self.turn(way, h, &[], report)?;
            let name = format!("{}, h = {h} m", named(way));
            report.row_of(reference, "spin_momentum", &name, None, turn.lost.abs())?;
            report.row_of(reference, "spin_stress", &name, None, turn.stress_error)?;
            losses.push((h, turn.lost));
        }
        report.row_of(reference, "spin_order", &named(way), None, order(&losses))
    }

    /// One turn of a disc that starts with its exact stress.
    fn turn(&self, way: (&str, &str), h: f64, more: &[(&str, String)], report: &mut Report) -> Result<Turn, String> {
        let spin = "{ rate = 1.0, center = [0.0, 0.0] }".to_owned();
        let motion = [("grid.cell", format!("{h:?}")), ("region.disc.spin", spin)];
        let mut run = self.disc(way, &[&motion, more].concat())?;
        stress_as_spinning(&mut run);
        let before = angular_momentum(&run.sim);
        run.until(std::f64::consts::TAU, |_| ())?;
        report.count(&run.sim);
        Ok(Turn { lost: 1.0 - angular_momentum(&run.sim) / before, stress_error: stress_error(&run) })
    }
}

struct Turn {
    /// Fraction of the angular momentum.
    lost: f64,
    /// Rms error of stress over the largest stress.
    stress_error: f64,
}

fn largest_stress(run: &Run) -> f64 {
    let young = run.case.material["disc"].elastic().young_modulus;
    largest(run.sim.snapshot().stress.iter().map(|s| s.dot(*s).sqrt())) / young
}

/// sum m x cross v (kN m s/m).
fn angular_momentum(sim: &Simulation) -> f64 {
    let (m, s) = (&sim.body.mass, &sim.body.committed);
    (0..m.len()).map(|i| m[i] * (s.x[0][i] * s.v[1][i] - s.x[1][i] * s.v[0][i])).sum()
}

/// Stress (kPa) of a solid cylinder, rho = omega = R = 1, nu = 0.3, in plane strain:
/// ```text
/// sigma_r = k (3 - 2 nu)(1 - r^2),   sigma_t = k ((3 - 2 nu) - (1 + 2 nu) r^2),   k = 1 / 8 (1 - nu)
/// ```
fn spinning(x: [f64; 2]) -> Voigt {
    let (nu, r2) = (0.3, (x[0] * x[0] + x[1] * x[1]).min(1.0));
    let k = 1.0 / (8.0 * (1.0 - nu));
    let (radial, hoop) = (k * (3.0 - 2.0 * nu) * (1.0 - r2), k * ((3.0 - 2.0 * nu) - (1.0 + 2.0 * nu) * r2));
    let (sin, cos) = x[1].atan2(x[0]).sin_cos();
    Voigt::new(
        radial * cos * cos + hoop * sin * sin,
        radial * sin * sin + hoop * cos * cos,
        nu * (radial + hoop),
        (radial - hoop) * sin * cos,
    )
}

/// Gives each point the elastic strain of the stress it has while spinning.
pub(super) fn stress_as_spinning(run: &mut Run) {
    let e = run.case.material["disc"].elastic();
    let law = crate::material::Elasticity::from_young(e.young_modulus, e.poisson_ratio);
    let state = &mut run.sim.body.committed;
    for i in 0..state.jacobian.len() {
        let strain = law.strain(spinning([state.x[0][i], state.x[1][i]])).to_array();
        state.strain.iter_mut().zip(strain).for_each(|(column, value)| column[i] = value);
    }
}

fn stress_error(run: &Run) -> f64 {
    let s = run.sim.snapshot();
    let gap = |i: usize| s.stress[i] - spinning(s.position[i]);
    let centre = spinning([0.0; 2]);
    (mean((0..s.len()).map(|i| gap(i).dot(gap(i)))) / centre.dot(centre)).sqrt()
}
