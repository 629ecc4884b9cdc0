//! The implicit integrator: increments of the nodes by Newton's method, with or without inertia.

mod finish;
mod iterate;
mod stability;
mod start;

use std::time::Instant;

use crate::{
    assembly::{
        Scratch,
        nonlocal::{Average, Nonlocal},
        response::Kept,
    },
    body::Body,
    effect::{Clock, Effect, Inertia, TimeScheme},
    fault::Fault,
    math::{
        linear::{Options, Solver},
        newton::{Convergence, Tolerances},
        simd::FpPath,
    },
    nodes::Nodes,
    space::{Grid, Shape},
    step::{Books, Event, Flows, Integrator, Report, load},
    system::System,
    transfer::{Carrier, Transfer},
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
    /// No step is cut below this (s).
    pub min_time_step: f64,
    /// Whether the dilatation is smoothed over cells (B-bar).
    pub smooth: bool,
    /// Local error of the displacement allowed in a step, in cells; `None`: not looked at.
    pub tolerance: Option<f64>,
    pub transfer: Transfer,
    pub solver: Options,
}

/// The integrator for shapes with `N` nodes a point.
pub struct Implicit<S, const N: usize> {
    shape: S,
    settings: Settings,
    nodes: Nodes,
    carrier: Carrier,
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
    /// Work of the internal forces at the end of the step (kJ/m), as they stand in the last evaluation.
    internal_work: f64,
    flows: Flows,
    /// Those of the step under way.
    step_flows: Flows,
    path: FpPath,
    filled: bool,
    runs_when_sorted: u64,
    kinetic: f64,
    /// Failures in a row while quasi-static.
    failures: u32,
    events: Vec<Event>,
    report: Report,
    phases: [f64; PHASES.len()],
    /// Only where a soil softens nonlocally.
    nonlocal: Option<Box<Nonlocal>>,
}

/// Parts of a step whose time is told.
const PHASES: [&str; 5] = ["stencils", "assembly", "effects", "equations", "points"];
const STENCILS: usize = 0;
const ASSEMBLY: usize = 1;
const EFFECTS: usize = 2;
const EQUATIONS: usize = 3;
const POINTS: usize = 4;

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
            carrier: Carrier::new(settings.transfer),
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
            internal_work: 0.0,
            flows: Flows::default(),
            step_flows: Flows::default(),
            path: FpPath::best(),
            filled: false,
            runs_when_sorted: 0,
            kinetic: 0.0,
            failures: 0,
            events: Vec::new(),
            report: Report::default(),
            phases: Default::default(),
            nonlocal: None,
        }
    }

    /// Lets the strength of some groups follow averages from now on.
    pub fn soften_by(&mut self, body: &Body, averages: Vec<Average>) {
        self.nonlocal = Some(Box::new(Nonlocal::new::<S, N>(&self.nodes.grid, body, averages)));
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

    fn growth_by_iterations(&self) -> f64 {
        match self.report.iterations {
            0..=4 => 1.5,
            5..=6 => 1.2,
            _ => 1.0,
        }
    }
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
        Books { flows: self.flows, ..Books::of(&self.effects, self.plastic) }
    }

    fn bytes(&self) -> usize {
        let nodes = self.nodes.bytes();
        let averages = self.nonlocal.as_ref().map_or(0, |n| n.bytes());
        nodes + averages + self.carrier.bytes() + self.kept.bytes() + self.system.bytes() + self.solver.bytes()
    }

    fn phases(&self) -> Vec<(&'static str, f64)> {
        PHASES.into_iter().zip(self.phases).collect()
    }

    fn condition(&mut self) -> Option<f64> {
        Some(self.solver.condition(&self.system.pattern, &self.system.values))
    }

    /// Few iterations: longer steps; shorter ones only after a refusal. With a tolerance the local error decides,
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
