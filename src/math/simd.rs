//! Which instructions the hot kernels are compiled for, chosen once at run time.
//!
//! The kernels are plain loops over lanes, written without fused multiply-add, so every path
//! rounds alike: AVX2 only makes the same operations wider. The bits of a result therefore do
//! not depend on the path; `record.build.fp_path` names the arithmetic, [`FpPath::NAME`].

use std::sync::OnceLock;

/// The instruction set of the hot kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpPath {
    /// What the target guarantees (SSE2 on x86-64).
    Baseline,
    /// 256-bit vectors, if the processor has them.
    Avx2,
}

/// A hot loop. `run` must be `#[inline(always)]`, so that it is compiled once for each path.
pub trait Kernel {
    type Output;
    fn run(self) -> Self::Output;
}

impl FpPath {
    /// Name of the arithmetic: products and sums rounded one by one, on every path.
    pub const NAME: &'static str = "separate-mul-add";

    /// The best path of this processor. `RMPM_FP_PATH=baseline` in the environment asks for the
    /// baseline, to measure or to test it.
    pub fn best() -> Self {
        static BEST: OnceLock<FpPath> = OnceLock::new();
        *BEST.get_or_init(Self::detect)
    }

    fn detect() -> Self {
        if std::env::var("RMPM_FP_PATH").is_ok_and(|v| v == "baseline") {
            return FpPath::Baseline;
        }
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            return FpPath::Avx2;
        }
        FpPath::Baseline
    }

    /// Runs the kernel, compiled for this path.
    #[inline(always)]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            FpPath::Baseline => kernel.run(),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `Avx2` is only made by `detect`, which has found AVX2 on this processor.
            FpPath::Avx2 => unsafe { run_avx2(kernel) },
            #[cfg(not(target_arch = "x86_64"))]
            FpPath::Avx2 => kernel.run(),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}
