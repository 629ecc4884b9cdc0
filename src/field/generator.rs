//! From a correlation and a lattice to fields: what is asked for, what was built, how accurate it is.

use std::fmt;

use super::{correlation::Correlation, normals::Normals, table::Lattice};

/// How fields are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The cheapest that keeps the bound.
    Auto,
    /// Local average subdivision (Fenton and Vanmarcke 1990), plain.
    Las,
    /// Cholesky of the covariance of all cells.
    Exact,
    /// Circulant embedding.
    Embedding,
}

/// What is allowed of a generator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Largest |implied - target| correlation.
    pub correlation: f64,
    /// Largest relative error of the variance of a cell.
    pub variance: f64,
}

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spec {
    pub correlation: Correlation,
    pub lattice: Lattice,
    pub method: Method,
    pub bound: Bound,
}

/// How far the covariance that a generator implies is from the target.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Accuracy {
    /// Largest |implied - target| correlation of two cells.
    pub correlation_error: f64,
    /// Lag (m) along x and the vertical at which it is.
    pub at_lag_m: [f64; 2],
    /// Largest relative error of the variance of a cell.
    pub variance_error: f64,
    /// Computed from the map of the normals; else sampled.
    pub exact: bool,
    /// Cells whose covariances with all others were looked at; all cells where this is the size of the lattice.
    pub checked: usize,
}

/// Why there is no generator.
#[derive(Clone, Debug, PartialEq)]
pub enum FieldError {
    /// A size, a count, a scale or a bound is out of range.
    Invalid { key: &'static str, value: f64, range: &'static str },
    /// No method keeps the bound; the best that was found.
    Inaccurate { bound: Bound, best: Accuracy, method: String },
    /// This method is not there for such a lattice.
    Unavailable { method: Method, cells: usize, reason: &'static str },
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FieldError::Invalid { key, value, range } => {
                write!(f, "the {key} of a random field is {value}; it must be {range}")
            }
            FieldError::Inaccurate { bound, best, method } => write!(
                f,
                "no generator keeps the bound of {} on correlations and {} on variances: {method} is off by {:.3} and {:.3}",
                bound.correlation, bound.variance, best.correlation_error, best.variance_error
            ),
            FieldError::Unavailable { method, cells, reason } => {
                write!(f, "a random field of {cells} cells cannot be made by the method {method:?}: {reason}")
            }
        }
    }
}

impl std::error::Error for FieldError {}

/// Buffers of a realisation; they grow with the first and are kept.
#[derive(Default)]
pub struct Scratch {
    pub(super) normals: Vec<f64>,
}

/// One way of making fields. A new one is a variant here, with its arms below.
enum Engine {}

/// Makes fields; never changes, and is shared by threads.
pub struct Generator {
    engine: Engine,
    accuracy: Accuracy,
    choice: String,
}

impl Generator {
    /// The generator of the spec.
    ///
    /// # Errors
    /// Numbers out of range; a method that is not there for the lattice; a bound that nothing keeps.
    pub fn new(spec: &Spec) -> Result<Generator, FieldError> {
        let cells = spec.lattice.cells[0] * spec.lattice.cells[1];
        Err(FieldError::Unavailable { method: spec.method, cells, reason: "no generator is built in yet" })
    }

    /// One realisation: a standard Gaussian field averaged over each cell, row by row, x fastest, lowest row
    /// first. Mean 0, variance that of the average over a cell (below 1). `out` holds one number a cell.
    pub fn sample(&self, _normals: &mut Normals, _scratch: &mut Scratch, _out: &mut [f64]) {
        match self.engine {}
    }

    /// How far the implied covariance is from the target.
    pub fn accuracy(&self) -> &Accuracy {
        &self.accuracy
    }

    /// What was chosen and why.
    pub fn choice(&self) -> &str {
        &self.choice
    }

    /// Normals that a realisation takes.
    pub fn normals(&self) -> usize {
        match self.engine {}
    }
}
