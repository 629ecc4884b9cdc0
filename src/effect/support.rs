//! Rollers and fixed sides.

use super::{Clock, Effect, Ledger, Pass, Stages, velocity_of};
use crate::{nodes::Nodes, space::grid::Side};

/// Holds the velocity on one side of the grid: across it (roller) or altogether (fixed).
pub struct Support {
    side: Side,
    fixed: bool,
    ledger: Ledger,
}

impl Support {
    /// No motion across the side.
    pub fn roller(side: Side) -> Self {
        Support { side, fixed: false, ledger: Ledger::default() }
    }

    /// No motion.
    pub fn fixed(side: Side) -> Self {
        Support { side, fixed: true, ledger: Ledger::default() }
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

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn ledger_mut(&mut self) -> &mut Ledger {
        &mut self.ledger
    }
}
