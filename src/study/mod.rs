//! Studies: many runs to answer one question.

pub mod converge;
pub mod validate;
pub mod variant;
