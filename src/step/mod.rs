//! Integrators: one step of a body in time, and the control of the time step.

pub mod control;
pub mod explicit;
pub mod flows;
pub mod implicit;
pub mod load;

pub use flows::Flows;

use serde::Serialize;

use crate::{
    body::Body,
    effect::{Clock, Effect, Sink, Totals},
    fault::Fault,
    math::team::Team,
    work::Work,
};

/// Energies that an integrator books, besides those that follow from the body's state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Books {
    /// Totals of all effects.
    pub effects: Totals,
    /// Plastic work (kJ/m).
    pub plastic: f64,
    /// Energy dissipated in friction on the sides (kJ/m).
    pub friction: f64,
    /// Energy taken by damping (kJ/m).
    pub damping: f64,
    /// What the scheme itself has taken.
    pub flows: Flows,
}

impl Books {
    /// From the ledgers of the effects, each under the head that it names, and the plastic work (kJ/m).
    pub fn of(effects: &[Box<dyn Effect>], plastic: f64) -> Self {
        let mut books = Books { plastic, ..Books::default() };
        for effect in effects {
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
}

/// What the last step of an integrator that iterates took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    pub iterations: u32,
    /// Out-of-balance force at the end (kN/m).
    pub residual: f64,
    /// Observed order of convergence, where it can be told.
    pub order: Option<f64>,
}

/// Something that happened once, and that the record tells.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Event {
    pub time_s: f64,
    pub kind: &'static str,
    pub why: String,
}

impl Event {
    /// The kind in words.
    pub fn words(&self) -> String {
        self.kind.replace('_', " ")
    }
}

/// Advances a body in time.
pub trait Integrator: Send {
    /// Largest stable time step (s) with its safety factor; `None` where there is no limit.
    fn stable_dt(&mut self, body: &Body) -> Option<f64>;

    /// One step. On `Err` the body and the books are as before.
    fn step(&mut self, body: &mut Body, clock: Clock, work: &mut Work) -> Result<(), Fault>;

    /// Steps on the threads of a team from now on, with the same bits; how many of them find work. One, the calling
    /// thread, where a step cannot be shared.
    fn share(&mut self, _team: Team) -> usize {
        1
    }

    /// Nodal kinetic energy after the last step (kJ/m).
    fn nodal_kinetic_energy(&self) -> f64;

    /// Energies booked so far.
    fn books(&self) -> Books;

    /// Bytes held by grid and nodes.
    fn bytes(&self) -> usize;

    /// What the last step took.
    fn report(&self) -> Report {
        Report::default()
    }

    /// Estimate of the condition number, in the 1-norm, of the last system that was solved: a dozen
    /// solves with its factor. The size of the matrix is read where the step has ended. `None` where
    /// nothing is solved. No run asks for it; studies do.
    fn condition(&mut self) -> Option<f64> {
        None
    }

    /// What happened so far.
    fn events(&self) -> &[Event] {
        &[]
    }

    /// Wall time spent in the parts of a step (s), by name; empty where it is not measured.
    fn phases(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }

    /// By what factor the next step may be longer or should be shorter than the last.
    fn growth(&self) -> f64 {
        1.0
    }
}
