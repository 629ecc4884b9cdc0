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
const STUBBORN: u32 = 6;

/// Whether a fault may come of a body that has no equilibrium any more.
fn speaks_of_stability(kind: FaultKind) -> bool {
    use FaultKind::{Inverted, NewtonDiverged, NonFinite, Singular, Unstable};
    matches!(kind, NewtonDiverged | Singular | Inverted | NonFinite | Unstable)
}

impl<S: Shape<N>, const N: usize> Implicit<S, N> {
    /// Brings inertia in where a quasi-static body has lost its stability. Whether it did.
    pub(super) fn lose_stability(&mut self, fault: &Fault, clock: Clock) -> bool {
        let Regime::Auto(scheme) = self.settings.regime else { return false };
        if self.inertia.is_some() {
            return false;
        }
        if !speaks_of_stability(fault.kind) {
            return false;
        }
        self.failures += 1;
        let last_chance = 0.5 * clock.dt < self.settings.min_time_step;
        if fault.kind != FaultKind::Unstable && self.failures < STUBBORN && !last_chance {
            return false;
        }
        let why = format!("no stable equilibrium found, with steps down to {:.1e} s: {}", clock.dt, fault.kind.what());
        self.events.push(Event { time_s: clock.time, kind: "stability_lost", why });
        self.bring_inertia_in(scheme, clock);
        true
    }

    /// From here on the body has inertia. A body that moves at the start has it from the start.
    pub(super) fn bring_inertia_in(&mut self, scheme: TimeScheme, clock: Clock) {
        self.events.push(Event { time_s: clock.time, kind: "inertia_on", why: format!("{scheme:?}") });
        self.inertia = Some(Inertia::new(scheme));
    }
}
