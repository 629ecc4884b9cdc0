//! How far a load that grows with time finds equilibrium.

use super::setup::Run;
use crate::fault::Fault;

/// The last time with equilibrium, and the first without (s): no step, down to the shortest, leads
/// from the one to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bracket {
    pub holds: f64,
    pub fails: f64,
}

impl Bracket {
    /// The middle (s).
    pub fn middle(self) -> f64 {
        0.5 * (self.holds + self.fails)
    }

    /// Half the width over the middle.
    pub fn half_width(self) -> f64 {
        0.5 * (self.fails - self.holds) / self.middle()
    }
}

/// Steps until there is no equilibrium; `None` where there is, up to the end.
///
/// # Errors
/// Where a run ends otherwise than by the loss of equilibrium.
pub(super) fn last_equilibrium(run: &mut Run) -> Result<Option<Bracket>, String> {
    let end = run.case.end.time;
    while run.sim.time < end * (1.0 - 1e-12) {
        if let Err(fault) = run.sim.step(end - run.sim.time) {
            let step = lost_balance(&fault).ok_or_else(|| fault.to_string())?;
            return Ok(Some(Bracket { holds: run.sim.time, fails: run.sim.time + step }));
        }
    }
    Ok(None)
}

/// Length of the step (s) in which equilibrium was lost, if that is the fault.
pub(super) fn lost_balance(fault: &Fault) -> Option<f64> {
    let step = fault.values.iter().find(|(name, _)| name == "step_cut_to_s").map(|(_, step)| *step);
    step.filter(|_| fault.kind.is_loss_of_balance())
}
