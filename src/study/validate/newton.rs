//! The observed order of Newton's iteration on a slope that softens and slides.

use super::{Effort, Files, Problem, Report, limit::lost_balance, reference::Reference, setup::Run};

/// See the module.
pub struct Newton;

impl Problem for Newton {
    fn name(&self) -> &'static str {
        "newton"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/newton/case.toml"),
            reference: include_str!("../../../validation/newton/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let cells: &[f64] = match effort {
            Effort::Short => &[0.5],
            Effort::Full => &[0.5, 0.25],
        };
        for &h in cells {
            self.ramp(h, reference, report)?;
        }
        Ok(())
    }
}

impl Newton {
    fn ramp(&self, h: f64, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let mut run = Run::new(self.files().case, &[format!("grid.cell={h:?}")])?;
        let steps = orders(&mut run)?;
        report.count(&run.sim);
        let name = format!("h = {h} m");
        let mut orders: Vec<f64> = steps.iter().filter_map(|s| s.order).collect();
        orders.sort_by(f64::total_cmp);
        let share = |n: usize, of: usize| n as f64 / of as f64;
        let good = orders.iter().filter(|o| **o >= 1.8).count();
        report.row_of(reference, "median", &name, None, orders.get(orders.len() / 2).copied().unwrap_or(f64::NAN))?;
        report.row_of(reference, "share", &name, None, share(good, orders.len()))?;
        let plastic = steps.iter().filter(|s| s.yielding).count();
        report.row_of(reference, "yielding", &name, None, share(plastic, steps.len()))?;
        let iterations: u32 = steps.iter().map(|s| s.iterations).sum();
        report.row_of(reference, "iterations", &name, None, f64::from(iterations) / steps.len() as f64)?;
        report.note(format!(
            "h = {h} m: {} steps to {:.3} s, {} of them with three residuals above rounding; {} refused",
            steps.len(),
            run.sim.time,
            orders.len(),
            run.sim.work.rejected_steps
        ));
        Ok(())
    }
}

/// What a step took.
struct Step {
    order: Option<f64>,
    iterations: u32,
    /// Whether plastic work was done in it.
    yielding: bool,
}

/// Steps up to the loss of equilibrium, or the end.
fn orders(run: &mut Run) -> Result<Vec<Step>, String> {
    let (mut steps, mut plastic) = (Vec::new(), 0.0);
    let end = run.case.end.time;
    while run.sim.time < end * (1.0 - 1e-12) {
        match run.sim.step(end - run.sim.time) {
            Ok(()) => {}
            Err(fault) if lost_balance(&fault).is_some() => break,
            Err(fault) => return Err(fault.to_string()),
        }
        let (last, work) = (run.sim.report(), run.sim.books().plastic);
        steps.push(Step { order: last.order, iterations: last.iterations, yielding: work > plastic });
        plastic = work;
    }
    Ok(steps)
}
