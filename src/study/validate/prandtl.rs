//! Prandtl's strip footing on weightless, perfectly plastic clay.
//!
//! The force on a footing that is driven down is the rate of its work: F = dW / dw, with the work that the drive
//! books from the reactions of its nodes. It needs no stress and no integration over the surface.
//!
//! **Width.** A node stands for half a cell to either side: 2 n + 1 nodes, h apart, carry what
//! presses on B + h. Between the last driven node and the next one the velocity falls linearly, and
//! half of that cell goes along. The pressure is F / (B + h); F / B is printed beside it. Both tend to the same limit.

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    reference::Reference,
    setup::{Run, keys},
};

/// See the module.
pub struct Prandtl;

/// B / h from which the pressure is judged.
const FINE: u32 = 32;

/// Half the width of the footing (m).
const HALF: f64 = 1.0;

impl Problem for Prandtl {
    fn name(&self) -> &'static str {
        "prandtl"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/prandtl/case.toml"),
            reference: include_str!("../../../validation/prandtl/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let sizes: &[u32] = match effort {
            Effort::Short => &[8, 16],
            Effort::Full => &[8, 16, 32],
        };
        for rough in [false, true] {
            let mut nominal = Vec::new();
            for &cells in sizes {
                nominal.push(self.footing(Setup { cells, rough, cure: true }, reference, report)?);
            }
            // the error is of first order: from the last two grids, of which one is half the other
            let limit = nominal.windows(2).last().map_or(f64::NAN, |p| 2.0 * p[1] - p[0]);
            let name = if rough { "rough" } else { "smooth" };
            report.row_of(reference, "extrapolated", name, None, limit)?;
        }
        for &cells in sizes {
            self.footing(Setup { cells, rough: false, cure: false }, reference, report)?;
        }
        Ok(())
    }
}

#[derive(Clone, Copy)]
pub(super) struct Setup {
    /// B / h.
    pub cells: u32,
    pub rough: bool,
    pub cure: bool,
}

impl Setup {
    fn h(self) -> f64 {
        2.0 * HALF / f64::from(self.cells)
    }

    fn name(self) -> String {
        let surface = if self.rough { "rough" } else { "smooth" };
        format!("{surface}, B/h = {}", self.cells)
    }

    fn keys(self) -> Vec<String> {
        let locking = if self.cure { "b_bar" } else { "none" };
        let mut set = keys(&[("grid.cell", format!("{:?}", self.h())), ("solver.locking", locking.into())]);
        if self.rough {
            set.extend(keys(&[("drive.footing.velocity_x", "0.0".into())]));
        }
        set
    }
}

impl Prandtl {
    /// F / B / c.
    pub(super) fn footing(&self, setup: Setup, reference: &Reference, report: &mut Report) -> Result<f64, String> {
        let mut run = Run::new(self.files().case, &setup.keys())?;
        let speed = run.case.drive.first().and_then(|d| d.velocity_y).ok_or("there is no footing")?;
        let strength = reference.given("cohesion")?;
        let forces = forces(&mut run, -speed)?;
        report.count(&run.sim);
        let at = |share: f64| forces.get((share * forces.len() as f64) as usize - 1).copied().unwrap_or(f64::NAN);
        let (limit, before) = (at(1.0), at(0.8));
        if setup.cure && !setup.rough {
            report.figure(settling(setup, &forces, strength, reference.exact("pressure")?));
        }
        let name = setup.name();
        let pressure = |width: f64| limit / (strength * width);
        let key = match (setup.cure, setup.cells >= FINE) {
            (true, true) => "pressure",
            (true, false) => "coarse",
            (false, _) => "locked",
        };
        report.row_of(reference, key, &name, None, pressure(HALF + 0.5 * setup.h()))?;
        report.row_of(reference, "nominal", &format!("{name}{}", cured(setup)), None, pressure(HALF))?;
        if setup.cure {
            report.row_of(reference, "plateau", &name, None, limit / before - 1.0)?;
        }
        Ok(pressure(HALF))
    }
}

/// Pressure over settlement.
fn settling(setup: Setup, forces: &[f64], strength: f64, exact: f64) -> Figure {
    let width = HALF + 0.5 * setup.h();
    let share = |k: usize| (k + 1) as f64 / forces.len() as f64;
    let points = forces.iter().enumerate().map(|(k, f)| (share(k), f / (strength * width))).collect();
    Figure::new(
        &format!("Strip footing: pressure over settlement, {}", setup.name()),
        "small strain, mean dilatation; the limit is reached where the curve is level",
        "settlement over the last one",
        "F / (B + h) / c",
    )
    .with("ours", Kind::Line, points)
    .with("2 + pi", Kind::Exact, vec![(0.0, exact), (1.0, exact)])
}

fn cured(setup: Setup) -> &'static str {
    if setup.cure { "" } else { ", no cure" }
}

/// Force on half the footing after each step (kN/m).
fn forces(run: &mut Run, speed: f64) -> Result<Vec<f64>, String> {
    let (mut forces, mut before) = (Vec::new(), 0.0);
    run.until(run.case.end.time, |sim| {
        let work = sim.books().effects.external;
        forces.push((work - before) / (speed * sim.dt));
        before = work;
    })?;
    Ok(forces)
}
