//! Points just past a node in the implicit scheme: the condition of the matrix, and what the ghost
//! penalty makes of it and of the stress.

use super::{
    Effort, Files, Problem, Report,
    measure::{largest, slope},
    reference::Reference,
    setup::{Run, keys},
};

/// See the module.
pub struct CutCell;

impl Problem for CutCell {
    fn name(&self) -> &'static str {
        "cut-cell"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/cut-cell/case.toml"),
            reference: include_str!("../../../validation/cut-cell/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let shifts: &[f64] = match effort {
            Effort::Short => &[1e-1, 1e-3, 1e-8],
            Effort::Full => &[1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8],
        };
        let whole = Setup { past: None, gamma: 0.0, mass: None, finite: false, steps: reference.given("steps")? };
        let uncut = self.stand(whole, reference, report)?;
        report.row(reference, "uncut", uncut.condition)?;
        report.row_of(reference, "error", "whole cells", Some(ERROR[0]), uncut.error)?;
        let bare = self.slide(whole, shifts, uncut.condition, reference, report)?;
        let ghosted = Setup { gamma: reference.given("gamma")?, ..whole };
        self.slide(ghosted, shifts, uncut.condition, reference, report)?;
        self.sweep(ghosted, &bare, uncut.condition, reference, report)?;
        self.move_on(whole, reference, report)
    }
}

/// One run.
#[derive(Clone, Copy)]
pub(super) struct Setup {
    /// Cells by which the last points lie past a node; `None` for a block on whole cells.
    pub past: Option<f64>,
    pub gamma: f64,
    /// gamma_M, in the regime with inertia.
    pub mass: Option<f64>,
    /// Finite strain.
    pub finite: bool,
    pub steps: f64,
}

/// What came out.
pub(super) struct Standing {
    pub condition: f64,
    /// Mean number of iterations of a step.
    pub iterations: f64,
    /// sigma_yy over rho g H of each point above what is held.
    stress: Vec<f64>,
    /// Its largest error.
    error: f64,
    /// Numerical over supplied energy.
    numerical: f64,
}

impl CutCell {
    pub(super) fn stand(&self, setup: Setup, reference: &Reference, report: &mut Report) -> Result<Standing, String> {
        let mut set = vec![
            ("implicit.time_step", format!("{:?}", 1.0 / setup.steps)),
            ("implicit.ghost_stiffness", format!("{:?}", setup.gamma)),
        ];
        if let Some(mass) = setup.mass {
            set.push(("implicit.regime", "newmark".into()));
            set.push(("implicit.ghost_mass", format!("{mass:?}")));
        }
        if setup.finite {
            set.push(("solver.kinematics", "hencky".into()));
        }
        let mut run = Run::new(self.files().case, &keys(&set))?;
        let by = setup.past.map_or(0.0, |past| (0.25 + past) * run.grid.h);
        run.shift([by, by]);
        run.until(run.case.end.time, |_| ())?;
        report.count(&run.sim);
        Standing::read(&mut run, reference)
    }

    /// All shifts at one gamma; the last run.
    fn slide(
        &self,
        setup: Setup,
        shifts: &[f64],
        uncut: f64,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<Standing, String> {
        let key = if setup.gamma > 0.0 { "ghosted" } else { "bare" };
        let (mut conditions, mut last) = (Vec::new(), None);
        for &past in shifts {
            let name = format!("gamma = {}, {past:e} h", setup.gamma);
            let setup = Setup { past: Some(past), ..setup };
            let found = self.stand(setup, reference, report)?;
            let finite = self.stand(Setup { finite: true, steps: 1.0, ..setup }, reference, report)?;
            report.row_of(reference, key, &name, None, found.condition / uncut)?;
            report.row_of(reference, "iterations", &name, None, finite.iterations)?;
            let bound = ERROR[1] + MOST * setup.gamma / setup.steps;
            report.row_of(reference, "error", &name, Some(bound), found.error)?;
            report.row_of(reference, "energy", &name, None, found.numerical)?;
            conditions.push((past, found.condition));
            last = Some(found);
        }
        compare(setup.gamma, &conditions, reference, report)?;
        last.ok_or_else(|| "no shift".into())
    }

    /// All gammas at the smallest shift, in many steps and in one.
    fn sweep(
        &self,
        setup: Setup,
        bare: &Standing,
        uncut: f64,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        for gamma in [1e-4, 1e-3, 1e-2, 1e-1, 1.0] {
            for steps in [setup.steps, 1.0] {
                let found = self.stand(Setup { past: Some(SMALLEST), gamma, steps, ..setup }, reference, report)?;
                let name = format!("gamma = {gamma:e}, {steps} steps");
                if steps > 1.0 {
                    report.row_of(reference, "price", &name, None, found.condition / uncut)?;
                }
                let apart = found.stress.iter().zip(&bare.stress).map(|(a, b)| (a - b).abs());
                report.row_of(reference, "cost", &name, Some(MOST * gamma / steps), largest(apart))?;
            }
        }
        Ok(())
    }
}

impl CutCell {
    /// The penalty of the mass, and both, with inertia in short steps.
    fn move_on(&self, whole: Setup, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let moving = Setup { mass: Some(0.0), steps: reference.given("short_steps")?, ..whole };
        let uncut = self.stand(moving, reference, report)?.condition;
        let on = reference.given("gamma")?;
        for (gamma, mass) in [(0.0, 0.0), (on, 0.0), (0.0, on), (on, on)] {
            let setup = Setup { past: Some(SMALLEST), gamma, mass: Some(mass), ..moving };
            let found = self.stand(setup, reference, report)?;
            let name = format!("gamma_K = {gamma}, gamma_M = {mass}");
            report.row_of(reference, "moving", &name, None, found.condition / uncut)?;
            report.row_of(reference, "energy", &format!("Newmark, {name}"), None, found.numerical)?;
        }
        Ok(())
    }
}

/// Shift of the sweep (cells).
const SMALLEST: f64 = 1e-8;

/// Change of the stress allowed, over gamma rho g H / steps; see the reference.
const MOST: f64 = 4.0 / 3.0;

/// Errors of the stress over rho g H, with whole cells and with cut ones; see the reference.
const ERROR: [f64; 2] = [0.0625, 0.125];

/// How the condition goes with the shift.
fn compare(gamma: f64, conditions: &[(f64, f64)], reference: &Reference, report: &mut Report) -> Result<(), String> {
    let of = conditions.iter().map(|(_, c)| *c);
    if gamma > 0.0 {
        let least = -largest(of.clone().map(|c| -c));
        return report.row(reference, "flat", largest(of) / least);
    }
    let logs: Vec<_> = conditions.iter().map(|(past, c)| (-past.ln(), c.ln())).collect();
    report.row(reference, "exponent", slope(&logs))
}

impl Standing {
    fn read(run: &mut Run, reference: &Reference) -> Result<Self, String> {
        let (height, held) = (reference.given("height")?, reference.given("held")?);
        let material = run.case.material.get("block").ok_or("there is no block")?;
        let weight = material.elastic().unit_weight * height;
        let condition = run.sim.condition().ok_or("no system was solved")?;
        let s = run.sim.snapshot();
        let free = (0..s.len()).filter(|&i| s.position[i][1] > held);
        // depths as they were before the shift
        let top = largest(run.case.region.iter().map(|r| r.shape.bounds()[1][1]));
        let (stress, error): (Vec<f64>, Vec<f64>) = free
            .map(|i| (s.stress[i].yy / weight, (s.stress[i].yy / weight + (top - s.reference[i][1]) / height).abs()))
            .unzip();
        let energies = run.sim.energies();
        Ok(Standing {
            condition,
            iterations: run.sim.work.newton_iterations as f64 / run.sim.work.steps as f64,
            error: largest(error),
            stress,
            numerical: energies.numerical / energies.external,
        })
    }
}
