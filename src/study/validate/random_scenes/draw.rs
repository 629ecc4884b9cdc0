//! What a scene is drawn with.

use crate::field::stream::{Purpose, Stream};

/// Random choices of one scene.
pub(super) struct Draw(Stream);

impl Draw {
    /// Those of scene `number` of a seed.
    pub fn new(seed: u64, number: u64) -> Self {
        Draw(Stream::new(seed, number, Purpose::Scene))
    }

    /// Uniform.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    /// Uniform in the logarithm; both ends above 0.
    pub fn spread(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// From `low` to `high`, both included.
    pub fn whole(&mut self, low: u32, high: u32) -> u32 {
        low + (self.0.uniform() * f64::from(high - low + 1)) as u32
    }

    /// True with probability `p`.
    pub fn chance(&mut self, p: f64) -> bool {
        self.0.uniform() < p
    }

    /// One of a list that is not empty.
    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.whole(0, list.len() as u32 - 1) as usize]
    }
}
