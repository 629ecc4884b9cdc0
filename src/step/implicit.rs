//! The implicit integrator: increments of the nodes by Newton's method, with or without inertia.

use std::time::Instant;

use crate::{
    assembly::{
        Scatter, Scratch,
        response::{Keep, Kept, Map, Respond},
        smooth::RespondSmoothed,
    },
    body::{Body, chunks},
    domain,
    effect::{
        Clock, Effect, Inertia, Sink, TimeScheme,
        inertia::{Motion, Weights},
    },
    fault::{Fault, FaultKind},
    math::{
        linear::{Options, Solver},
        newton::{Convergence, Tolerances, Verdict},
        simd::FpPath,
        sparse::Change,
    },
    nodes::Nodes,
    space::{Grid, Shape},
    step::{Books, Event, Integrator, Report, load},
    system::System,
    transfer::Carry,
    work::Work,
};

/// With or without inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regime {
    QuasiStatic,
    /// Inertia throughout.
    Dynamic(TimeScheme),
    /// Quasi-static until the body loses its stability, then with inertia.
    Auto(TimeScheme),
}

/// Settings of the implicit integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    pub regime: Regime,
    pub tolerances: Tolerances,
    pub line_search: bool,
    /// Whether the dilatation is smoothed over cells (B-bar).
    pub smooth: bool,
    /// Local error of the displacement allowed in a step, in cells; `None`: not looked at.
    pub tolerance: Option<f64>,
    /// Rate of PIC (1/s).
    pub pic_rate: f64,
    pub solver: Options,
}

/// The integrator for shapes with `N` nodes a point.
pub struct Implicit<S, const N: usize> {
    shape: S,
    settings: Settings,
    nodes: Nodes,
    scratch: Box<Scratch<N>>,
    kept: Kept<N>,
    system: System,
    solver: Solver,
    convergence: Convergence,
    inertia: Option<Inertia>,
    effects: Vec<Box<dyn Effect>>,
    /// Internal force at the start of the step (kN/m), where the scheme needs it.
    start_force: [Vec<f64>; 2],
    /// Increment after the first correction (m), for the local error without inertia.
    first: [Vec<f64>; 2],
    /// Local error of the last step over what is allowed.
    error_ratio: Option<f64>,
    /// Effects that load points, and the forces on these.
    loads: Vec<usize>,
    point_forces: load::PointForces,
    plastic: f64,
    path: FpPath,
    filled: bool,
    runs_when_sorted: u64,
    kinetic: f64,
    /// Failures in a row while quasi-static.
    failures: u32,
    events: Vec<Event>,
    report: Report,
    phases: [f64; PHASES.len()],
}

/// Parts of a step whose time is told.
const PHASES: [&str; 5] = ["stencils", "assembly", "effects", "equations", "points"];
const STENCILS: usize = 0;
const ASSEMBLY: usize = 1;
const EFFECTS: usize = 2;
const EQUATIONS: usize = 3;
const POINTS: usize = 4;

/// Failed steps in a row, each half as long as the one before, after which a quasi-static body is
/// taken to have lost its stability.
const STUBBORN: u32 = 3;

/// Multiple of the tolerance above which a step is refused.
const TOO_MUCH: f64 = 4.0;

/// Shares of a correction that the line search tries.
const SHARES: [f64; 4] = [1.0, 0.5, 0.25, 0.125];

impl<S: Shape<N>, const N: usize> Implicit<S, N> {
    /// An integrator on `grid` with the effects in the order in which they act.
    pub fn new(shape: S, grid: Grid, settings: Settings, effects: Vec<Box<dyn Effect>>) -> Self {
        let inertia = match settings.regime {
            Regime::Dynamic(scheme) => Some(Inertia::new(scheme)),
            Regime::QuasiStatic | Regime::Auto(_) => None,
        };
        let mut kept = Kept::new::<S>();
        if settings.smooth {
            kept.smooth();
        }
        Implicit {
            shape,
            settings,
            nodes: Nodes::new(grid),
            scratch: Box::default(),
            kept,
            system: System::default(),
            solver: Solver::new(settings.solver),
            convergence: Convergence::new(settings.tolerances),
            inertia,
            loads: (0..effects.len()).filter(|&e| effects[e].stages().load).collect(),
            effects,
            start_force: Default::default(),
            first: Default::default(),
            error_ratio: None,
            point_forces: Default::default(),
            plastic: 0.0,
            path: FpPath::best(),
            filled: false,
            runs_when_sorted: 0,
            kinetic: 0.0,
            failures: 0,
            events: Vec::new(),
            report: Report::default(),
            phases: Default::default(),
        }
    }

    fn try_step(&mut self, body: &mut Body, clock: Clock, work: &mut Work) -> Result<(), Fault> {
        if let (Regime::Auto(scheme), None) = (self.settings.regime, &self.inertia)
            && body.kinetic_energy() > 0.0
        {
            self.bring_inertia_in(scheme, clock);
        }
        let weights = self.inertia.as_ref().map(|i| i.scheme.weights(clock.dt));
        self.timed(STENCILS, |i| i.place(body, work));
        self.start(body, clock, weights)?;
        let plastic = self.iterate(body, clock, weights, work)?;
        self.timed(POINTS, |i| i.carry(body, clock, weights))?;
        self.judge(weights)?;
        self.settle(body, clock, weights);
        self.commit(body, plastic, work);
        Ok(())
    }

    /// Adds the time of `part` to a phase.
    fn timed<T>(&mut self, phase: usize, part: impl FnOnce(&mut Self) -> T) -> T {
        let started = Instant::now();
        let result = part(self);
        self.phases[phase] += started.elapsed().as_secs_f64();
        result
    }

    /// Stencils, masses and structure of the step. In small strain they stay as they were.
    fn place(&mut self, body: &Body, work: &mut Work) {
        let finite = body.groups.iter().any(|g| g.law.finite());
        if finite || !self.filled {
            self.nodes.begin();
            let Implicit { scratch, nodes, kept, system, effects, path, shape, .. } = self;
            let shape = *shape;
            path.run(Scatter { scratch: scratch.as_mut(), body, nodes, shape });
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
    fn start(&mut self, body: &mut Body, clock: Clock, weights: Option<Weights>) -> Result<(), Fault> {
        let grid = self.nodes.grid;
        for effect in &mut self.effects {
            effect.ledger_mut().begin();
            if effect.stages().survey {
                effect.survey(body, &grid);
            }
        }
        self.load(body, clock, weights);
        self.convergence.begin();
        let Some(w) = weights else { return Ok(()) };
        self.map_motion(body);
        if w.w1 < 1.0 {
            self.respond(body, false)?;
            for axis in 0..2 {
                self.start_force[axis].clone_from(&self.system.residual[axis]);
            }
        }
        for axis in 0..2 {
            let velocity = self.nodes.old_velocity[axis][..self.nodes.count].iter();
            self.system.du[axis].iter_mut().zip(velocity).for_each(|(du, v)| *du = clock.dt * v);
        }
        Ok(())
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

    /// Velocities of the nodes at the start, and accelerations where they are remembered.
    fn map_motion(&mut self, body: &mut Body) {
        let Implicit { scratch, kept, nodes, inertia, path, .. } = self;
        let Nodes { old_velocity, mass, count, .. } = nodes;
        let (n, committed) = (*count, &body.committed);
        old_velocity.iter_mut().for_each(|v| v[..n].fill(0.0));
        let momentum = |i: usize, axis: usize| body.mass[i] * committed.v[axis][i];
        path.run(Map { scratch: scratch.as_mut(), body, kept, quantity: momentum, out: old_velocity });
        divide(old_velocity, &mass[..n]);
        let Some(inertia) = inertia.as_mut().filter(|i| i.scheme.remembers()) else { return };
        if body.committed.acceleration.is_empty() {
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
    }

    /// Newton's iteration to convergence; the plastic work of the step (kJ/m).
    fn iterate(
        &mut self,
        body: &mut Body,
        clock: Clock,
        weights: Option<Weights>,
        work: &mut Work,
    ) -> Result<f64, Fault> {
        let mut positive = true;
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
                Verdict::GiveUp => return Err(self.diverged(&residual)),
                Verdict::Converged | Verdict::Continue => {}
            }
            let solution = self.timed(EQUATIONS, |i| i.system.solve(&mut i.solver, work))?;
            positive = solution.positive.unwrap_or(true);
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
    fn respond(&mut self, body: &mut Body, tangent: bool) -> Result<f64, Fault> {
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
    fn evaluate(
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
        if let Some((w, inertia)) = weights.zip(self.inertia.as_mut()) {
            weigh(&mut self.system, &self.start_force, w.w1);
            inertia.add(&self.nodes, &mut self.system, &w, true);
            scale = scale.max(inertia.norm);
        }
        for axis in 0..2 {
            let residual = self.system.residual[axis].iter_mut();
            residual.zip(&self.nodes.force[axis]).for_each(|(r, f)| *r -= f);
        }
        let Implicit { effects, nodes, system, inertia, .. } = self;
        let motion = weights.as_ref().zip(inertia.as_ref()).map(|(weights, inertia)| Motion { inertia, weights });
        for effect in effects.iter_mut().filter(|e| e.stages().residual) {
            effect.residual(nodes, clock, motion, system, true);
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
            .with("contact_changes", f64::from(residual.changes))
    }

    /// A quasi-static state whose tangent is not positive is no stable equilibrium.
    fn note_stability(&mut self, positive: bool) -> Result<(), Fault> {
        if positive || self.inertia.is_some() || !matches!(self.settings.regime, Regime::Auto(_)) {
            return Ok(());
        }
        Err(Fault::new(FaultKind::Unstable))
    }

    /// Moves the points, and gives them their velocities.
    fn carry(&mut self, body: &mut Body, clock: Clock, weights: Option<Weights>) -> Result<(), Fault> {
        if let Some((w, inertia)) = weights.zip(self.inertia.as_mut()) {
            inertia.finish(&mut self.nodes, &self.system, &w);
        }
        let pic = -(-self.settings.pic_rate * clock.dt).exp_m1();
        let moving = weights.is_some();
        let Implicit { scratch, nodes, kept, system, inertia, path, shape, .. } = self;
        let shape = *shape;
        let none = Default::default();
        let acceleration = inertia.as_ref().map_or(&none, |i| &i.start);
        path.run(Carry { scratch: scratch.as_mut(), body, nodes, kept, system, moving, acceleration, pic, shape })
    }

    /// Compares the local error of the step with the tolerance.
    fn judge(&mut self, weights: Option<Weights>) -> Result<(), Fault> {
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
                    None => 0.5 * (system.du[axis][slot] - first[axis].get(slot).copied().unwrap_or(0.0)),
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
    fn settle(&mut self, body: &Body, clock: Clock, weights: Option<Weights>) {
        let Implicit { effects, nodes, system, .. } = self;
        self.kinetic = if weights.is_some() { nodes.kinetic_energy() } else { 0.0 };
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
    }

    fn commit(&mut self, body: &mut Body, plastic: f64, work: &mut Work) {
        body.commit();
        self.effects.iter_mut().for_each(|e| e.ledger_mut().commit());
        self.plastic += plastic;
        self.failures = 0;
        self.report = Report {
            iterations: self.convergence.iterations(),
            residual: self.convergence.residual(),
            order: self.convergence.order(ORDER_FLOOR),
        };
        let blocks: u64 = body.groups.iter().map(|g| chunks(g.range.clone()).count() as u64).sum();
        work.steps += 1;
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

    fn growth_by_iterations(&self) -> f64 {
        match self.report.iterations {
            0..=4 => 1.5,
            5..=6 => 1.2,
            7..=8 => 1.0,
            _ => 0.7,
        }
    }

    /// Brings inertia in where a quasi-static body has lost its stability. Whether it did.
    fn lose_stability(&mut self, fault: &Fault, clock: Clock) -> bool {
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
    fn bring_inertia_in(&mut self, scheme: TimeScheme, clock: Clock) {
        self.events.push(Event { time_s: clock.time, kind: "inertia_on", why: format!("{scheme:?}") });
        self.inertia = Some(Inertia::new(scheme));
    }
}

/// Residual over the scale of the forces above which convergence is judged for its order.
const ORDER_FLOOR: f64 = 1e-12;

/// out / mass; 0 where there is no mass.
fn divide(out: &mut [Vec<f64>; 2], mass: &[f64]) {
    for column in out {
        column.iter_mut().zip(mass).for_each(|(v, m)| *v = if *m > 0.0 { *v / m } else { 0.0 });
    }
}

/// How far from balance an increment is.
#[derive(Clone, Copy, Debug)]
struct Residual {
    /// |r| over the free unknowns (kN/m).
    norm: f64,
    /// Size of the forces that should balance (kN/m).
    scale: f64,
    /// Contacts that have changed their mind.
    changes: u32,
}

/// The step as the effects see it whose force is taken at the middle of a step: its middle is at
/// t + w1 dt.
fn instant(clock: Clock, weights: Option<Weights>) -> Clock {
    let w1 = weights.map_or(1.0, |w| w.w1);
    Clock { time: clock.time + (w1 - 0.5) * clock.dt, ..clock }
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

impl<S: Shape<N>, const N: usize> Integrator for Implicit<S, N> {
    fn stable_dt(&mut self, _: &Body) -> Option<f64> {
        None
    }

    fn step(&mut self, body: &mut Body, clock: Clock, work: &mut Work) -> Result<(), Fault> {
        let result = self.try_step(body, clock, work);
        match result {
            Err(fault) if self.lose_stability(&fault, clock) => {
                work.rejected_steps += 1;
                self.try_step(body, clock, work)
            }
            other => other,
        }
    }

    fn nodal_kinetic_energy(&self) -> f64 {
        self.kinetic
    }

    fn books(&self) -> Books {
        let mut books = Books { plastic: self.plastic, ..Books::default() };
        for effect in &self.effects {
            let totals = effect.ledger().totals();
            books.effects.add(&totals);
            match effect.sink() {
                Sink::Friction => books.friction += totals.dissipated,
                Sink::Damping => books.damping += totals.dissipated,
                Sink::None => {}
            }
        }
        books
    }

    fn bytes(&self) -> usize {
        let nodes = 4 * self.nodes.grid.nodes() + 13 * 8 * self.nodes.id.capacity();
        nodes + self.kept.bytes() + self.system.bytes() + self.solver.bytes()
    }

    fn phases(&self) -> Vec<(&'static str, f64)> {
        PHASES.into_iter().zip(self.phases).collect()
    }

    fn condition(&mut self) -> Option<f64> {
        Some(self.solver.condition(&self.system.pattern, &self.system.values))
    }

    /// Few iterations: longer steps; many: shorter ones. With a tolerance the local error decides,
    /// as long as the iterations are few.
    fn growth(&self) -> f64 {
        let by_error = self.error_ratio.map(|ratio| {
            let order = self.inertia.as_ref().map_or(1, |i| i.scheme.order());
            (0.9 * ratio.powf(-1.0 / f64::from(order + 1))).clamp(0.3, 2.0)
        });
        self.growth_by_iterations().min(by_error.unwrap_or(f64::INFINITY))
    }

    fn report(&self) -> Report {
        self.report
    }

    fn events(&self) -> &[Event] {
        &self.events
    }
}

#[cfg(test)]
mod tests;
