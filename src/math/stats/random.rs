//! Numbers for resampling.

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

/// Marks the keys of this module, so that they are none of those that fields and jitter use.
const KEY: &[u8; 8] = b"resample";

/// An endless stream of numbers, the same for the same (seed, resample).
pub(super) struct Draws(ChaCha8Rng);

impl Draws {
    pub fn new(seed: u64, resample: usize) -> Self {
        let mut key = [0u8; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[24..].copy_from_slice(KEY);
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(resample as u64);
        Draws(rng)
    }

    /// Uniform on 0..n (n > 0), to 2^-64 n.
    pub fn index(&mut self, n: usize) -> usize {
        ((u128::from(self.0.next_u64()) * n as u128) >> 64) as usize
    }

    /// Uniform on (0, 1].
    fn uniform(&mut self) -> f64 {
        ((self.0.next_u64() >> 11) + 1) as f64 / (1u64 << 53) as f64
    }

    /// Two independent standard normals (Box and Muller 1958).
    pub fn normals(&mut self) -> [f64; 2] {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * self.uniform()).sin_cos();
        [radius * cos, radius * sin]
    }

    /// `n` values of a normal distribution.
    pub fn sample(&mut self, n: usize, mean: f64, sd: f64) -> Vec<f64> {
        let mut sample: Vec<f64> = (0..n.div_ceil(2)).flat_map(|_| self.normals()).map(|z| mean + sd * z).collect();
        sample.truncate(n);
        sample
    }
}
