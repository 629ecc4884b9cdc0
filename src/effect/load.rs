//! Dead loads on points.

use super::{Clock, Effect, Ledger, Stages, gravity::ramp};
use crate::body::Body;

/// f_p = share_p F ramp(t): a force that keeps its direction and goes with the points that it was
/// given to. It is taken at the middle of the step.
pub struct Load {
    /// Each point's share of the force, by identity; they sum to 1.
    share: Vec<f64>,
    /// F (kN/m).
    force: [f64; 2],
    ramp_time: f64,
    ledger: Ledger,
}

impl Load {
    /// `force` (kN/m) in all, shared by `weight` over the identities of the points (0: not loaded);
    /// it grows over `ramp_time` (s).
    pub fn new(weight: Vec<f64>, force: [f64; 2], ramp_time: f64) -> Self {
        let sum: f64 = weight.iter().sum();
        let share = weight.into_iter().map(|w| w / sum).collect();
        Load { share, force, ramp_time, ledger: Ledger::default() }
    }

    /// The whole force at a time (kN/m).
    pub fn at(&self, time: f64) -> [f64; 2] {
        self.force.map(|f| f * ramp(time, self.ramp_time))
    }

    /// Index and share of each loaded point.
    fn loaded<'a>(&'a self, body: &'a Body) -> impl Iterator<Item = (usize, f64)> + 'a {
        let shares = body.id.iter().map(|&id| self.share.get(id as usize).copied().unwrap_or(0.0));
        shares.enumerate().filter(|(_, share)| *share > 0.0)
    }
}

/// The middle of a step (s).
fn middle(clock: Clock) -> f64 {
    clock.time + 0.5 * clock.dt
}

impl Effect for Load {
    fn name(&self) -> &'static str {
        "load"
    }

    fn stages(&self) -> Stages {
        Stages { load: true, ..Stages::default() }
    }

    fn load(&mut self, body: &Body, clock: Clock, push: &mut dyn FnMut(usize, [f64; 2])) {
        let force = self.at(middle(clock));
        self.loaded(body).for_each(|(i, share)| push(i, force.map(|f| share * f)));
    }

    /// Work f_p . (x_p - x_p,old): that of the nodal forces, since the points move with the nodes.
    fn account_points(&mut self, body: &Body, clock: Clock) {
        let force = self.at(middle(clock));
        let (old, new) = (&body.committed.x, &body.trial.x);
        let (mut way, mut sum) = ([0.0; 2], 0.0);
        for (i, share) in self.loaded(body) {
            way[0] += share * (new[0][i] - old[0][i]);
            way[1] += share * (new[1][i] - old[1][i]);
            sum += share;
        }
        for axis in 0..2 {
            self.ledger.step.external += force[axis] * way[axis];
            self.ledger.step.impulse[axis] += force[axis] * sum * clock.dt;
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
    fn the_force_is_shared_by_weight_and_grows_over_its_ramp() {
        let load = Load::new(vec![1.0, 0.0, 3.0], [8.0, -4.0], 2.0);
        assert_eq!(load.share, [0.25, 0.0, 0.75]);
        assert_eq!((load.at(0.0), load.at(1.0), load.at(5.0)), ([0.0, -0.0], [4.0, -2.0], [8.0, -4.0]));
        assert_eq!(Load::new(vec![1.0], [1.0, 0.0], 0.0).at(0.0), [1.0, 0.0]);
    }
}
