//! Studies: many runs to answer one question.

pub mod arms;
mod clock;
pub mod compare;
pub mod converge;
pub mod cost;
mod digits;
pub mod ensemble;
pub mod fields;
pub mod multilevel;
pub mod quantity;
pub mod strength_reduction;
pub mod validate;
pub mod variant;
pub(crate) mod workers;
