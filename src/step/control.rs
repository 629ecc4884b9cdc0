//! Control of the time step: how long, cut after a fault, grown again.

use crate::{body::Body, effect::Clock, fault::Fault, step::Integrator, work::Work};

/// Steps between two estimates of the stable step.
const REFRESH: u64 = 20;
/// Accepted steps after which a cut step doubles again.
const REGROW: u32 = 20;
/// A step is not cut below this fraction of the stable one.
const SMALLEST: f64 = 1.0 / 1024.0;

/// Chooses each step and carries it out.
#[derive(Clone, Debug)]
pub struct Control {
    fixed: Option<f64>,
    stable: f64,
    cut: f64,
    quiet: u32,
}

impl Control {
    /// A fixed step (s), or the integrator's stable step.
    pub fn new(fixed: Option<f64>) -> Self {
        Control { fixed, stable: 0.0, cut: 1.0, quiet: 0 }
    }

    /// One accepted step of at most `limit` (s); its length is returned. A refused step is cut
    /// in half, down to 1/1024 of the stable one, if a smaller step may cure the fault.
    pub fn advance(
        &mut self,
        integrator: &mut dyn Integrator,
        body: &mut Body,
        time: f64,
        limit: f64,
        work: &mut Work,
    ) -> Result<f64, Fault> {
        if work.steps.is_multiple_of(REFRESH) || self.stable == 0.0 {
            self.stable = self.fixed.or_else(|| integrator.stable_dt(body)).unwrap_or(limit);
        }
        loop {
            let clock = Clock { time, dt: (self.stable * self.cut).min(limit) };
            let result = integrator.step(body, clock, work);
            match result {
                Ok(()) => {
                    self.accept();
                    return Ok(clock.dt);
                }
                Err(fault) => self.refuse(fault, clock, work)?,
            }
        }
    }

    fn accept(&mut self) {
        self.quiet += 1;
        if self.cut < 1.0 && self.quiet >= REGROW {
            self.cut = (2.0 * self.cut).min(1.0);
            self.quiet = 0;
        }
    }

    fn refuse(&mut self, fault: Fault, clock: Clock, work: &mut Work) -> Result<(), Fault> {
        work.rejected_steps += 1;
        self.quiet = 0;
        self.cut *= 0.5;
        let fault = Fault { step: work.steps + 1, time_s: clock.time, ..fault };
        if !fault.curable() {
            return Err(fault);
        }
        if self.cut < SMALLEST {
            return Err(fault.with("step_cut_to_s", clock.dt));
        }
        Ok(())
    }
}
