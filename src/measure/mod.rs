//! Measures of a body or of a snapshot: pure functions.

pub mod blocks;
pub mod slide;
pub mod summary;

pub use blocks::{Plateau, plateaus};
pub use slide::SlideProbe;
pub use summary::Measures;
