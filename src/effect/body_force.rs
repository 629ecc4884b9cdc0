//! A force on the mass of each point, given by a function.

use super::{Clock, Effect, Ledger, Stages, Totals};
use crate::body::Body;

/// f_p = m_p b(X_p, t), with X_p the place at which the point started and t the middle of the step. No case has it:
/// studies of exact solutions add it to a scene.
pub struct BodyForce<B> {
    /// b (m/s2) of a place (m) and a time (s).
    field: B,
    ledger: Ledger,
}

impl<B: Fn([f64; 2], f64) -> [f64; 2] + Send> BodyForce<B> {
    /// The force per mass (m/s2) as a function of the place at the start (m) and the time (s).
    pub fn new(field: B) -> Self {
        BodyForce { field, ledger: Ledger::default() }
    }

    /// Force on the point at place `i` of the columns (kN/m).
    fn on(&self, body: &Body, clock: Clock, i: usize) -> [f64; 2] {
        (self.field)(body.reference(i), clock.time + 0.5 * clock.dt).map(|b| b * body.mass[i])
    }
}

impl<B: Fn([f64; 2], f64) -> [f64; 2] + Send> Effect for BodyForce<B> {
    fn name(&self) -> &'static str {
        "body_force"
    }

    fn stages(&self) -> Stages {
        Stages { load: true, ..Stages::default() }
    }

    fn load(&mut self, body: &Body, clock: Clock, push: &mut dyn FnMut(usize, [f64; 2])) {
        (0..body.len()).for_each(|i| push(i, self.on(body, clock, i)));
    }

    /// Work f_p . (x_p - x_p,old), as for a load.
    fn account_points(&mut self, body: &Body, clock: Clock) {
        let (old, new) = (&body.committed.x, &body.trial.x);
        let mut step = Totals::default();
        for i in 0..body.len() {
            let force = self.on(body, clock, i);
            for axis in 0..2 {
                step.external += force[axis] * (new[axis][i] - old[axis][i]);
                step.impulse[axis] += force[axis] * clock.dt;
            }
        }
        self.ledger.step.add(&step);
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn ledger_mut(&mut self) -> &mut Ledger {
        &mut self.ledger
    }
}
