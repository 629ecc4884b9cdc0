//! What was typed: the case file, its keys, its defaults, its errors. No physics.

mod types;

pub use types::*;
