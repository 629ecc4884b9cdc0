//! Integrators: one step of a body in time, and the control of the time step.

pub mod control;
pub mod explicit;

use crate::{
    body::Body,
    effect::{Clock, Totals},
    fault::Fault,
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
}

/// Advances a body in time.
pub trait Integrator: Send {
    /// Largest stable time step (s) with its safety factor; `None` where there is no limit.
    fn stable_dt(&mut self, body: &Body) -> Option<f64>;

    /// One step. On `Err` the body and the books are as before.
    fn step(&mut self, body: &mut Body, clock: Clock, work: &mut Work) -> Result<(), Fault>;

    /// Nodal kinetic energy after the last step (kJ/m).
    fn nodal_kinetic_energy(&self) -> f64;

    /// Energies booked so far.
    fn books(&self) -> Books;

    /// Bytes held by grid and nodes.
    fn bytes(&self) -> usize;
}
