//! Frames of a run as VTK files, which ParaView and PyVista open and which [`read_vtp`] reads
//! back to the last bit.
//!
//! A frame is XML PolyData (`.vtp`): one vertex per point in the order of the points' identities,
//! all arrays appended raw, little-endian, each behind its length in bytes as UInt64. Floats are
//! Float64. `displacement` is there for the eye; reading takes the position and `reference`.

mod column;
mod pvd;
mod read;
mod write;

pub(super) use pvd::escape;
pub use pvd::{read_pvd, write_pvd};
pub use read::read_vtp;
pub use write::write_vtp;

#[cfg(test)]
mod tests;
