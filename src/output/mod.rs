//! What a run leaves behind.

pub mod atomic;
pub mod field;
pub mod folder;
pub mod history;
pub mod pictures;
pub mod plot;
pub mod record;
pub mod vtk;
