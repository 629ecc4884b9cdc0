//! A flat, stiff block on a frictional plane.

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    limit::last_equilibrium,
    measure::{bisect, mean},
    reference::Reference,
    setup::{Run, keys},
};
use crate::case::{GravitySchedule, Side};

/// See the module.
pub struct Incline;

impl Problem for Incline {
    fn name(&self) -> &'static str {
        "incline"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/incline/case.toml"),
            reference: include_str!("../../../validation/incline/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let cells: &[f64] = match effort {
            Effort::Short => &[0.5],
            Effort::Full => &[0.5, 0.25],
        };
        for &h in cells {
            for factor in [1.5, 2.0] {
                self.slide(Scheme::Explicit, h, factor, reference, report)?;
                for inertia in ["newmark", "hht", "backward_euler"] {
                    self.slide(Scheme::Implicit(inertia), h, factor, reference, report)?;
                }
            }
            self.threshold(h, reference, report)?;
            self.still_threshold(h, reference, report)?;
            self.rest(h, reference, report)?;
        }
        Ok(())
    }
}

impl Incline {
    fn tilted(&self, scheme: Scheme, h: f64, tangent: f64, more: &[String]) -> Result<Block, String> {
        let tilt = tangent.atan().to_degrees();
        let mut set = keys(&[("grid.cell", format!("{h:?}")), ("gravity.tilt", format!("{tilt:?}"))]);
        if let Scheme::Implicit(regime) = scheme {
            set.extend(keys(&[("solver.scheme", "implicit".into()), ("implicit.regime", regime.into())]));
        }
        set.extend_from_slice(more);
        Block::new(Run::new(self.files().case, &set)?)
    }

    fn slide(
        &self,
        scheme: Scheme,
        h: f64,
        factor: f64,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        let mut block = self.tilted(scheme, h, 0.4 * factor, &[])?;
        block.run.until(block.full_pull + reference.given("first")?, |_| ())?;
        let (t, v) = (block.run.sim.time, block.velocity());
        let mut trace = vec![(t, v)];
        block.run.until(block.full_pull + reference.given("last")?, |sim| {
            trace.push((sim.time, sim.body.momentum()[0] / sim.initial_mass));
        })?;
        let ours = (block.velocity() - v) / (block.run.sim.time - t);
        report.count(&block.run.sim);
        let name = format!("tan t = {factor} mu, h = {h} m{}", scheme.name());
        let exact = block.sliding_acceleration();
        if matches!(scheme, Scheme::Explicit | Scheme::Implicit("newmark")) {
            report.figure(sliding(&name, trace, exact));
        }
        report.row_of(reference, "acceleration", &name, Some(exact), ours)?;
        report.row_of(reference, "gap", &name, None, block.way()[1] / h)
    }

    /// A block on the level, never damped, for five times the ramp.
    fn rest(&self, h: f64, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let set =
            [("grid.cell", format!("{h:?}")), ("gravity.tilt", "0.0".into()), ("gravity.settle_damping", "0.0".into())];
        let mut block = Block::new(Run::new(self.files().case, &keys(&set))?)?;
        let level = block.full_pull;
        block.run.until(0.5 * level, |_| ())?;
        let settled = block.way()[1];
        block.run.until(5.0 * level, |_| ())?;
        report.count(&block.run.sim);
        report.row_of(reference, "rise", &format!("h = {h} m"), None, (block.way()[1] - settled) / settled.abs())
    }

    fn threshold(&self, h: f64, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let tangent = self.steepest_watched(h, &[], reference, report)?;
        report.row_of(reference, "threshold", &format!("h = {h} m"), None, tangent)
    }

    fn still_threshold(&self, h: f64, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let tangent = self.steepest_still(h, &[], reference, report)?;
        report.row_of(reference, "still_threshold", &format!("h = {h} m"), None, tangent)
    }

    /// Steepest tangent at which the block has not slid: bisection to a tenth of the tolerance.
    pub(super) fn steepest_watched(
        &self,
        h: f64,
        more: &[String],
        reference: &Reference,
        report: &mut Report,
    ) -> Result<f64, String> {
        let watch = reference.given("watch")?;
        let mu = reference.exact("threshold")?;
        bisect(0.97 * mu, 1.03 * mu, 5e-4, |tangent| {
            let mut block = self.tilted(Scheme::Explicit, h, tangent, more)?;
            block.run.until(block.full_pull + watch, |_| ())?;
            report.count(&block.run.sim);
            Ok(!block.has_slid())
        })
    }

    /// Without inertia: the pull grows on an incline that is a little too steep, in steps that are halved until
    /// none finds equilibrium.
    pub(super) fn steepest_still(
        &self,
        h: f64,
        more: &[String],
        reference: &Reference,
        report: &mut Report,
    ) -> Result<f64, String> {
        let tangent = 1.05 * reference.exact("still_threshold")?;
        let mut block = self.tilted(Scheme::Implicit("quasi_static"), h, tangent, more)?;
        let bracket = last_equilibrium(&mut block.run)?.ok_or("a block that should slide is in equilibrium")?;
        report.count(&block.run.sim);
        let share = |time: f64| 1.0 - (block.full_pull - time) / block.pull_time;
        Ok(tangent * 0.5 * (share(bracket.holds) + share(bracket.fails)))
    }
}

/// Velocity over time, beside one that grows as it should from the first on.
fn sliding(name: &str, trace: Vec<(f64, f64)>, acceleration: f64) -> Figure {
    let first = trace.first().copied().unwrap_or((f64::NAN, f64::NAN));
    let last = trace.last().map_or(f64::NAN, |p| p.0);
    let exact = vec![first, (last, first.1 + acceleration * (last - first.0))];
    Figure::new(
        &format!("Sliding block: {name}"),
        "mean velocity along the plane while gravity acts in full",
        "time (s)",
        "velocity (m/s)",
    )
    .with("ours", Kind::Line, trace)
    .with("g (sin t - mu cos t)", Kind::Exact, exact)
}

/// How time is stepped.
#[derive(Clone, Copy)]
enum Scheme {
    Explicit,
    /// With a regime.
    Implicit(&'static str),
}

impl Scheme {
    fn name(self) -> String {
        match self {
            Scheme::Explicit => String::new(),
            Scheme::Implicit(regime) => format!(", {regime}"),
        }
    }
}

struct Block {
    run: Run,
    /// Time from which gravity acts in full (s).
    full_pull: f64,
    /// Time over which the part along the plane grows (s).
    pull_time: f64,
    mu: f64,
}

impl Block {
    fn new(run: Run) -> Result<Self, String> {
        let GravitySchedule::NormalFirst { ramp_time, settle_time, tangential_time, .. } = run.case.gravity.schedule
        else {
            return Err("the incline needs gravity.schedule = \"normal_first\"".into());
        };
        let Side::Friction { coefficient, .. } = run.case.boundary.base else {
            return Err("the incline needs a frictional base".into());
        };
        let full_pull = ramp_time + settle_time + tangential_time;
        Ok(Block { full_pull, pull_time: tangential_time, mu: coefficient, run })
    }

    /// Of the centre of mass, along the plane (m/s).
    fn velocity(&self) -> f64 {
        self.run.sim.body.momentum()[0] / self.run.sim.initial_mass
    }

    /// g (sin t - mu cos t).
    fn sliding_acceleration(&self) -> f64 {
        let (sin, cos) = self.run.case.gravity.tilt.to_radians().sin_cos();
        self.run.case.gravity.acceleration * (sin - self.mu * cos)
    }

    /// Whether the block has moved ten times as far as its elastic shear, rho g sin t H^2 / 3 G
    /// in the mean: at an excess of 0.05 % it does so within 2 s.
    fn has_slid(&self) -> bool {
        let e = self.run.case.material["stiff"].elastic();
        let g = e.young_modulus / (2.0 * (1.0 + e.poisson_ratio));
        let shear = e.unit_weight * self.run.case.gravity.tilt.to_radians().sin() / (3.0 * g);
        self.way()[0] > 10.0 * shear
    }

    /// Mean displacement (m).
    fn way(&self) -> [f64; 2] {
        let mut way = vec![[0.0; 2]; self.run.sim.body.len()];
        self.run.sim.body.displacements(&mut way);
        [0, 1].map(|a| mean(way.iter().map(|u| u[a])))
    }
}
