//! Mathematics that knows nothing of soil: tensors, statistics.

pub mod stats;
pub mod tensor;
