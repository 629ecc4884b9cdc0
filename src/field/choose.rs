//! Which generator a lattice gets: the cheapest whose implied covariance keeps the bound.

use super::{
    embedding::Embedding,
    exact::Exact,
    generator::{Accuracy, Bound, FieldError, Method, Spec},
    implied::accuracy,
    las::{self, FENTON},
    map::Map,
    squash::Squash,
    table::Table,
};

/// Cells up to which `auto` takes the Cholesky factor of all of them: 64 MB and some 6 ms a realisation.
const EXACT_AUTO: usize = 4000;
/// Cells up to which it can be asked for: 0.8 GB while it is made.
const EXACT_MOST: usize = 10_000;
/// Cells of stage 0 that are tried, most.
const ROOTS: [usize; 2] = [FENTON, 1024];
/// How much finer rows or columns may be.
const FINER: [usize; 5] = [1, 2, 4, 8, 16];
/// Finest cells of finer rows or columns.
const FINEST_MOST: usize = 1 << 22;
/// Lags of a table, where that is more than four a cell: a long thin lattice has tall cells in stage 0.
const LAGS_MOST: usize = 10_000_000;
/// Columns of the covariance that a candidate is first judged by.
const PROBE: usize = 8;
/// Columns times finest cells that the final judgement may take: about a second.
const CHECK: usize = 40_000_000;
const CHECK_LEAST: usize = 16;
/// Prices in nanoseconds (benches/field.rs): a finest cell, and an entry of a triangular factor.
const PRICE_CELL: f64 = 8.0;
const PRICE_ENTRY: f64 = 0.4;

/// What was chosen.
pub(super) struct Chosen<E> {
    pub engine: E,
    pub accuracy: Accuracy,
    pub choice: String,
}

/// A subdivision that may do.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Candidate {
    finer: [usize; 2],
    limit: usize,
    price: f64,
}

/// The subdivisions in the order of their price.
fn candidates(spec: &Spec) -> Vec<Candidate> {
    let mut found: Vec<Candidate> = Vec::new();
    for by in FINER {
        for limit in ROOTS {
            let candidate = Candidate::new(spec, by, limit);
            // a larger limit that changes nothing is the same generator
            if candidate.fits(spec)
                && found.last().is_none_or(|c| c.root(spec) != candidate.root(spec) || c.finer != candidate.finer)
            {
                found.push(candidate);
            }
        }
    }
    found.sort_by(|a, b| a.price.total_cmp(&b.price));
    found
}

impl Candidate {
    /// The axis whose scale of fluctuation has fewer cells is the one made finer.
    fn new(spec: &Spec, by: usize, limit: usize) -> Self {
        let [x, z] = [0, 1].map(|k| spec.correlation.theta[k] / spec.lattice.cell[k]);
        let finer = if x < z { [by, 1] } else { [1, by] };
        let mut candidate = Candidate { finer, limit, price: 0.0 };
        let root = candidate.root(spec).iter().product::<usize>() as f64;
        candidate.price = PRICE_CELL * candidate.cells(spec) as f64 + PRICE_ENTRY * 0.5 * root * root;
        candidate
    }

    fn plan(&self, spec: &Spec) -> Vec<[usize; 2]> {
        las::plan([0, 1].map(|k| spec.lattice.cells[k] * self.finer[k]), self.limit)
    }

    fn root(&self, spec: &Spec) -> [usize; 2] {
        self.plan(spec).first().copied().unwrap_or_default()
    }

    /// Finest cells.
    fn cells(&self, spec: &Spec) -> usize {
        spec.lattice.len() * self.finer[0] * self.finer[1]
    }

    fn fits(&self, spec: &Spec) -> bool {
        let lags = las::lags(&self.plan(spec));
        let table = lags[0].saturating_mul(lags[1]);
        let plain = self.finer == [1, 1];
        table <= LAGS_MOST.max(4 * self.cells(spec)) && (plain || self.cells(spec) <= FINEST_MOST)
    }

    fn build(&self, spec: &Spec) -> Option<Squash> {
        Squash::new(&spec.correlation, &spec.lattice, self.finer, self.limit)
    }

    fn describe(&self, spec: &Spec) -> String {
        let [x, z] = self.root(spec);
        let finer = match self.finer {
            [1, 1] => String::new(),
            [1, n] => format!(" on rows {n} times finer"),
            [n, _] => format!(" on columns {n} times finer"),
        };
        format!("local average subdivision{finer} from {x} x {z} exact cells")
    }
}

/// Columns to look at where a map has so many finest cells.
fn columns(finest: usize) -> usize {
    (CHECK / finest.max(1)).max(CHECK_LEAST)
}

pub(super) fn keeps(accuracy: &Accuracy, bound: &Bound) -> bool {
    accuracy.correlation_error <= bound.correlation && accuracy.variance_error <= bound.variance
}

/// The two errors, in words.
pub(super) fn errors(accuracy: &Accuracy) -> String {
    format!("{:.3} and {:.1} %", accuracy.correlation_error, 100.0 * accuracy.variance_error)
}

/// What an accuracy is, in words.
pub(super) fn figures(accuracy: &Accuracy, spec: &Spec) -> String {
    let [x, z] = accuracy.at_lag_m;
    format!(
        "correlations off by at most {:.4} (at a lag of {x:.2}, {z:.2} m), variances by {:.2} %, computed for {} of {} cells",
        accuracy.correlation_error,
        100.0 * accuracy.variance_error,
        accuracy.checked,
        spec.lattice.len()
    )
}

/// The first subdivision that keeps the bound, of those up to `ceiling` (ns); else the most accurate one that
/// was looked at, with a lower bound of its errors.
pub(super) fn subdivision(
    spec: &Spec,
    target: &Table,
    ceiling: f64,
) -> Result<Chosen<Squash>, Option<(Accuracy, String)>> {
    let mut best: Option<(Accuracy, String)> = None;
    for candidate in candidates(spec).iter().take_while(|c| c.price <= ceiling) {
        let Some(map) = candidate.build(spec) else { continue };
        match judge(&map, candidate.cells(spec), spec, target) {
            Ok(accuracy) => {
                let mut choice = format!("{}: {}", candidate.describe(spec), figures(&accuracy, spec));
                if let Some((worse, name)) = best {
                    choice += &format!("; of cheaper ones the best, {name}, is off by {}", errors(&worse));
                }
                return Ok(Chosen { engine: map, accuracy, choice });
            }
            Err(accuracy) if best.as_ref().is_none_or(|b| accuracy.correlation_error < b.0.correlation_error) => {
                best = Some((accuracy, candidate.describe(spec)));
            }
            Err(_) => {}
        }
    }
    Err(best)
}

/// A few columns first, which most that will not do fail at.
fn judge(map: &dyn Map, finest: usize, spec: &Spec, target: &Table) -> Result<Accuracy, Accuracy> {
    let probe = accuracy(map, target, &spec.lattice, PROBE);
    if !keeps(&probe, &spec.bound) {
        return Err(probe);
    }
    let full = accuracy(map, target, &spec.lattice, columns(finest));
    if keeps(&full, &spec.bound) { Ok(full) } else { Err(full) }
}

/// Plain subdivision with Fenton's stage 0, whether it keeps the bound or not.
pub(super) fn plain(spec: &Spec, target: &Table) -> Result<Chosen<Squash>, FieldError> {
    let unavailable = |reason| FieldError::Unavailable { method: Method::Las, cells: spec.lattice.len(), reason };
    let candidate = Candidate::new(spec, 1, FENTON);
    if !candidate.fits(spec) {
        return Err(unavailable("the lattice is too long and thin for the table of its covariances"));
    }
    let engine = candidate.build(spec).ok_or(unavailable("a covariance matrix has no factor"))?;
    let accuracy = accuracy(&engine, target, &spec.lattice, columns(spec.lattice.len()));
    let choice = format!("{}, as asked for: {}", candidate.describe(spec), figures(&accuracy, spec));
    Ok(Chosen { engine, accuracy, choice })
}

/// The factor of all cells.
pub(super) fn exact(spec: &Spec, target: &Table) -> Result<Chosen<Exact>, FieldError> {
    let cells = spec.lattice.len();
    let unavailable = |reason| FieldError::Unavailable { method: Method::Exact, cells, reason };
    if cells > EXACT_MOST {
        return Err(unavailable("the covariance matrix of more than 10,000 cells takes too much memory"));
    }
    let engine = Exact::new(target, spec.lattice.cells).ok_or(unavailable("the covariance matrix has no factor"))?;
    let accuracy = accuracy(&engine, target, &spec.lattice, CHECK_LEAST);
    let choice = format!("Cholesky factor of all {cells} cells: {}", figures(&accuracy, spec));
    Ok(Chosen { engine, accuracy, choice })
}

/// Circulant embedding.
pub(super) fn embedding(spec: &Spec) -> Result<Chosen<Embedding>, FieldError> {
    let cells = spec.lattice.len();
    let reason = "its periodic plane has more than 2^24 cells; take fewer or larger cells";
    let too_large = |_| FieldError::Unavailable { method: Method::Embedding, cells, reason };
    let engine = Embedding::new(&spec.correlation, &spec.lattice).map_err(too_large)?;
    let accuracy = engine.accuracy();
    let choice = format!("{}: {}", engine.words(), figures(&accuracy, spec));
    Ok(Chosen { engine, accuracy, choice })
}

/// What a realisation by the factor of all cells costs (ns), where `auto` may take it.
pub(super) fn exact_price(spec: &Spec) -> Option<f64> {
    let n = spec.lattice.len();
    (n <= EXACT_AUTO).then_some(PRICE_ENTRY * 0.5 * (n as f64).powi(2))
}
