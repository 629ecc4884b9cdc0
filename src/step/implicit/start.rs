//! What a step starts from: stencils and structure, loads, velocities, and the first guess.

use super::Implicit;
use crate::{
    assembly::{
        Scatter,
        affine::Spin,
        response::{Keep, Map},
    },
    body::Body,
    effect::{Clock, inertia::Weights},
    fault::Fault,
    math::sparse::Change,
    nodes::Nodes,
    space::Shape,
    step::load,
    work::Work,
};

impl<S: Shape<N>, const N: usize> Implicit<S, N> {
    /// Stencils, masses and structure of the step. In small strain they stay as they were.
    pub(super) fn place(&mut self, body: &Body, work: &mut Work) {
        let finite = body.groups.iter().any(|g| g.law.finite());
        if finite || !self.filled {
            self.nodes.begin();
            let Implicit { scratch, nodes, kept, system, effects, path, shape, .. } = self;
            let shape = *shape;
            path.run(Scatter { scratch: scratch.as_mut(), body, nodes, cells: None, stretch: 0..body.len(), shape });
            system.begin(nodes.count);
            path.run(Keep { scratch: scratch.as_mut(), body, nodes, kept, system, shape });
            for effect in effects.iter_mut().filter(|e| e.stages().couple) {
                effect.couple(body, nodes, system);
            }
            let change = system.adopt(nodes.grid.row(), &nodes.id[..nodes.count], true);
            work.patterns += u64::from(change == Change::Rebuilt);
            work.patterns_reused += u64::from(change == Change::Subset);
            self.filled = true;
        } else {
            self.system.begin(self.nodes.count);
        }
    }

    /// Velocities and loads at the start, and the first guess: dt v0 with inertia, 0 without.
    pub(super) fn start(&mut self, body: &mut Body, clock: Clock, weights: Option<Weights>) -> Result<(), Fault> {
        let grid = self.nodes.grid;
        for effect in &mut self.effects {
            effect.ledger_mut().begin();
            if effect.stages().survey {
                effect.survey(body, &grid);
            }
        }
        self.load(body, clock, weights);
        self.convergence.begin();
        self.first.iter_mut().for_each(Vec::clear);
        if weights.is_none() {
            return Ok(());
        }
        let fresh = self.map_motion(body);
        self.respond(body, false)?;
        self.keep_start_force();
        if fresh {
            self.accelerate();
        }
        for axis in 0..2 {
            let velocity = self.nodes.old_velocity[axis][..self.nodes.count].iter();
            self.system.du[axis].iter_mut().zip(velocity).for_each(|(du, v)| *du = clock.dt * v);
        }
        Ok(())
    }

    /// Keeps the internal forces of the start of the step, for the scheme and for the books.
    pub(super) fn keep_start_force(&mut self) {
        for axis in 0..2 {
            self.start_force[axis].clone_from(&self.system.residual[axis]);
        }
    }

    /// External forces on the nodes, at t + w1 dt.
    fn load(&mut self, body: &Body, clock: Clock, weights: Option<Weights>) {
        let n = self.nodes.count;
        self.nodes.force.iter_mut().for_each(|f| f[..n].fill(0.0));
        let instant = instant(clock, weights);
        for effect in &mut self.effects {
            if effect.stages().force && !effect.stages().residual {
                effect.force(&mut self.nodes, instant);
            }
        }
        if !self.loads.is_empty() {
            load::gather(&mut self.point_forces, &mut self.effects, &self.loads, body, instant);
            let Implicit { scratch, kept, nodes, point_forces, path, .. } = self;
            let quantity = |i: usize, axis: usize| point_forces[axis][i];
            path.run(Map { scratch: scratch.as_mut(), body, kept, quantity, out: &mut nodes.force });
        }
    }

    /// Accelerations at the start where none are remembered yet: those of the forces.
    fn accelerate(&mut self) {
        let Implicit { nodes, inertia, start_force, .. } = self;
        let Some(inertia) = inertia else { return };
        for axis in 0..2 {
            let forces = nodes.force[axis].iter().zip(&start_force[axis]).zip(&nodes.mass);
            for (a, ((load, internal), mass)) in inertia.start[axis].iter_mut().zip(forces) {
                *a = if *mass > 0.0 { (load - internal) / mass } else { 0.0 };
            }
        }
    }

    /// Velocities of the nodes at the start, and accelerations where they are remembered. Returns
    /// whether they are to be remembered and there are none yet.
    fn map_motion(&mut self, body: &mut Body) -> bool {
        let Implicit { scratch, kept, nodes, inertia, path, shape, .. } = self;
        let Nodes { old_velocity, mass, count, grid, .. } = nodes;
        let (n, committed) = (*count, &body.committed);
        old_velocity.iter_mut().for_each(|v| v[..n].fill(0.0));
        let momentum = |i: usize, axis: usize| body.mass[i] * committed.v[axis][i];
        path.run(Map { scratch: scratch.as_mut(), body, kept, quantity: momentum, out: old_velocity });
        if !committed.affine.is_empty() {
            let (scratch, shape) = (scratch.as_mut(), *shape);
            path.run(Spin { scratch, body, kept, out: old_velocity, h: grid.h, shape });
        }
        divide(old_velocity, &mass[..n]);
        let Some(inertia) = inertia.as_mut().filter(|i| i.scheme.remembers()) else { return false };
        let fresh = body.committed.acceleration.is_empty();
        if fresh {
            body.track_accelerations();
        }
        for axis in &mut inertia.start {
            axis.clear();
            axis.resize(n, 0.0);
        }
        let committed = &body.committed;
        let force = |i: usize, axis: usize| body.mass[i] * committed.acceleration[axis][i];
        path.run(Map { scratch: scratch.as_mut(), body, kept, quantity: force, out: &mut inertia.start });
        divide(&mut inertia.start, &mass[..n]);
        fresh
    }
}

/// out / mass; 0 where there is no mass.
fn divide(out: &mut [Vec<f64>; 2], mass: &[f64]) {
    for column in out {
        column.iter_mut().zip(mass).for_each(|(v, m)| *v = if *m > 0.0 { *v / m } else { 0.0 });
    }
}

/// The step as the effects see it whose force is taken at the middle of a step: its middle is at
/// t + w1 dt.
pub(super) fn instant(clock: Clock, weights: Option<Weights>) -> Clock {
    let w1 = weights.map_or(1.0, |w| w.w1);
    Clock { time: clock.time + (w1 - 0.5) * clock.dt, ..clock }
}
