//! Instructions for the solvers of equations, chosen once at run time: products and sums may be fused.

use std::sync::OnceLock;

/// Products and sums as the instructions have them. Solvers of equations may fuse them, as their answers are checked
/// and do not claim equal bits on every processor; the hot kernels of the points must not.
pub trait Arithmetic {
    /// a b + c
    fn mul_add(a: f64, b: f64, c: f64) -> f64;
}

/// Rounded once.
pub struct Once;

impl Arithmetic for Once {
    #[inline(always)]
    fn mul_add(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }
}

/// Rounded twice, where a fused instruction would be a call of a library.
pub struct Twice;

impl Arithmetic for Twice {
    #[inline(always)]
    fn mul_add(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }
}

/// A loop over blocks of `R` values whose products and sums may be fused. `run` must be `#[inline(always)]`.
pub trait FusedKernel {
    type Output;
    fn run<A: Arithmetic, const R: usize>(self) -> Self::Output;
}

/// An instruction set that this processor has, for the solvers of equations. There is no way to make one that it lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fused(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Set {
    /// What the target guarantees.
    Baseline,
    /// 256-bit vectors with fused products and sums.
    Avx2,
    /// 512-bit vectors with fused products and sums.
    Avx512,
}

impl Fused {
    /// What the target guarantees.
    pub const BASELINE: Fused = Fused(Set::Baseline);

    /// The best of this processor.
    pub fn best() -> Self {
        static BEST: OnceLock<Fused> = OnceLock::new();
        *BEST.get_or_init(|| {
            #[cfg(target_arch = "x86_64")]
            {
                let fma = std::arch::is_x86_feature_detected!("fma");
                if fma && std::arch::is_x86_feature_detected!("avx512f") {
                    return Fused(Set::Avx512);
                }
                if fma && std::arch::is_x86_feature_detected!("avx2") {
                    return Fused(Set::Avx2);
                }
            }
            Self::BASELINE
        })
    }

    /// Runs the kernel, compiled for this path.
    #[inline(always)]
    pub fn run<K: FusedKernel>(self, kernel: K) -> K::Output {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: this set is only made by `best`, which has found AVX-512F and FMA on this processor.
            Set::Avx512 => unsafe { run_avx512(kernel) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: this set is only made by `best`, which has found AVX2 and FMA on this processor.
            Set::Avx2 => unsafe { run_avx2(kernel) },
            _ => kernel.run::<Twice, 4>(),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn run_avx512<K: FusedKernel>(kernel: K) -> K::Output {
    kernel.run::<Once, 8>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<K: FusedKernel>(kernel: K) -> K::Output {
    kernel.run::<Once, 4>()
}
