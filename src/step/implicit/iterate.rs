//! Newton's iteration.

use super::{ASSEMBLY, EFFECTS, EQUATIONS, Implicit, Regime};
use crate::{
    assembly::{response::Respond, smooth::RespondSmoothed},
    body::Body,
    effect::{
        Clock,
        inertia::{Motion, Weights},
    },
    fault::{Fault, FaultKind},
    math::newton::Verdict,
    space::Shape,
    system::System,
    work::Work,
};

/// Shares of a correction that the line search tries.
const SHARES: [f64; 4] = [1.0, 0.5, 0.25, 0.125];

/// How far from balance an increment is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residual {
    /// |r| over the free unknowns (kN/m).
    norm: f64,
    /// Size of the forces that should balance (kN/m).
    scale: f64,
    /// Contacts that have changed their mind.
    changes: u32,
}

impl<S: Shape<N>, const N: usize> Implicit<S, N> {
    /// Newton's iteration to convergence; the plastic work of the step (kJ/m).
    pub(super) fn iterate(
        &mut self,
        body: &mut Body,
        clock: Clock,
        weights: Option<Weights>,
        work: &mut Work,
    ) -> Result<f64, Fault> {
        let mut positive = true;
        // the sign of the pivots tells when a body at rest loses its stability
        self.solver.want_pivots(self.inertia.is_none() && matches!(self.settings.regime, Regime::Auto(_)));
        let (mut plastic, mut residual) = match self.evaluate(body, clock, weights, 0) {
            Ok(found) => found,
            Err(_) if weights.is_some() => {
                // the velocities of the start were too bold a guess
                self.system.du.iter_mut().for_each(|d| d.fill(0.0));
                self.evaluate(body, clock, weights, 0)?
            }
            Err(fault) => return Err(fault),
        };
        loop {
            if residual.changes > 0 {
                self.convergence.change_equations();
            }
            let settled = residual.changes == 0 && self.system.gap() == 0.0;
            match self.convergence.note(residual.norm, residual.scale) {
                Verdict::Converged if settled => break,
                Verdict::AtRounding if settled => {
                    work.rounding_accepts += 1;
                    break;
                }
                Verdict::GiveUp => return Err(self.diverged(&residual)),
                Verdict::Converged | Verdict::AtRounding if self.convergence.is_spent() => {
                    return Err(self.diverged(&residual));
                }
                Verdict::Converged | Verdict::AtRounding | Verdict::Continue => {}
            }
            let solution = self.timed(EQUATIONS, |i| i.system.solve(&mut i.solver, work))?;
            positive = solution.positive.unwrap_or(true);
            self.convergence.note_energy(self.system.energy());
            work.newton_iterations += 1;
            (plastic, residual) = self.advance(body, clock, weights, &residual, work)?;
            if self.settings.tolerance.is_some() && self.convergence.iterations() == 0 {
                self.first.clone_from(&self.system.du);
            }
        }
        self.note_stability(positive)?;
        Ok(plastic)
    }

    /// Goes along the correction, as far as the residual allows.
    fn advance(
        &mut self,
        body: &mut Body,
        clock: Clock,
        weights: Option<Weights>,
        before: &Residual,
        work: &mut Work,
    ) -> Result<(f64, Residual), Fault> {
        let jump = self.system.gap() > 0.0;
        let iteration = self.convergence.iterations() + 1;
        let mut done = 0.0;
        let mut last = None;
        for share in SHARES {
            self.system.advance(share - done);
            done = share;
            match self.evaluate(body, clock, weights, iteration) {
                Ok(found) => {
                    let better = found.1.norm <= before.norm || found.1.changes > 0;
                    if better || jump || !self.settings.line_search {
                        return Ok(found);
                    }
                    last = Some(Ok(found));
                }
                Err(fault) => last = Some(Err(fault)),
            }
            work.line_searches += 1;
        }
        // no share makes it smaller: Newton's own step is as good as any
        if matches!(last, Some(Ok(_))) {
            self.system.advance(1.0 - done);
            return self.evaluate(body, clock, weights, iteration);
        }
        last.unwrap_or_else(|| Err(Fault::new(FaultKind::NewtonDiverged)))
    }

    /// Internal force, and tangent, at the present increment; the plastic work (kJ/m).
    pub(super) fn respond(&mut self, body: &mut Body, tangent: bool) -> Result<f64, Fault> {
        self.system.clear(tangent);
        let Implicit { scratch, kept, system, path, shape, .. } = self;
        let (scratch, shape) = (scratch.as_mut(), *shape);
        match kept.cells.take() {
            None => path.run(Respond { scratch, body, kept, system, tangent, shape }),
            Some(mut cells) => {
                let result =
                    path.run(RespondSmoothed { scratch, body, kept, cells: &mut cells, system, tangent, shape });
                kept.cells = Some(cells);
                result
            }
        }
    }

    /// Residual and tangent at the present increment, with what supports and contacts make of it.
    pub(super) fn evaluate(
        &mut self,
        body: &mut Body,
        clock: Clock,
        weights: Option<Weights>,
        iteration: u32,
    ) -> Result<(f64, Residual), Fault> {
        let plastic = self.timed(ASSEMBLY, |i| i.respond(body, true))?;
        let residual = self.timed(EFFECTS, |i| i.balance(clock, weights, iteration));
        Ok((plastic, residual))
    }

    /// What is out of balance, with inertia, loads, effects, supports and contacts.
    fn balance(&mut self, clock: Clock, weights: Option<Weights>, iteration: u32) -> Residual {
        let mut scale = norm(&self.system.residual);
        self.internal_work = work_of(&self.system.residual, &self.system.du);
        if weights.is_none() && iteration == 0 {
            self.keep_start_force();
        }
        if let Some((w, inertia)) = weights.zip(self.inertia.as_mut()) {
            weigh(&mut self.system, &self.start_force, w.w1);
            inertia.add(&self.nodes, &mut self.system, &w);
            scale = scale.max(inertia.norm);
        }
        for axis in 0..2 {
            let residual = self.system.residual[axis].iter_mut();
            residual.zip(&self.nodes.force[axis]).for_each(|(r, f)| *r -= f);
        }
        let Implicit { effects, nodes, system, inertia, .. } = self;
        let motion = weights.as_ref().zip(inertia.as_ref()).map(|(weights, inertia)| Motion { inertia, weights });
        for effect in effects.iter_mut().filter(|e| e.stages().residual) {
            effect.residual(nodes, clock, motion, system);
        }
        system.release();
        let holding = effects.iter_mut().filter(|e| e.stages().constrain);
        let changes = holding.map(|e| e.hold(nodes, clock, system, iteration)).sum();
        let norms = system.norms();
        let loads = self.nodes.force.iter().flat_map(|f| &f[..self.nodes.count]).map(|f| f * f).sum::<f64>();
        let scale = scale.max(norms.reaction).max(loads.sqrt());
        Residual { norm: norms.residual, scale, changes }
    }

    fn diverged(&self, residual: &Residual) -> Fault {
        Fault::new(FaultKind::NewtonDiverged)
            .with("iterations", f64::from(self.convergence.iterations()))
            .with("residual_kn", residual.norm)
            .with("relative_residual", residual.norm / residual.scale)
            .with("energy_ratio", self.convergence.energy_ratio().unwrap_or(f64::NAN))
            .with("contact_changes", f64::from(residual.changes))
    }

    /// A quasi-static state whose tangent is not positive is no stable equilibrium.
    fn note_stability(&mut self, positive: bool) -> Result<(), Fault> {
        if positive || self.inertia.is_some() || !matches!(self.settings.regime, Regime::Auto(_)) {
            return Ok(());
        }
        Err(Fault::new(FaultKind::Unstable))
    }
}

/// Sum of f . du (kJ/m).
pub(super) fn work_of(force: &[Vec<f64>; 2], du: &[Vec<f64>; 2]) -> f64 {
    force.iter().flatten().zip(du.iter().flatten()).map(|(f, du)| f * du).sum()
}

/// r = w1 r + (1 - w1) r_start, K = w1 K.
fn weigh(system: &mut System, start: &[Vec<f64>; 2], w1: f64) {
    if w1 == 1.0 {
        return;
    }
    for axis in 0..2 {
        system.residual[axis].iter_mut().zip(&start[axis]).for_each(|(r, s)| *r = w1 * *r + (1.0 - w1) * s);
    }
    system.values.iter_mut().for_each(|v| *v *= w1);
}

fn norm(columns: &[Vec<f64>; 2]) -> f64 {
    columns.iter().flatten().map(|v| v * v).sum::<f64>().sqrt()
}
