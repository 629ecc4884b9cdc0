//! Mathematics that knows nothing of soil: tensors, statistics, sparse systems of equations.

pub mod circle;
pub mod linear;
pub mod ordering;
pub mod outline;
pub mod polygon;
pub mod simd;
pub mod sparse;
pub mod stats;
pub mod strip;
pub mod tensor;
