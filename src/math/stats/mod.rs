//! Statistics of samples: what an ensemble of runs tells, and how well it knows it.
//!
//! Pure functions of slices. What resamples does so with a seeded counter-based generator, so the
//! same sample and seed give the same bits.

mod bootstrap;
mod censored;
mod convergence;
mod decay;
mod exceed;
pub mod gauss;
mod goodness;
mod histogram;
pub mod levels;
mod moments;
mod normal;
mod order;
mod paired;
mod random;
pub mod richardson;
mod share;
mod summary;

pub use bootstrap::{Bootstrap, Resampled, Spread};
pub use censored::{CensoredFit, Censoring, Unfit};
pub use convergence::{Prefix, Reached, Rule, Running, Target, running};
pub use decay::{Bias, Rate, rate};
pub use exceed::{Exceed, Exceedance};
pub use goodness::{Goodness, NormalTest};
pub use histogram::{Bin, Binning, Histogram};
pub use moments::{Moments, QuantileEstimate};
pub use normal::NormalFit;
pub use order::log_slope;
pub use paired::{Correlation, Paired};
pub use share::{Share, ShareDifference};
pub use summary::{Summary, quantile};

/// The confidence of intervals where nothing else is asked for.
pub const CONFIDENCE: f64 = 0.95;

/// Half-width of a two-sided interval of this confidence in standard errors: 1.96 for 0.95.
/// `None` unless 0 < confidence < 1.
pub(crate) fn standard_errors(confidence: f64) -> Option<f64> {
    (confidence > 0.0 && confidence < 1.0).then(|| -gauss::quantile(0.5 * (1.0 - confidence)))
}
