//! What was typed: the case file, its keys, its defaults, its errors. No physics.

mod types;

pub use types::*;

impl Case {
    /// Placeholder until the reader lands.
    pub fn memory_estimate_bytes(&self) -> u64 {
        0
    }
}
