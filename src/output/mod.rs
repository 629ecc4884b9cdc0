//! What a run leaves behind.

pub mod atomic;
pub mod plot;
pub mod vtk;
