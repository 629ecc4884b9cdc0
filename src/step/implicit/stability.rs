//! When a quasi-static body has lost its stability, and gets inertia.

use super::{Implicit, Regime};
use crate::{
    effect::{Clock, Inertia, TimeScheme},
    fault::{Fault, FaultKind},
    space::Shape,
    step::Event,
};

/// Failed steps in a row, each half as long as the one before, after which a quasi-static body is
/// taken to have lost its stability.
const STUBBORN: u32 = 3;

impl<S: Shape<N>, const N: usize> Implicit<S, N> {
    /// Brings inertia in where a quasi-static body has lost its stability. Whether it did.
    pub(super) fn lose_stability(&mut self, fault: &Fault, clock: Clock) -> bool {
        let Regime::Auto(scheme) = self.settings.regime else { return false };
        if self.inertia.is_some() {
            return false;
        }
        self.failures += 1;
        let unstable = fault.kind == FaultKind::Unstable;
        if !unstable && self.failures < STUBBORN {
            return false;
        }
        let why = if unstable { "the tangent is not positive definite" } else { "Newton's iteration fails" };
        self.events.push(Event { time_s: clock.time, kind: "stability_lost", why: why.to_owned() });
        self.bring_inertia_in(scheme, clock);
        true
    }

    /// From here on the body has inertia. A body that moves at the start has it from the start.
    pub(super) fn bring_inertia_in(&mut self, scheme: TimeScheme, clock: Clock) {
        self.events.push(Event { time_s: clock.time, kind: "inertia_on", why: format!("{scheme:?}") });
        self.inertia = Some(Inertia::new(scheme));
    }
}
