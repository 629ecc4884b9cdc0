//! Which instructions the hot kernels are compiled for, chosen once at run time.
//!
//! The kernels are plain loops over lanes, written without fused multiply-add, so every path
//! rounds alike: wider vectors only do more of the same operations at once. The bits of a result
//! therefore do not depend on the path; `record.build.fp_path` names the arithmetic, [`FpPath::NAME`].

use std::{fmt, sync::OnceLock};

/// An instruction set that this processor has, for the hot kernels. There is no way to make one
/// that it lacks.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct FpPath(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd)]
enum Set {
    Baseline,
    Avx2,
    Avx512,
}

/// A hot loop. `run` must be `#[inline(always)]`, so that it is compiled once for each path.
pub trait Kernel {
    type Output;
    fn run(self) -> Self::Output;
}

impl FpPath {
    /// Name of the arithmetic: products and sums rounded one by one, on every path.
    pub const NAME: &'static str = "separate-mul-add";

    /// What the target guarantees (SSE2 on x86-64).
    pub const BASELINE: FpPath = FpPath(Set::Baseline);

    /// The best path of this processor. `RMPM_FP_PATH=baseline` or `avx2` in the environment asks
    /// for none better than that, to measure or to test it.
    pub fn best() -> Self {
        static BEST: OnceLock<FpPath> = OnceLock::new();
        *BEST.get_or_init(|| {
            let most = match std::env::var("RMPM_FP_PATH").as_deref() {
                Ok("baseline") => Set::Baseline,
                Ok("avx2") => Set::Avx2,
                _ => Set::Avx512,
            };
            Self::all().filter(|p| p.0 <= most).last().unwrap_or(Self::BASELINE)
        })
    }

    /// The paths of this processor, the best one last.
    pub fn all() -> impl Iterator<Item = Self> {
        [Set::Baseline, Set::Avx2, Set::Avx512].into_iter().filter(|s| s.is_here()).map(FpPath)
    }

    /// Runs the kernel, compiled for this path.
    #[inline(always)]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: an `FpPath` of this set is only made by `all`, which has found its features here.
            Set::Avx512 => unsafe { run_avx512(kernel) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Set::Avx2 => unsafe { run_avx2(kernel) },
            _ => kernel.run(),
        }
    }
}

/// `baseline`, `avx2` or `avx512`.
impl fmt::Display for FpPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.0 {
            Set::Baseline => "baseline",
            Set::Avx2 => "avx2",
            Set::Avx512 => "avx512",
        })
    }
}

impl fmt::Debug for FpPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Set {
    /// Whether this processor has the features that the wrapper below enables.
    #[cfg(target_arch = "x86_64")]
    fn is_here(self) -> bool {
        use std::arch::is_x86_feature_detected as has;
        let avx2 = || has!("avx2") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt");
        match self {
            Set::Baseline => true,
            Set::Avx2 => avx2(),
            Set::Avx512 => avx2() && has!("avx512f") && has!("avx512vl") && has!("avx512dq") && has!("avx512bw"),
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn is_here(self) -> bool {
        self == Set::Baseline
    }
}

/// 256-bit vectors.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

/// 512-bit vectors.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}
