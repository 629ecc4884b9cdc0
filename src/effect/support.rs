//! Rollers and fixed sides.

use super::{Clock, Effect, Ledger, Pass, Stages, velocity_of};
use crate::{nodes::Nodes, space::grid::Side, system::System};

/// Holds the velocity on one side of the grid: across it (roller) or altogether (fixed).
pub struct Support {
    side: Side,
    fixed: bool,
    /// Unknowns held in this step of the implicit scheme: slot and axis.
    held: Vec<(u32, u8)>,
    ledger: Ledger,
}

impl Support {
    /// No motion across the side.
    pub fn roller(side: Side) -> Self {
        Support { side, fixed: false, held: Vec::new(), ledger: Ledger::default() }
    }

    /// No motion.
    pub fn fixed(side: Side) -> Self {
        Support { side, fixed: true, held: Vec::new(), ledger: Ledger::default() }
    }

    fn hold(&mut self, nodes: &mut Nodes, pass: Pass, axis: usize) {
        for k in 0..nodes.side(self.side).len() {
            let s = nodes.side(self.side)[k] as usize;
            let mass = nodes.mass[s];
            let v = &mut velocity_of(nodes, pass)[axis][s];
            if pass == Pass::Update {
                self.ledger.step.impulse[axis] -= mass * *v;
            }
            // zero, but what is not a number stays so, to be caught at the points
            *v -= *v;
        }
    }
}

impl Effect for Support {
    fn name(&self) -> &'static str {
        "support"
    }

    fn stages(&self) -> Stages {
        Stages { constrain: true, ..Stages::default() }
    }

    fn constrain(&mut self, nodes: &mut Nodes, pass: Pass, _: Clock) {
        let across = self.side.axis();
        self.hold(nodes, pass, across);
        if self.fixed {
            self.hold(nodes, pass, 1 - across);
        }
    }

    fn hold(&mut self, nodes: &Nodes, _: Clock, system: &mut System, _: u32) -> u32 {
        self.held.clear();
        for axis in 0..2 {
            if self.fixed || axis == self.side.axis() {
                let held = nodes.side(self.side).iter().filter(|s| system.hold(**s as usize, axis, 0.0));
                self.held.extend(held.map(|s| (*s, axis as u8)));
            }
        }
        0
    }

    fn settle(&mut self, _: &Nodes, clock: Clock, system: &System) {
        for (slot, axis) in &self.held {
            let axis = usize::from(*axis);
            self.ledger.step.impulse[axis] += system.reaction(*slot as usize, axis) * clock.dt;
        }
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn ledger_mut(&mut self) -> &mut Ledger {
        &mut self.ledger
    }
}
