//! Measures of a body or of a snapshot: pure functions.

pub mod blocks;
pub mod onset;
pub mod pieces;
pub mod probe;
pub mod slide;
pub mod split;
pub mod summary;

pub use blocks::{Plateau, plateaus};
pub use onset::InitialFailure;
pub use pieces::pieces;
pub use probe::Reading;
pub use slide::SlideProbe;
pub use summary::Measures;
