//! Where the energy goes that a step takes out of a body, though no law, drag or friction asks for it.
//!
//! Everything here is a sum over nodes. With v0 the velocity that the points give a node at the start of a step, v1
//! the one that moves them, and `jump` = v1 - v0:
//! ```text
//! nodes      sum m (v1^2 - v0^2) / 2
//! impact     sum m jump^2 / 2 over what a support, drive or contact brings to its velocity within the step
//! ```
//! With the kinetic energy of the points, K_p, `nodes` gives what the maps lose,
//! sum (K_p,n - K_0) + (K_1 - K_p,n+1) = K_p,first - K_p,last + sum of `nodes`. For FLIP with lumped mass that
//! is sum m jump^2 / 2 less the same with the consistent mass a step; it is never negative.
//!
//! MUSL strains with a second velocity s = M^-1 P^T v_p, mapped back from the points. Without supports it gives back all
//! that the maps lose, as it makes force and strain adjoint to each other: v1 - s = (1 - M^-1 M_c) jump.
//! With f the force on a node, f_int its internal part, s~ the second velocity as supports leave it:
//! ```text
//! transfer   as above - sum m jump (v1 - s) / 2 + dt (f - f_int) (v1 - s)
//! impact     sum (m jump - dt f) (v1 - s) + dt f_int (s~ - s), and where s~ is not s: + m jump (jump - v1 + s) / 2
//! ```
//! (m jump - dt f is the impulse of the supports, and the last term their part of jump M_c jump / 2.) What is left over
//! is then dt^2 times the difference of two quadratic forms, of force and of strain: the error of the integration in time alone.

use crate::{math::sums::sums, nodes::Nodes};

/// Sums over steps, per metre of thickness (kJ/m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flows {
    /// What the nodes have gained, with what the second velocity of MUSL gives back.
    pub nodes: f64,
    /// Energy taken by supports, drives and contacts that stop nodes within a step.
    pub impact: f64,
    /// Energy taken by the integration in time, where that is known (implicit scheme).
    pub integrator: f64,
}

impl Flows {
    /// Adds what one step did.
    pub fn add(&mut self, step: &Flows) {
        self.nodes += step.nodes;
        self.impact += step.impact;
        self.integrator += step.integrator;
    }

    /// Adds one component of a node: its mass, its velocity at the start and at the end of a step, and whether it was
    /// brought to the latter.
    pub fn book(&mut self, mass: f64, start: f64, end: f64, stopped: bool) {
        let jump = end - start;
        self.nodes += 0.5 * mass * jump * (end + start);
        self.impact += if stopped { 0.5 * mass * jump * jump } else { 0.0 };
    }
}

/// Flows of a step of USL, which strains with the velocity that moves the points. Inlined into a kernel.
#[inline(always)]
pub fn usl(nodes: &Nodes, dt: f64) -> Flows {
    let mut flows = Flows::default();
    for axis in 0..2 {
        let columns = [
            &nodes.mass[..],
            &nodes.inverse_mass,
            &nodes.old_velocity[axis],
            &nodes.velocity[axis],
            &nodes.force[axis],
        ];
        let [gain, impact] = sums(columns, nodes.count, |[mass, inverse, start, end, force]| {
            let push = mass * (end - start);
            // nothing but the force has changed a free node: its velocity is this very sum
            let free = end == start + dt * force * inverse;
            let stopped = if free { 0.0 } else { end - start };
            [0.5 * push * (end + start), 0.5 * push * stopped]
        });
        flows.nodes += gain;
        flows.impact += impact;
    }
    flows
}

/// Flows of a step of MUSL, once its second velocity is known. Inlined into a kernel.
#[inline(always)]
pub fn musl(nodes: &Nodes, dt: f64) -> Flows {
    let mut flows = Flows::default();
    for axis in 0..2 {
        let columns = [
            &nodes.mass[..],
            &nodes.inverse_mass,
            &nodes.old_velocity[axis],
            &nodes.velocity[axis],
            &nodes.force[axis],
            &nodes.internal[axis],
            &nodes.momentum[axis],
            &nodes.strain_velocity[axis],
        ];
        let [gain, impact] =
            sums(columns, nodes.count, |[mass, inverse, start, end, force, internal, momentum, strain]| {
                let (jump, second) = (end - start, momentum * inverse);
                let (push, lag) = (mass * jump, end - second);
                // what the second pass leaves alone is moved by forces, friction among them
                let stopped = if strain == second { 0.0 } else { jump - lag };
                let given = dt * (force - internal) * lag - 0.5 * push * lag;
                let impact = (push - dt * force) * lag + dt * internal * (strain - second);
                [0.5 * push * (end + start) + given, impact + 0.5 * push * stopped]
            });
        flows.nodes += gain;
        flows.impact += impact;
    }
    flows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Grid;

    #[test]
    fn a_stopped_node_loses_what_it_had_and_a_free_one_nothing() {
        let mut nodes = Nodes::new(Grid { origin: [0.0; 2], h: 1.0, cells: [2, 2] });
        let slots = nodes.patch(0, &[0, 1, 3, 4]);
        for s in slots {
            (nodes.mass[s], nodes.inverse_mass[s], nodes.old_velocity[0][s], nodes.force[0][s]) = (2.0, 0.5, 3.0, 4.0);
            nodes.velocity[0][s] = 3.0 + 0.5 * 4.0 * 0.5;
        }
        assert_eq!(usl(&nodes, 0.5), Flows { nodes: 4.0 * (16.0 - 9.0), impact: 0.0, integrator: 0.0 });
        nodes.velocity[0][slots[3]] = 0.0;
        assert_eq!(usl(&nodes, 0.5), Flows { nodes: 3.0 * 7.0 - 9.0, impact: 9.0, integrator: 0.0 });
    }
}
