//! Damping of the motion: local (Cundall) and viscous.

use super::{Clock, Effect, Ledger, Sink, Stages, Totals, inertia::Motion};
use crate::{nodes::Nodes, system::System};

/// Books a drag (kN/m) that acts for `dt` (s) on a node moving with `velocity` (m/s) along `axis`.
fn book_drag(books: &mut Totals, axis: usize, drag: f64, velocity: f64, dt: f64) {
    books.dissipated -= drag * velocity * dt;
    books.impulse[axis] += drag * dt;
}

/// Drags of a step on the nodes (kN/m), until the velocities at its end are known (explicit scheme). A drag works on
/// the mean of the velocities at the start and at the end: that is exact for a body that nothing else moves, whatever share
/// of the velocity a step takes.
#[derive(Default)]
struct Drags([Vec<f64>; 2]);

impl Drags {
    /// Starts a step.
    fn begin(&mut self, nodes: &Nodes) {
        self.0.iter_mut().for_each(|drags| {
            drags.clear();
            // room for every node there is, so that a step allocates only when they have grown
            drags.reserve(nodes.id.len());
        });
    }

    fn push(&mut self, axis: usize, drag: f64) {
        self.0[axis].push(drag);
    }

    /// Books the drags, once.
    fn book(&mut self, nodes: &Nodes, dt: f64, books: &mut Totals) {
        for axis in 0..2 {
            let motion = nodes.old_velocity[axis].iter().zip(&nodes.velocity[axis]);
            for (drag, (start, end)) in self.0[axis].iter().zip(motion) {
                book_drag(books, axis, *drag, 0.5 * (start + end), dt);
            }
            self.0[axis].clear();
        }
    }
}

/// f_i -= a |f_i| sign(v_i) on each component, f_i being the out-of-balance force.
pub struct LocalDamping {
    /// a for good.
    coefficient: f64,
    /// A larger a while the in-situ state settles, and the time at which that ends (s).
    settle: Option<(f64, f64)>,
    drags: Drags,
    ledger: Ledger,
}

impl LocalDamping {
    /// `coefficient` throughout, or the larger value in `settle` up to its time.
    pub fn new(coefficient: f64, settle: Option<(f64, f64)>) -> Self {
        LocalDamping { coefficient, settle, drags: Drags::default(), ledger: Ledger::default() }
    }

    fn at(&self, time: f64) -> f64 {
        match self.settle {
            Some((a, until)) if time < until => a,
            _ => self.coefficient,
        }
    }
}

impl Effect for LocalDamping {
    fn name(&self) -> &'static str {
        "local_damping"
    }

    fn sink(&self) -> Sink {
        Sink::Damping
    }

    fn stages(&self) -> Stages {
        Stages { force: true, account: true, ..Stages::default() }
    }

    fn force(&mut self, nodes: &mut Nodes, clock: Clock) {
        let a = self.at(clock.time);
        if a == 0.0 {
            return;
        }
        let n = nodes.count;
        self.drags.begin(nodes);
        for axis in 0..2 {
            for (f, v) in nodes.force[axis][..n].iter_mut().zip(&nodes.old_velocity[axis]) {
                let drag = if *v == 0.0 { 0.0 } else { -a * f.abs() * v.signum() };
                *f += drag;
                self.drags.push(axis, drag);
            }
        }
    }

    fn account(&mut self, nodes: &Nodes, clock: Clock) {
        self.drags.book(nodes, clock.dt, &mut self.ledger.step);
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn ledger_mut(&mut self) -> &mut Ledger {
        &mut self.ledger
    }
}

/// f_i -= m_i v_i (1 - exp(-c dt)) / dt: the velocity of a free body decays exactly as exp(-c t),
/// whatever the step.
pub struct ViscousDamping {
    /// c (1/s).
    rate: f64,
    /// Whether the step of the implicit scheme has inertia; without it there is no motion to damp.
    moving: bool,
    drags: Drags,
    ledger: Ledger,
}

impl ViscousDamping {
    /// `rate` (1/s): the velocity of a free body decays as exp(-rate t).
    pub fn new(rate: f64) -> Self {
        ViscousDamping { rate, moving: false, drags: Drags::default(), ledger: Ledger::default() }
    }
}

impl Effect for ViscousDamping {
    fn name(&self) -> &'static str {
        "viscous_damping"
    }

    fn sink(&self) -> Sink {
        Sink::Damping
    }

    fn stages(&self) -> Stages {
        Stages { force: true, account: true, residual: true, ..Stages::default() }
    }

    fn force(&mut self, nodes: &mut Nodes, clock: Clock) {
        let n = nodes.count;
        let rate = -(-self.rate * clock.dt).exp_m1() / clock.dt;
        self.drags.begin(nodes);
        for axis in 0..2 {
            let motion = nodes.mass[..n].iter().zip(&nodes.old_velocity[axis]);
            for (f, (m, v)) in nodes.force[axis][..n].iter_mut().zip(motion) {
                let drag = -rate * m * v;
                *f += drag;
                self.drags.push(axis, drag);
            }
        }
    }

    fn account(&mut self, nodes: &Nodes, clock: Clock) {
        self.drags.book(nodes, clock.dt, &mut self.ledger.step);
    }

    /// r_i += c m_i du_i / dt.
    fn residual(&mut self, nodes: &Nodes, clock: Clock, motion: Option<Motion<'_>>, system: &mut System) {
        self.moving = motion.is_some();
        if !self.moving {
            return;
        }
        for axis in 0..2 {
            for slot in 0..nodes.count {
                let drag = self.rate * nodes.mass[slot] / clock.dt;
                system.residual[axis][slot] += drag * system.du[axis][slot];
                if drag > 0.0 {
                    system.add_diagonal(slot, axis, drag);
                }
            }
        }
    }

    fn settle(&mut self, nodes: &Nodes, clock: Clock, system: &System) {
        if !self.moving {
            return;
        }
        for axis in 0..2 {
            for (m, du) in nodes.mass[..nodes.count].iter().zip(&system.du[axis]) {
                let velocity = du / clock.dt;
                book_drag(&mut self.ledger.step, axis, -self.rate * m * velocity, velocity, clock.dt);
            }
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
    use crate::space::Grid;

    /// A body that nothing else moves loses what the damping takes, however much of its velocity a step takes.
    #[test]
    fn what_damping_takes_is_what_a_free_body_loses() {
        let clock = Clock { time: 0.0, dt: 0.5 };
        let (mass, start) = (2.0, 3.0);
        let mut nodes = Nodes::new(Grid { origin: [0.0; 2], h: 1.0, cells: [2, 1] });
        let [s] = nodes.patch(1, &[0]);
        (nodes.mass[s], nodes.old_velocity[0][s]) = (mass, start);
        let mut damping = ViscousDamping::new(4.0);
        damping.force(&mut nodes, clock);
        let end = start + clock.dt * nodes.force[0][s] / mass;
        nodes.velocity[0][s] = end;
        damping.account(&nodes, clock);
        let lost = 0.5 * mass * (start * start - end * end);
        assert!((end - start * (-2.0f64).exp()).abs() < 1e-15);
        assert!((damping.ledger.step.dissipated - lost).abs() < 1e-14, "{:?} of {lost}", damping.ledger.step);
    }
}
