//! The first axial mode of a bar.
//!
//! With k = pi / 2 L and points at 1/4 and 3/4 of each cell, the linearised MUSL step has
//! ```text
//! omega_h^2 = (2 c / h)^2 sin^2(kh/2) (5/8 + 3/8 cos kh),   sin(omega dt / 2) = omega_h dt / 2
//! omega = c k (1 - (1/24 + 3/32) (kh)^2 + (omega dt)^2 / 24 + ...)
//! ```
//! the bracket being the eigenvalue of M^-1 Mc (see `operator`).

use std::f64::consts::PI;

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    measure::{largest, mean, order},
    reference::Reference,
    setup::{Run, keys, rectangle},
};

/// See the module.
pub struct VibratingBar;

impl Problem for VibratingBar {
    fn name(&self) -> &'static str {
        "vibrating-bar"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/vibrating-bar/case.toml"),
            reference: include_str!("../../../validation/vibrating-bar/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let text = self.files().case;
        let bar = Bar::read(reference)?;
        let trace = bar.trace(Run::new(text, &[])?, report)?;
        report.figure(bar.velocities(&trace));
        report.row(reference, "frequency", trace.frequency())?;
        report.row(reference, "amplitude", trace.amplitude(bar.omega))?;
        report.row(reference, "drift", trace.drift(bar.period()))?;
        report.row(reference, "swing", trace.swing(bar.period()))?;
        bar.convergence(text, effort, reference, report)?;
        let usl = bar.trace(Run::new(text, &keys(&[("explicit.stress_update", "usl".into())]))?, report)?;
        report.row(reference, "usl_drift", usl.drift(bar.period()))?;
        let newmark = [
            ("solver.scheme", "implicit"),
            ("implicit.regime", "newmark"),
            ("implicit.time_step", "0.05"),
            ("implicit.pic_rate", "0.0"),
        ];
        let newmark = keys(&newmark.map(|(key, value)| (key, value.to_owned())));
        let implicit = bar.trace(Run::new(text, &newmark)?, report)?;
        report.row(reference, "newmark_frequency", implicit.frequency())?;
        report.row(reference, "newmark_drift", implicit.drift(bar.period()))
    }
}

struct Bar {
    length: f64,
    periods: f64,
    omega: f64,
    /// Of the mean velocity (m/s).
    amplitude: f64,
}

impl Bar {
    fn read(reference: &Reference) -> Result<Self, String> {
        Ok(Bar {
            length: reference.given("length")?,
            periods: reference.given("periods")?,
            omega: reference.exact("frequency")?,
            amplitude: reference.exact("amplitude")?,
        })
    }

    fn period(&self) -> f64 {
        2.0 * PI / self.omega
    }

    fn trace(&self, mut run: Run, report: &mut Report) -> Result<Trace, String> {
        let mut trace = Trace::default();
        let mass = run.sim.initial_mass;
        trace.time.push(0.0);
        trace.velocity.push(run.sim.body.momentum()[0] / mass);
        trace.energy.push(run.energy());
        run.until(self.periods * self.period(), |sim| {
            let e = sim.energies();
            trace.time.push(sim.time);
            trace.velocity.push(sim.body.momentum()[0] / mass);
            trace.energy.push(e.kinetic + e.strain);
        })?;
        report.count(&run.sim);
        Ok(trace)
    }

    /// Of the centre of mass over the first two periods.
    fn velocities(&self, trace: &Trace) -> Figure {
        let first = || trace.time.iter().copied().filter(|t| *t <= 2.0 * self.period());
        let exact = |t: f64| (t, self.amplitude * (self.omega * t).cos());
        Figure::new(
            "Vibrating bar: velocity of the centre of mass",
            "explicit, MUSL, h = 1 m; the first two of ten periods",
            "time (s)",
            "velocity (m/s)",
        )
        .with("ours", Kind::Line, first().zip(trace.velocity.iter().copied()).collect())
        .with("exact", Kind::Exact, first().map(exact).collect())
    }

    /// Small amplitude, h halved again and again with dt ~ h.
    fn convergence(
        &self,
        text: &str,
        effort: Effort,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        let cells: &[usize] = match effort {
            Effort::Short => &[5, 10, 20],
            Effort::Full => &[5, 10, 20, 40, 80],
        };
        let mut errors = Vec::new();
        for &n in cells {
            let h = self.length / n as f64;
            let run = Run::new(text, &self.refined(h))?;
            let trace = self.trace(run, report)?;
            let (kh, dt) = (0.5 * PI / n as f64, trace.time[1]);
            let error = trace.frequency() / self.omega - 1.0;
            let leading = (self.omega * dt).powi(2) / 24.0 - (1.0 / 24.0 + 3.0 / 32.0) * kh * kh;
            report.note(format!("h = {h:.4} m: frequency error {error:.3e}, predicted {leading:.3e}"));
            errors.push((h, error, error / leading));
        }
        let fitted: Vec<_> = errors.iter().map(|&(h, error, _)| (h, error)).collect();
        report.row(reference, "order", order(&fitted))?;
        let figure = Figure::convergence(
            "Vibrating bar: error of the frequency",
            "explicit, MUSL, dt in proportion to h",
            "cell (m)",
            "error, relative",
        );
        let points = fitted.iter().map(|(h, error)| (*h, error.abs())).collect();
        report.figure(figure.with("ours", Kind::Marked, points).with_slope(2));
        // the ratio tends to 1 with h: extrapolated from the last two, of which one is half the other
        let ratio = errors.windows(2).last().map_or(f64::NAN, |e| 2.0 * e[1].2 - e[0].2);
        report.row(reference, "leading", ratio)
    }

    fn refined(&self, h: f64) -> Vec<String> {
        keys(&[
            ("grid.cell", format!("{h:?}")),
            ("grid.size", format!("[{:?}, {h:?}]", self.length + h)),
            ("region.bar.polygon", rectangle([0.0, 0.0], [self.length, h])),
            ("region.bar.wave.amplitude", "[1e-4, 0.0]".into()),
        ])
    }
}

/// A run over time.
#[derive(Default)]
struct Trace {
    time: Vec<f64>,
    /// Of the centre of mass (m/s).
    velocity: Vec<f64>,
    /// Kinetic and strain (kJ/m).
    energy: Vec<f64>,
}

impl Trace {
    /// Half turns between the first and the last zero of the velocity, over the time between.
    fn frequency(&self) -> f64 {
        let pairs = (1..self.time.len()).filter(|&i| self.velocity[i - 1] * self.velocity[i] < 0.0);
        let zeros: Vec<f64> = pairs.map(|i| self.zero_before(i)).collect();
        match (zeros.first(), zeros.last()) {
            (Some(first), Some(last)) if last > first => PI * (zeros.len() - 1) as f64 / (last - first),
            _ => f64::NAN,
        }
    }

    fn zero_before(&self, i: usize) -> f64 {
        let (a, b) = (self.velocity[i - 1], self.velocity[i]);
        self.time[i - 1] + (self.time[i] - self.time[i - 1]) * a / (a - b)
    }

    /// Projection of the velocity on cos(omega t) and sin(omega t).
    fn amplitude(&self, omega: f64) -> f64 {
        let project = |f: fn(f64) -> f64| {
            let sum: f64 = self.steps().map(|i| self.velocity[i] * f(omega * self.time[i]) * self.dt(i)).sum();
            2.0 * sum / self.time.last().copied().unwrap_or(f64::NAN)
        };
        project(f64::cos).hypot(project(f64::sin))
    }

    fn steps(&self) -> impl Iterator<Item = usize> {
        1..self.time.len()
    }

    fn dt(&self, i: usize) -> f64 {
        self.time[i] - self.time[i - 1]
    }

    /// Mean energy of the last period against the first, over the energy at the start.
    fn drift(&self, period: f64) -> f64 {
        let end = self.time.last().copied().unwrap_or(f64::NAN);
        let between = |a: f64, b: f64| {
            mean(self.steps().filter(|&i| self.time[i] > a && self.time[i] <= b).map(|i| self.energy[i]))
        };
        (between(end - period, end) - between(0.0, period)) / self.energy[0]
    }

    /// Largest departure from the mean in the first period, over the energy at the start.
    fn swing(&self, period: f64) -> f64 {
        let first: Vec<f64> = self.steps().filter(|&i| self.time[i] <= period).map(|i| self.energy[i]).collect();
        let middle = mean(first.iter().copied());
        largest(first.iter().map(|e| (e - middle).abs())) / self.energy[0]
    }
}
