//! Body and integrator behind one virtual call a step.

use crate::snapshot::Snapshot;
use crate::{
    block::Law,
    body::Body,
    fault::Fault,
    math::team::Team,
    step::{Books, Event, Flows, Integrator, Report, control::Control},
    work::Work,
};

/// An elastic in-situ phase: at its end displacements and velocities are set to zero and the
/// laws of the scene take the place of the elastic ones.
pub struct InSitu {
    /// End of the phase (s).
    pub until: f64,
    /// The laws that take over, one a group.
    pub laws: Vec<Box<dyn Law>>,
}

/// Where the energy of a body is, per metre of thickness (kJ/m).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Energies {
    /// Of the points.
    pub kinetic: f64,
    /// Of the nodes after the last step.
    pub nodal_kinetic: f64,
    /// Elastic.
    pub strain: f64,
    /// Work of gravity, loads and drives since the start, plus the energy at the start.
    pub external: f64,
    /// Plastic work, friction and damping together.
    pub dissipated: f64,
    pub plastic: f64,
    pub friction: f64,
    pub damping: f64,
    /// What the other terms leave over: external - kinetic - strain - dissipated. It is the
    /// energy that the scheme itself loses or makes, the sum of the four below.
    pub numerical: f64,
    /// Lost by the maps between points and nodes (lumped mass, PIC); see [`crate::step::flows`].
    pub transfer: f64,
    /// Taken by supports, drives and contacts that stop nodes.
    pub impact: f64,
    /// Implicit scheme: taken by the integration in time (damping of backward Euler and HHT, the ghost penalty; without
    /// inertia what a body gives up that starts a step out of balance).
    pub integrator: f64,
    /// The rest: the integration of the stress over a step, or an instability. It falls with the length of the steps.
    pub unexplained: f64,
}

/// A body that moves.
pub struct Simulation {
    pub body: Body,
    integrator: Box<dyn Integrator>,
    control: Control,
    in_situ: Option<InSitu>,
    /// Simulated time (s).
    pub time: f64,
    /// Length of the last step (s).
    pub dt: f64,
    pub work: Work,
    initial_energy: f64,
    /// Kinetic energy of the points at the start (kJ/m).
    initial_kinetic: f64,
    initial_momentum: [f64; 2],
    /// Mass at the start (t/m).
    pub initial_mass: f64,
}

impl Simulation {
    /// A simulation at time 0.
    pub fn new(body: Body, integrator: Box<dyn Integrator>, control: Control, in_situ: Option<InSitu>) -> Self {
        let mut s = Simulation {
            integrator,
            control,
            in_situ,
            time: 0.0,
            dt: 0.0,
            work: Work { points: body.len() as u64, ..Work::default() },
            initial_energy: 0.0,
            initial_kinetic: body.kinetic_energy(),
            initial_momentum: body.momentum(),
            initial_mass: body.total_mass(),
            body,
        };
        s.initial_energy = s.initial_kinetic + s.body.strain_energy();
        s
    }

    /// One accepted step, of at most `limit` (s).
    pub fn step(&mut self, limit: f64) -> Result<(), Fault> {
        let Simulation { body, integrator, control, time, work, .. } = self;
        self.dt = control.advance(integrator.as_mut(), body, *time, limit, work)?;
        self.time += self.dt;
        self.finish_in_situ();
        Ok(())
    }

    fn finish_in_situ(&mut self) {
        if self.in_situ.as_ref().is_none_or(|p| self.time < p.until) {
            return;
        }
        if let Some(phase) = self.in_situ.take() {
            let lost = self.body.kinetic_energy();
            let momentum = self.body.momentum();
            for (group, law) in self.body.groups.iter_mut().zip(phase.laws) {
                group.law = law;
            }
            self.body.restart_from_here();
            self.initial_energy -= lost;
            self.initial_kinetic -= lost;
            self.initial_momentum = [0, 1].map(|a| self.initial_momentum[a] - momentum[a]);
        }
    }

    /// Whether the in-situ phase is still under way.
    pub fn settling(&self) -> bool {
        self.in_situ.is_some()
    }

    /// Steps on `threads` threads from now on, with the same bits; how many of them find work.
    ///
    /// # Errors
    /// A thread cannot be started.
    pub fn share(&mut self, threads: usize) -> std::io::Result<usize> {
        Ok(self.integrator.share(Team::new(threads)?))
    }

    /// The state of the points.
    pub fn snapshot(&self) -> Snapshot {
        self.body.snapshot(self.time, self.work.steps)
    }

    /// The stable time step (s), if the integrator has one.
    pub fn stable_dt(&mut self) -> Option<f64> {
        self.integrator.stable_dt(&self.body)
    }

    /// Estimate of the condition number of the last system, where systems are solved.
    pub fn condition(&mut self) -> Option<f64> {
        self.integrator.condition()
    }

    /// The integrator's books.
    pub fn books(&self) -> Books {
        self.integrator.books()
    }

    /// What the last step took, if the integrator iterates.
    pub fn report(&self) -> Report {
        self.integrator.report()
    }

    /// What happened once, so far.
    pub fn events(&self) -> &[Event] {
        self.integrator.events()
    }

    /// Wall time of the parts of the integrator's steps (s).
    pub fn phases(&self) -> Vec<(&'static str, f64)> {
        self.integrator.phases()
    }

    /// Nodal kinetic energy after the last step (kJ/m).
    pub fn nodal_kinetic_energy(&self) -> f64 {
        self.integrator.nodal_kinetic_energy()
    }

    /// Work of gravity, loads and drives since the start, plus the energy at the start (kJ/m).
    pub fn external_work(&self) -> f64 {
        self.integrator.books().effects.external + self.initial_energy
    }

    /// All energies, and the balance between them.
    pub fn energies(&self) -> Energies {
        let books = self.integrator.books();
        let (kinetic, strain) = (self.body.kinetic_energy(), self.body.strain_energy());
        let external = books.effects.external + self.initial_energy;
        let dissipated = books.plastic + books.effects.dissipated;
        let numerical = external - kinetic - strain - dissipated;
        let Flows { nodes, impact, integrator } = books.flows;
        let transfer = self.initial_kinetic - kinetic + nodes;
        Energies {
            kinetic,
            nodal_kinetic: self.integrator.nodal_kinetic_energy(),
            strain,
            external,
            dissipated,
            plastic: books.plastic,
            friction: books.friction,
            damping: books.damping,
            numerical,
            transfer,
            impact,
            integrator,
            unexplained: numerical - transfer - impact - integrator,
        }
    }

    /// |P - P0 - impulses of gravity, loads, drives, supports and damping| over total weight (at 9.81 m/s2)
    /// times elapsed time; each axis apart.
    pub fn momentum_error(&self) -> [f64; 2] {
        let (p, books) = (self.body.momentum(), self.integrator.books());
        let scale = (self.initial_mass * 9.81 * self.time).max(f64::MIN_POSITIVE);
        [0, 1].map(|a| (p[a] - self.initial_momentum[a] - books.effects.impulse[a]).abs() / scale)
    }

    /// Relative change of the total mass since the start.
    pub fn mass_error(&self) -> f64 {
        (self.body.total_mass() - self.initial_mass).abs() / self.initial_mass
    }

    /// Bytes held by grid, nodes and points.
    pub fn bytes(&self) -> usize {
        self.integrator.bytes() + (self.body.bytes_per_point() * self.body.len() as f64) as usize
    }
}
