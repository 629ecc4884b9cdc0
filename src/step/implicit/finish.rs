//! How a step ends: the points move, its error is judged, and all commits.

use super::{Implicit, iterate::work_of, start::instant};
use crate::{
    assembly::nonlocal::Soften,
    body::{Body, chunks},
    domain,
    effect::{Clock, inertia::Weights},
    fault::{Fault, FaultKind},
    space::Shape,
    step::{Flows, Report},
    transfer::Carry,
    work::Work,
};

/// Multiple of the tolerance above which a step is refused.
const TOO_MUCH: f64 = 4.0;

/// Residual over the scale of the forces above which convergence is judged for its order.
const ORDER_FLOOR: f64 = 1e-12;

impl<S: Shape<N>, const N: usize> Implicit<S, N> {
    /// Moves the points, and gives them their velocities.
    pub(super) fn carry(&mut self, body: &mut Body, clock: Clock, weights: Option<Weights>) -> Result<(), Fault> {
        if let Some((w, inertia)) = weights.zip(self.inertia.as_mut()) {
            inertia.finish(&mut self.nodes, &self.system, &w);
        }
        let moving = weights.is_some();
        let unbound = !body.groups.iter().any(|g| g.law.finite());
        let Implicit { scratch, nodes, carrier, kept, system, inertia, path, shape, .. } = self;
        let shape = *shape;
        let none = Default::default();
        let acceleration = inertia.as_ref().map_or(&none, |i| &i.start);
        let scratch = scratch.as_mut();
        let pass = Carry { scratch, body, nodes, kept, system, moving, unbound, acceleration, shape };
        carrier.carry(pass, clock.dt, *path)
    }

    /// Compares the local error of the step with the tolerance.
    pub(super) fn judge(&mut self, weights: Option<Weights>) -> Result<(), Fault> {
        let Some(tolerance) = self.settings.tolerance else { return Ok(()) };
        let error = self.local_error(weights) / self.nodes.grid.h;
        self.error_ratio = Some(error / tolerance);
        if error > TOO_MUCH * tolerance {
            return Err(Fault::new(FaultKind::Inaccurate).with("error_cells", error).with("tolerance", tolerance));
        }
        Ok(())
    }

    /// Root of the mass-weighted mean square over the nodes of the local error (m). Without inertia
    /// it is half the difference between the way along the first tangent and the way to balance:
    /// what a step makes of the bend of the load path.
    fn local_error(&self, weights: Option<Weights>) -> f64 {
        let Implicit { nodes, system, start_force, first, .. } = self;
        let (mut sum, mut mass) = (0.0, 0.0);
        for axis in 0..2 {
            for slot in (0..nodes.count).filter(|&s| nodes.mass[s] > 0.0) {
                let m = nodes.mass[slot];
                let error = match weights {
                    // none without a correction: the step has found balance
                    None => first[axis].get(slot).map_or(0.0, |first| 0.5 * (system.du[axis][slot] - first)),
                    Some(_) if system.is_inelastic(slot, axis) => 0.0,
                    Some(w) => {
                        let at_start = start_force[axis].get(slot).map_or(0.0, |f| (nodes.force[axis][slot] - f) / m);
                        let mean = (nodes.velocity[axis][slot] - nodes.old_velocity[axis][slot]) / w.dt;
                        w.local_error(at_start, mean)
                    }
                };
                sum += m * error * error;
                mass += m;
            }
        }
        (sum / mass).sqrt()
    }

    /// The books of the effects.
    pub(super) fn settle(&mut self, body: &Body, clock: Clock, weights: Option<Weights>) {
        self.kinetic = if weights.is_some() { self.nodes.kinetic_energy() } else { 0.0 };
        let mut flows = if weights.is_some() { self.nodal_flows() } else { Flows::default() };
        let Implicit { effects, nodes, system, .. } = self;
        // what is booked from velocities is booked from the mean velocity of the step
        let n = nodes.count;
        for axis in 0..2 {
            let mean = nodes.velocity[axis][..n].iter_mut().zip(&system.du[axis]);
            mean.for_each(|(v, du)| *v = du / clock.dt);
        }
        // without inertia the work of a load that grows is that of its mean
        let instant = if weights.is_some() { instant(clock, weights) } else { clock };
        for effect in effects.iter_mut() {
            if effect.stages().account {
                effect.account(nodes, instant);
            }
            if effect.stages().load {
                effect.account_points(body, instant);
            }
            effect.settle(nodes, clock, system);
            if weights.is_none() {
                // and there is no momentum to balance
                effect.ledger_mut().step.impulse = [0.0; 2];
            }
        }
        // supplied = gained by the nodes + lost on impact + work against the mean internal force + taken by the integrator:
        // the damping of backward Euler and HHT, the ghost penalty, and what a body out of balance gives up without inertia
        flows.integrator = self.supplied() - self.mean_internal_work() - flows.nodes - flows.impact;
        self.step_flows = flows;
    }

    /// What the nodes have gained, and what those have lost that came to their velocity within the step.
    fn nodal_flows(&self) -> Flows {
        let Implicit { nodes, system, .. } = self;
        let mut flows = Flows::default();
        for axis in 0..2 {
            for slot in 0..nodes.count {
                let (start, end) = (nodes.old_velocity[axis][slot], nodes.velocity[axis][slot]);
                flows.book(nodes.mass[slot], start, end, system.is_inelastic(slot, axis));
            }
        }
        flows
    }

    /// What the effects have given in this step, less what they have taken (kJ/m).
    fn supplied(&self) -> f64 {
        self.effects.iter().map(|e| e.ledger().step).map(|t| t.external - t.dissipated).sum()
    }

    /// Work of the mean of the internal forces at the start and at the end (kJ/m).
    fn mean_internal_work(&self) -> f64 {
        0.5 * (work_of(&self.start_force, &self.system.du) + self.internal_work)
    }

    pub(super) fn commit(&mut self, body: &mut Body, plastic: f64, work: &mut Work) {
        body.commit();
        self.soften(body);
        self.effects.iter_mut().for_each(|e| e.ledger_mut().commit());
        self.plastic += plastic;
        self.flows.add(&self.step_flows);
        self.failures = 0;
        self.report = Report {
            iterations: self.convergence.iterations(),
            residual: self.convergence.residual(),
            order: self.convergence.order(ORDER_FLOOR),
        };
        let blocks: u64 = body.groups.iter().map(|g| chunks(g.range.clone()).count() as u64).sum();
        work.steps += 1;
        work.frozen_contacts += self.effects.iter().map(|e| e.frozen()).sum::<u64>();
        work.particle_steps += body.len() as u64;
        work.law_blocks += blocks * u64::from(self.convergence.iterations() + 1);
        let (growths, high) = self.nodes.growth();
        work.node_growths = growths;
        work.max_active_nodes = high as u64;
        if S::DOMAIN {
            let clamped = domain::longer_than(body, S::LONGEST * self.nodes.grid.h * (1.0 + 1e-9));
            work.domain_clamps = work.domain_clamps.max(clamped);
        }
        self.keep_sorted(body, work);
    }

    /// The averages of what has been committed, for the next step; by the stencils of this one, which in small strain
    /// are those of the start.
    fn soften(&mut self, body: &mut Body) {
        let Implicit { nonlocal: Some(nonlocal), scratch, nodes, kept, path, shape, .. } = self else { return };
        let kept = Some(kept.stencils.as_slice());
        path.run(Soften { scratch: scratch.as_mut(), body, nodes, kept, nonlocal, shape: *shape });
    }

    /// Puts the points back in cell order when too many runs of equal nodes have been broken. In
    /// small strain they stay where they are.
    fn keep_sorted(&mut self, body: &mut Body, work: &mut Work) {
        if !body.groups.iter().any(|g| g.law.finite()) {
            return;
        }
        let runs = self.scratch.runs.len() as u64;
        if self.runs_when_sorted == 0 {
            self.runs_when_sorted = runs;
        } else if runs > self.runs_when_sorted + self.runs_when_sorted / 4 + 8 {
            body.sort(&S::order(&self.nodes.grid));
            self.runs_when_sorted = 0;
            work.sorts += 1;
        }
    }
}
