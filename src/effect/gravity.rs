//! Gravity with its history.

use super::{Clock, Effect, Ledger, Stages};
use crate::{math::sums::sums, nodes::Nodes};

/// History of gravity, as factors on its components along and normal to the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Schedule {
    /// Full from the start.
    AtOnce,
    /// Linear from 0 to full.
    Ramp { ramp_time: f64 },
    /// The normal part grows, settles, and only then the part along the base grows.
    NormalFirst { ramp_time: f64, settle_time: f64, tangential_time: f64 },
}

impl Schedule {
    /// Factors on (g_x, g_y) at a time.
    pub fn factors(&self, time: f64) -> [f64; 2] {
        match *self {
            Schedule::AtOnce => [1.0, 1.0],
            Schedule::Ramp { ramp_time } => [ramp(time, ramp_time); 2],
            Schedule::NormalFirst { ramp_time, settle_time, tangential_time } => {
                [ramp(time - ramp_time - settle_time, tangential_time), ramp(time, ramp_time)]
            }
        }
    }
}

/// From 0 at time 0 to 1 at `length` (s), and 1 from then on.
pub(super) fn ramp(time: f64, length: f64) -> f64 {
    if time >= length { 1.0 } else { (time / length).max(0.0) }
}

/// f_i += m_i g(t), with g taken at the middle of the step.
pub struct Gravity {
    /// Full acceleration (m/s2).
    acceleration: [f64; 2],
    schedule: Schedule,
    ledger: Ledger,
}

impl Gravity {
    /// `acceleration` (m/s2) is the vector at full gravity.
    pub fn new(acceleration: [f64; 2], schedule: Schedule) -> Self {
        Gravity { acceleration, schedule, ledger: Ledger::default() }
    }

    fn at(&self, clock: Clock) -> [f64; 2] {
        let f = self.schedule.factors(clock.time + 0.5 * clock.dt);
        [self.acceleration[0] * f[0], self.acceleration[1] * f[1]]
    }
}

impl Effect for Gravity {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn stages(&self) -> Stages {
        Stages { force: true, account: true, ..Stages::default() }
    }

    fn force(&mut self, nodes: &mut Nodes, clock: Clock) {
        let g = self.at(clock);
        let n = nodes.count;
        for axis in 0..2 {
            for (f, m) in nodes.force[axis][..n].iter_mut().zip(&nodes.mass[..n]) {
                *f += m * g[axis];
            }
        }
    }

    /// Work g . sum m_i v_i dt = sum of weight times way of the points, since the shape
    /// functions sum to one.
    fn account(&mut self, nodes: &Nodes, clock: Clock) {
        let g = self.at(clock);
        let columns = [&nodes.mass[..], &nodes.velocity[0], &nodes.velocity[1]];
        let [mass, px, py] = sums(columns, nodes.count, |[m, vx, vy]| [m, m * vx, m * vy]);
        for (axis, momentum) in [px, py].into_iter().enumerate() {
            self.ledger.step.external += g[axis] * momentum * clock.dt;
            self.ledger.step.impulse[axis] += g[axis] * mass * clock.dt;
        }
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn ledger_mut(&mut self) -> &mut Ledger {
        &mut self.ledger
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schedules() {
        assert_eq!(Schedule::AtOnce.factors(0.0), [1.0, 1.0]);
        assert_eq!(Schedule::Ramp { ramp_time: 4.0 }.factors(1.0), [0.25, 0.25]);
        let s = Schedule::NormalFirst { ramp_time: 1.0, settle_time: 2.0, tangential_time: 2.0 };
        assert_eq!(s.factors(0.5), [0.0, 0.5]);
        assert_eq!(s.factors(4.0), [0.5, 1.0]);
        assert_eq!(s.factors(9.0), [1.0, 1.0]);
    }
}
