//! Control of the time step: how long, cut after a fault, grown again.

use crate::{body::Body, effect::Clock, fault::Fault, step::Integrator, work::Work};

/// Steps between two estimates of the stable step.
const REFRESH: u64 = 20;
/// Accepted steps after which a cut step doubles again.
const REGROW: u32 = 20;
/// A step is not cut below this fraction of the stable one.
const SMALLEST: f64 = 1.0 / 1024.0;

/// Lengths of step between which an iterating integrator moves (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    pub first: f64,
    pub min: f64,
    pub max: f64,
}

/// Where the length of a step comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// A stable step (fixed or estimated anew every [`REFRESH`] steps), and the share of it that
    /// faults have left.
    Stable { fixed: Option<f64>, stable: f64, cut: f64, quiet: u32 },
    /// The integrator says how much longer or shorter the next step may be.
    Paced { pace: Pace, next: f64 },
}

/// Chooses each step and carries it out.
#[derive(Clone, Debug)]
pub struct Control {
    source: Source,
}

impl Control {
    /// A fixed step (s), or the integrator's stable step.
    pub fn new(fixed: Option<f64>) -> Self {
        Control { source: Source::Stable { fixed, stable: 0.0, cut: 1.0, quiet: 0 } }
    }

    /// Steps that follow the effort of an integrator.
    pub fn with_pace(pace: Pace) -> Self {
        Control { source: Source::Paced { pace, next: pace.first.clamp(pace.min, pace.max) } }
    }

    /// One accepted step of at most `limit` (s); its length is returned. A refused step is cut
    /// in half if a smaller step may cure the fault: down to 1/1024 of the stable one, or to the
    /// least length of the pace.
    pub fn advance(
        &mut self,
        integrator: &mut dyn Integrator,
        body: &mut Body,
        time: f64,
        limit: f64,
        work: &mut Work,
    ) -> Result<f64, Fault> {
        if let Source::Stable { fixed, stable, .. } = &mut self.source
            && (work.steps.is_multiple_of(REFRESH) || *stable == 0.0)
        {
            *stable = fixed.or_else(|| integrator.stable_dt(body)).unwrap_or(limit);
        }
        loop {
            let clock = Clock { time, dt: self.length().min(limit) };
            let result = integrator.step(body, clock, work);
            match result {
                Ok(()) => {
                    self.accept(clock.dt, integrator.growth());
                    return Ok(clock.dt);
                }
                Err(fault) => self.refuse(fault, clock, work)?,
            }
        }
    }

    fn length(&self) -> f64 {
        match self.source {
            Source::Stable { stable, cut, .. } => stable * cut,
            Source::Paced { next, .. } => next,
        }
    }

    fn accept(&mut self, dt: f64, growth: f64) {
        match &mut self.source {
            Source::Stable { cut, quiet, .. } => {
                *quiet += 1;
                if *cut < 1.0 && *quiet >= REGROW {
                    *cut = (2.0 * *cut).min(1.0);
                    *quiet = 0;
                }
            }
            // a step that only the end of the run has shortened says nothing of the next
            Source::Paced { pace, next } if dt >= *next => *next = (growth * dt).clamp(pace.min, pace.max),
            Source::Paced { .. } => {}
        }
    }

    fn refuse(&mut self, fault: Fault, clock: Clock, work: &mut Work) -> Result<(), Fault> {
        work.rejected_steps += 1;
        let spent = match &mut self.source {
            Source::Stable { cut, quiet, .. } => {
                *quiet = 0;
                *cut *= 0.5;
                *cut < SMALLEST
            }
            Source::Paced { pace, next } => {
                *next = 0.5 * clock.dt;
                *next < pace.min
            }
        };
        let fault = Fault { step: work.steps + 1, time_s: clock.time, ..fault };
        if !fault.curable() {
            return Err(fault);
        }
        if spent {
            return Err(fault.with("step_cut_to_s", clock.dt));
        }
        Ok(())
    }
}
