//! Mathematics that knows nothing of soil: tensors, statistics.

pub mod circle;
pub mod outline;
pub mod polygon;
pub mod simd;
pub mod stats;
pub mod strip;
pub mod tensor;
