//! Studies: many runs to answer one question.

pub mod compare;
pub mod converge;
pub mod validate;
pub mod variant;
