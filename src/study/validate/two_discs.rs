//! Two discs meet head on along the diagonal.

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    measure::order,
    reference::Reference,
    setup::{Run, keys},
};

/// See the module.
pub struct TwoDiscs;

impl Problem for TwoDiscs {
    fn name(&self) -> &'static str {
        "two-discs"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/two-discs/case.toml"),
            reference: include_str!("../../../validation/two-discs/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let cells: &[f64] = match effort {
            Effort::Short => &[0.1, 0.05],
            Effort::Full => &[0.1, 0.05, 0.025, 0.0125],
        };
        let mut leads = Vec::new();
        for &h in cells {
            let size = keys(&[("grid.cell", format!("{h:?}"))]);
            let collision = Collision::run(self.files().case, &size, report)?;
            let gap = reference.given("distance")? - 2.0 * reference.given("radius")?;
            let closing = reference.given("approach")?;
            let lead = gap - closing * collision.contact;
            report.note(format!(
                "h = {h} m: contact felt at {:.4} s, {:.2} cells early; smallest kinetic energy {:.4}, after {:.4}, lost {:.4}",
                collision.contact, lead / h, collision.minimum, collision.after, collision.lost
            ));
            leads.push((h, lead));
            if h == 0.05 {
                report.figure(collision.figure());
                collision.rows(reference, report)?;
                report.row(reference, "lead", lead / (h * std::f64::consts::SQRT_2))?;
            }
        }
        report.row(reference, "lead_order", order(&leads))?;
        self.implicit(reference, report)?;
        self.steps(reference, report)
    }
}

impl TwoDiscs {
    /// The same with average acceleration.
    fn implicit(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let set = [
            ("grid.cell", "0.05"),
            ("solver.scheme", "implicit"),
            ("implicit.regime", "newmark"),
            ("implicit.time_step", "0.01"),
            ("implicit.pic_rate", "0.0"),
        ];
        let set = keys(&set.map(|(key, value)| (key, value.to_owned())));
        let collision = Collision::run(self.files().case, &set, report)?;
        report.row(reference, "implicit_momentum", collision.momentum)?;
        report.row(reference, "implicit_minimum", collision.minimum)?;
        report.row(reference, "implicit_after", collision.after)
    }

    /// Energy error over shorter and shorter steps.
    fn steps(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let mut runs = Vec::new();
        for courant in [0.25, 0.125, 0.0625] {
            let c = Collision::run(self.files().case, &keys(&[("explicit.courant", format!("{courant}"))]), report)?;
            report
                .note(format!("courant = {courant}: energy lost {:.5}, largest gain on the way {:.5}", c.lost, c.gain));
            runs.push((courant, c));
        }
        let gains: Vec<_> = runs.iter().map(|(courant, c)| (*courant, c.gain)).collect();
        report.row(reference, "gain_order", order(&gains))?;
        let [.., (_, coarse), (_, fine)] = runs.as_slice() else { return Ok(()) };
        report.row(reference, "lost_at_zero", 2.0 * fine.lost - coarse.lost)
    }
}

/// What is read off one run; energies over the kinetic energy at the start.
struct Collision {
    before: f64,
    /// Time at which the kinetic energy has fallen by 0.1 % (s).
    contact: f64,
    minimum: f64,
    after: f64,
    lost: f64,
    gain: f64,
    momentum: f64,
    /// Kinetic energy over time (s).
    kinetic: Vec<(f64, f64)>,
    /// Strain energy over time (s).
    strain: Vec<(f64, f64)>,
}

impl Collision {
    fn run(text: &str, keys: &[String], report: &mut Report) -> Result<Self, String> {
        let mut run = Run::new(text, keys)?;
        let before = run.sim.body.kinetic_energy();
        let scale = run.sim.initial_mass * 0.1;
        let mut c = Collision {
            before,
            contact: f64::NAN,
            minimum: 1.0,
            after: 0.0,
            lost: 0.0,
            gain: 0.0,
            momentum: 0.0,
            kinetic: Vec::new(),
            strain: Vec::new(),
        };
        run.until(run.case.end.time, |sim| {
            let e = sim.energies();
            c.after = e.kinetic / before;
            c.kinetic.push((sim.time, c.after));
            c.strain.push((sim.time, e.strain / before));
            if c.after < 0.999 && c.contact.is_nan() {
                c.contact = sim.time;
            }
            c.minimum = c.minimum.min(c.after);
            c.lost = e.numerical / before;
            c.gain = c.gain.max(-c.lost);
            c.momentum = sim.body.momentum().iter().fold(c.momentum, |m, p| m.max(p.abs() / scale));
        })?;
        report.count(&run.sim);
        Ok(c)
    }

    fn figure(&self) -> Figure {
        Figure::new(
            "Two discs: energies",
            "explicit, MUSL, h = 0.05 m; after the impact the discs go on ringing",
            "time (s)",
            "energy over kinetic energy at the start",
        )
        .with("kinetic", Kind::Line, self.kinetic.clone())
        .with("strain", Kind::Line, self.strain.clone())
    }

    fn rows(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        report.row(reference, "kinetic_before", self.before)?;
        report.row(reference, "momentum", self.momentum)?;
        report.row(reference, "minimum", self.minimum)?;
        report.row(reference, "after", self.after)?;
        report.row(reference, "energy_error", self.lost)?;
        report.row(reference, "energy_gain", self.gain)
    }
}
