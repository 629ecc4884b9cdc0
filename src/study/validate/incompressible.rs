//! A nearly incompressible block under its own weight: how far plain cells stiffen, and how the
//! pressure jumps from point to point.

use std::collections::BTreeMap;

use super::{
    Effort, Files, Problem, Report,
    measure::mean,
    reference::Reference,
    setup::{Run, keys},
};
use crate::snapshot::Snapshot;

/// See the module.
pub struct Incompressible;

impl Problem for Incompressible {
    fn name(&self) -> &'static str {
        "incompressible"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/incompressible/case.toml"),
            reference: include_str!("../../../validation/incompressible/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let (h, fine) = match effort {
            Effort::Short => (0.5, 0.25),
            Effort::Full => (0.5, 0.125),
        };
        for ratio in [0.3, 0.499] {
            let best = self.block(Setup { ratio, h: fine, locking: "b_bar" }, report)?;
            for locking in ["b_bar", "none"] {
                let setup = Setup { ratio, h, locking };
                let ours = self.block(setup, report)?;
                let cured = locking == "b_bar";
                let name = setup.name();
                let settlement = if cured { "settlement" } else { "locked" };
                report.row_of(reference, settlement, &name, None, ours.settlement / best.settlement)?;
                report.row_of(reference, if cured { "ripple" } else { "noise" }, &name, None, ours.ripple)?;
                report.row_of(reference, "board", &name, None, ours.board)?;
            }
            self.settle(Setup { ratio, h, locking: "b_bar" }, reference, report)?;
        }
        Ok(())
    }
}

#[derive(Clone, Copy)]
pub(super) struct Setup {
    /// Poisson's.
    pub ratio: f64,
    pub h: f64,
    pub locking: &'static str,
}

impl Setup {
    fn name(self) -> String {
        format!("nu = {}, h = {} m, {}", self.ratio, self.h, self.locking)
    }

    fn keys(self) -> Vec<String> {
        keys(&[
            ("grid.cell", format!("{:?}", self.h)),
            ("material.soil.poisson_ratio", format!("{:?}", self.ratio)),
            ("solver.locking", self.locking.into()),
        ])
    }
}

/// What is read.
pub(super) struct Reading {
    /// Mean settlement (m).
    pub settlement: f64,
    /// Jump of the pressure within cells, root mean square, over the mean pressure.
    ripple: f64,
    /// Mean pressure of a cell less that of its four neighbours, rms, over the mean pressure.
    board: f64,
}

/// Lowers the stiffness of the explicit runs: their steps are then longer. Strains stay below 1e-2.
const SOFT: f64 = 1e4;

impl Incompressible {
    /// In finite strain and with the softer soil: the implicit scheme, or the explicit one, damped to rest.
    pub(super) fn softly(&self, setup: Setup, scheme: &str, report: &mut Report) -> Result<Reading, String> {
        let mut set = setup.keys();
        set.extend(keys(&[
            ("material.soil.young_modulus", format!("{SOFT:?}")),
            ("solver.kinematics", "hencky".into()),
            ("solver.scheme", scheme.into()),
        ]));
        set.extend(match scheme {
            "explicit" => keys(&[("end.time", "4.0".into()), ("damping.local", "0.3".into())]),
            _ => keys(&[("implicit.time_step", "0.1".into())]),
        });
        self.run(&set, setup.h, report)
    }

    /// The explicit scheme beside the implicit one; and beside itself without the cure.
    fn settle(&self, setup: Setup, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let implicit = self.softly(setup, "implicit", report)?;
        let cured = self.softly(setup, "explicit", report)?;
        let locked = self.softly(Setup { locking: "none", ..setup }, "explicit", report)?;
        let name = format!("explicit, nu = {}, h = {} m", setup.ratio, setup.h);
        report.row_of(reference, "schemes", &name, None, cured.settlement / implicit.settlement)?;
        report.row_of(reference, "explicit_ripple", &format!("{name}, b_bar"), None, cured.ripple)?;
        report.row_of(
            reference,
            "explicit_locked",
            &format!("{name}, none"),
            None,
            locked.settlement / implicit.settlement,
        )?;
        report.row_of(reference, "noise", &format!("{name}, none"), None, locked.ripple)
    }

    pub(super) fn block(&self, setup: Setup, report: &mut Report) -> Result<Reading, String> {
        self.run(&setup.keys(), setup.h, report)
    }

    fn run(&self, set: &[String], h: f64, report: &mut Report) -> Result<Reading, String> {
        let mut run = Run::new(self.files().case, set)?;
        run.until(run.case.end.time, |_| ())?;
        report.count(&run.sim);
        let s = run.sim.snapshot();
        let cells = cells(&s, h);
        Ok(Reading {
            settlement: mean((0..s.len()).map(|i| -s.displacement(i)[1])),
            ripple: ripple(&cells),
            board: board(&cells),
        })
    }
}

/// Pressure of a point, p = -(sigma_xx + sigma_yy + sigma_zz) / 3 (kPa).
fn pressure(s: &Snapshot, i: usize) -> f64 {
    -(s.stress[i].xx + s.stress[i].yy + s.stress[i].zz) / 3.0
}

/// Pressures of the points (kPa) by cell.
type Cells = BTreeMap<[i64; 2], Vec<f64>>;

fn cells(s: &Snapshot, h: f64) -> Cells {
    let mut cells = Cells::new();
    for i in 0..s.len() {
        let cell = s.reference[i].map(|x| (x / h).floor() as i64);
        cells.entry(cell).or_default().push(pressure(s, i));
    }
    cells
}

fn middle(points: &[f64]) -> f64 {
    mean(points.iter().copied())
}

/// Mean of all points.
fn overall(cells: &Cells) -> f64 {
    mean(cells.values().flatten().copied())
}

/// Root mean square of the pressure about its mean in each cell, over the mean pressure.
fn ripple(cells: &Cells) -> f64 {
    let apart = cells.values().flat_map(|points| points.iter().map(|p| (p - middle(points)).powi(2)));
    mean(apart).sqrt() / overall(cells)
}

/// Root mean square of what the pressure of a cell differs from the mean of its four neighbours,
/// over the mean pressure: a chequerboard shows here.
fn board(cells: &Cells) -> f64 {
    let neighbours = |[x, y]: [i64; 2]| [[x - 1, y], [x + 1, y], [x, y - 1], [x, y + 1]];
    let apart = cells.iter().filter_map(|(cell, points)| {
        let near: Vec<f64> = neighbours(*cell).iter().filter_map(|c| cells.get(c)).map(|p| middle(p)).collect();
        (near.len() == 4).then(|| (middle(points) - middle(&near)).powi(2))
    });
    mean(apart).sqrt() / overall(cells)
}
