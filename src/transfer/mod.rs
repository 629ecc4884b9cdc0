//! From the grid back to the points: how they move, and what velocity they get.
//!
//! A pass over the blocks ([`Push`], [`Carry`]) does what all transfers share; a `Rule` says what a
//! point makes of the nodal velocities. Which rule is settled once a pass, by the [`Carrier`].

mod apic;
mod carry;
mod flip;
mod push;
mod xpic;

pub use carry::Carry;
pub use push::Push;

use apic::Apic;
use flip::Flip;
use xpic::{Filter, Xpic};

use crate::{fault::Fault, math::simd::FpPath, nodes::Nodes, space::Shape};

/// What the velocity of the points becomes of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transfer {
    /// What the nodes gain, with a rate of PIC (1/s).
    Flip { pic_rate: f64 },
    /// The velocity of the nodes and its gradient.
    Apic,
    /// What m = `order` passes of a filter leave of FLIP.
    Xpic { order: u32 },
}

/// What a point makes of the nodal velocities.
trait Rule {
    /// Whether the points keep the gradient of the velocity too.
    const AFFINE: bool;

    /// The nodal velocity that is read beside the one that moves the points (m/s).
    fn second<'a>(&'a self, nodes: &'a Nodes) -> &'a [Vec<f64>; 2];

    /// New velocity of a point along an axis, from its own and from sum N_i v_i of the velocity that moves
    /// it and of the second one (m/s).
    fn velocity(&self, own: f64, grid: f64, second: f64) -> f64;
}

/// A pass under a rule.
struct Ruled<P, R> {
    pass: P,
    rule: R,
}

/// Carries velocities to the points, as a [`Transfer`] says, with the nodal columns that this takes.
pub struct Carrier {
    transfer: Transfer,
    filter: Filter,
}

impl Carrier {
    /// For a transfer.
    pub fn new(transfer: Transfer) -> Self {
        Carrier { transfer, filter: Filter::default() }
    }

    /// The pass of an explicit step.
    ///
    /// # Errors
    /// A point that leaves the grid.
    pub fn push<S: Shape<N>, const N: usize>(&mut self, pass: Push<'_, S, N>, path: FpPath) -> Result<(), Fault> {
        match self.transfer {
            Transfer::Flip { pic_rate } => {
                let rule = Flip::new(pic_rate, pass.dt);
                path.run(Ruled { pass, rule })
            }
            Transfer::Apic => path.run(Ruled { pass, rule: Apic }),
            Transfer::Xpic { order } => {
                let parts = (pass.body, &*pass.nodes);
                self.filter.run::<S, N>(order, path, &mut *pass.scratch, parts, None);
                path.run(Ruled { pass, rule: Xpic { filtered: &self.filter.filtered } })
            }
        }
    }

    /// The pass of an implicit step of `dt` (s).
    ///
    /// # Errors
    /// A point that leaves the grid.
    pub fn carry<S: Shape<N>, const N: usize>(
        &mut self,
        pass: Carry<'_, S, N>,
        dt: f64,
        path: FpPath,
    ) -> Result<(), Fault> {
        match self.transfer {
            Transfer::Apic => path.run(Ruled { pass, rule: Apic }),
            Transfer::Flip { pic_rate } => path.run(Ruled { pass, rule: Flip::new(pic_rate, dt) }),
            Transfer::Xpic { order } if pass.moving => {
                let parts = (&*pass.body, pass.nodes);
                self.filter.run::<S, N>(order, path, &mut *pass.scratch, parts, Some(pass.kept));
                path.run(Ruled { pass, rule: Xpic { filtered: &self.filter.filtered } })
            }
            // without inertia no rule is asked
            Transfer::Xpic { .. } => path.run(Ruled { pass, rule: Flip::new(0.0, dt) }),
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.filter.bytes()
    }
}
