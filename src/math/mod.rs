//! Mathematics that knows nothing of soil: tensors, statistics, sparse systems of equations.

pub mod circle;
pub mod fused;
pub mod linear;
pub mod newton;
pub mod ordering;
pub mod outline;
pub mod polygon;
pub mod simd;
pub mod sparse;
pub mod stats;
pub mod strip;
pub mod sums;
pub mod team;
pub mod tensor;
