//! From a correlation and a lattice to fields: what is asked for, what was built, how accurate it is.

use std::fmt;

pub use super::map::Scratch;
use super::{
    choose::{self, Chosen},
    correlation::Correlation,
    embedding::Embedding,
    exact::Exact,
    implied,
    map::Map,
    normals::Normals,
    squash::Squash,
    table::{Lattice, Table},
};

/// Shortest scale of fluctuation (cells): below it averages are independent, and the quadrature gets long.
const THETA_LEAST: f64 = 1e-3;
/// Most cells of a field: half a gigabyte.
const CELLS_MOST: f64 = 67_108_864.0;

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
    /// Largest |implied - target| correlation of two cells, both over the target's variance.
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

/// One way of making fields. A new one is a variant here and an arm in `Engine::map`.
enum Engine {
    Las(Squash),
    Exact(Exact),
    Embedding(Embedding),
}

impl Engine {
    fn map(&self) -> &dyn Map {
        match self {
            Engine::Las(las) => las,
            Engine::Exact(exact) => exact,
            Engine::Embedding(embedding) => embedding,
        }
    }
}

/// Makes fields; never changes, and is shared by threads.
pub struct Generator {
    engine: Engine,
    lattice: Lattice,
    accuracy: Accuracy,
    choice: String,
}

impl Generator {
    /// The generator of the spec.
    ///
    /// `auto` takes the cheapest subdivision that keeps the bound, if it is no dearer than the factor of all
    /// cells; then that factor, up to 4000 cells; then circulant embedding.
    ///
    /// # Errors
    /// Numbers out of range; a method that is not there for the lattice; a bound that the method does not keep.
    pub fn new(spec: &Spec) -> Result<Generator, FieldError> {
        check(spec)?;
        let target = Table::new(&spec.correlation, spec.lattice.cell, spec.lattice.cells);
        let generator = match spec.method {
            Method::Auto => return auto(spec, &target),
            Method::Las => Generator::of(spec, choose::plain(spec, &target)?, Engine::Las),
            Method::Exact => Generator::of(spec, choose::exact(spec, &target)?, Engine::Exact),
            Method::Embedding => Generator::of(spec, choose::embedding(spec)?, Engine::Embedding),
        };
        generator.bounded(spec)
    }

    fn of<E>(spec: &Spec, chosen: Chosen<E>, engine: impl FnOnce(E) -> Engine) -> Generator {
        let Chosen { engine: built, accuracy, choice } = chosen;
        Generator { engine: engine(built), lattice: spec.lattice, accuracy, choice }
    }

    /// This generator, if it keeps the bound.
    fn bounded(self, spec: &Spec) -> Result<Generator, FieldError> {
        if choose::keeps(&self.accuracy, &spec.bound) {
            return Ok(self);
        }
        Err(FieldError::Inaccurate { bound: spec.bound, best: self.accuracy, method: self.choice })
    }

    /// One realisation: a standard Gaussian field averaged over each cell, row by row, x fastest, lowest row
    /// first. Mean 0, variance that of the average over a cell (below 1). `out` must hold a number a cell.
    pub fn sample(&self, normals: &mut Normals, scratch: &mut Scratch, out: &mut [f64]) {
        self.engine.map().apply(normals, scratch, out);
    }

    /// How far the implied covariance is from the target.
    pub fn accuracy(&self) -> &Accuracy {
        &self.accuracy
    }

    /// Lowest and highest implied correlation of two cells at each lag (cells), which must be less than the lattice;
    /// over the pairs that hold one of up to 16 cells spread over the lattice.
    pub fn implied(&self, lags: &[[usize; 2]]) -> Vec<[f64; 2]> {
        implied::correlations(self.engine.map(), &self.lattice, lags)
    }

    /// Implied covariances of a cell, counted row by row, with all cells. `None` for a cell that is not there.
    pub fn covariances(&self, cell: usize) -> Option<Vec<f64>> {
        let there = cell < self.lattice.len();
        there.then(|| implied::Columns::new(self.engine.map()).covariances(cell).to_vec())
    }

    /// What was chosen and why.
    pub fn choice(&self) -> &str {
        &self.choice
    }

    /// Normals that a realisation takes.
    pub fn normals(&self) -> usize {
        self.engine.map().normals()
    }
}

fn auto(spec: &Spec, target: &Table) -> Result<Generator, FieldError> {
    let price = choose::exact_price(spec);
    let best = match choose::subdivision(spec, target, price.unwrap_or(f64::INFINITY)) {
        Ok(chosen) => return Ok(Generator::of(spec, chosen, Engine::Las)),
        Err(best) => best,
    };
    let other = if price.is_some() {
        choose::exact(spec, target).map(|chosen| Generator::of(spec, chosen, Engine::Exact))
    } else {
        choose::embedding(spec).map(|chosen| Generator::of(spec, chosen, Engine::Embedding))
    };
    match (other, best) {
        (Ok(mut generator), best) => {
            if let Some((worse, name)) = best {
                generator.choice +=
                    &format!("; no subdivision as cheap keeps the bound, {name} is off by {}", choose::errors(&worse));
            }
            generator.bounded(spec)
        }
        (Err(_), Some((best, method))) => Err(FieldError::Inaccurate { bound: spec.bound, best, method }),
        (Err(error), None) => Err(error),
    }
}

/// Whether the numbers are in range.
fn check(spec: &Spec) -> Result<(), FieldError> {
    let Spec { correlation, lattice, bound, .. } = spec;
    let positive = |v: f64| v > 0.0 && v.is_finite();
    for k in 0..2 {
        require(positive(lattice.cell[k]), "cell size", lattice.cell[k], "above 0 and finite")?;
        require(lattice.cells[k] > 0, "number of cells", lattice.cells[k] as f64, "at least 1")?;
        let cells = correlation.theta[k] / lattice.cell[k];
        require(cells >= THETA_LEAST, "scale of fluctuation", correlation.theta[k], "at least 1e-3 cells")?;
    }
    let cells = lattice.cells[0] as f64 * lattice.cells[1] as f64;
    require(cells <= CELLS_MOST, "number of cells", cells, "at most 2^26 in all")?;
    require(bound.correlation >= 0.0, "bound on correlations", bound.correlation, "at least 0")?;
    require(bound.variance >= 0.0, "bound on variances", bound.variance, "at least 0")
}

fn require(holds: bool, key: &'static str, value: f64, range: &'static str) -> Result<(), FieldError> {
    if holds { Ok(()) } else { Err(FieldError::Invalid { key, value, range }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::correlation::Family;

    const BOUND: Bound = Bound { correlation: 0.05, variance: 0.03 };

    fn spec(method: Method, theta: f64) -> Spec {
        let correlation = Correlation { family: Family::Markov, theta: [theta, 1.0] };
        Spec { correlation, lattice: Lattice { cell: [0.25; 2], cells: [100, 20] }, method, bound: BOUND }
    }

    fn sample(generator: &Generator, mut normals: Normals, cells: usize) -> Vec<f64> {
        let mut out = vec![0.0; cells];
        generator.sample(&mut normals, &mut Scratch::default(), &mut out);
        out
    }

    #[test]
    fn auto_keeps_the_bound_on_the_lattice_of_the_paper() {
        for (theta, engine) in [(1.0, "Cholesky"), (6.0, "subdivision"), (48.0, "subdivision")] {
            let generator = Generator::new(&spec(Method::Auto, theta)).unwrap();
            let a = *generator.accuracy();
            assert!(a.correlation_error <= 0.05 && a.variance_error <= 0.03, "{a:?}");
            assert!(generator.choice().contains(engine), "{}", generator.choice());
            let fast = engine == "subdivision";
            assert_eq!(a.checked == 2000, fast, "all columns of a subdivision are computed");
        }
    }

    #[test]
    fn what_does_not_keep_the_bound_is_refused_with_its_error() {
        let error = Generator::new(&spec(Method::Las, 48.0)).err().unwrap();
        let FieldError::Inaccurate { best, .. } = &error else { panic!("{error}") };
        assert!(best.correlation_error > 0.05 && error.to_string().contains("no generator keeps"), "{error}");
        let loose = Bound { correlation: 1.0, variance: 1.0 };
        let generator = Generator::new(&Spec { bound: loose, ..spec(Method::Las, 48.0) }).unwrap();
        assert!(generator.choice().contains("25 x 5"), "{}", generator.choice());
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        let bad = |change: fn(&mut Spec)| {
            let mut spec = spec(Method::Auto, 1.0);
            change(&mut spec);
            let Err(FieldError::Invalid { key, .. }) = Generator::new(&spec) else { panic!("accepted") };
            key
        };
        assert_eq!(bad(|s| s.lattice.cell[1] = f64::NAN), "cell size");
        assert_eq!(bad(|s| s.lattice.cells[0] = 0), "number of cells");
        assert_eq!(bad(|s| s.lattice.cells = [usize::MAX; 2]), "number of cells");
        assert_eq!(bad(|s| s.correlation.theta[0] = 0.0), "scale of fluctuation");
        assert_eq!(bad(|s| s.correlation.theta[0] = f64::NAN), "scale of fluctuation");
        assert_eq!(bad(|s| s.bound.variance = f64::NAN), "bound on variances");
    }

    /// A field without variation along an axis, or at all, is singular but not refused.
    #[test]
    fn infinite_scales_give_rows_and_constants() {
        for family in [Family::Markov, Family::MarkovSeparable, Family::Gaussian, Family::Spherical] {
            let mut spec = spec(Method::Auto, f64::INFINITY);
            spec.correlation.family = family;
            let z = sample(&Generator::new(&spec).unwrap(), Normals::new(1, 0, "c", false), 2000);
            // a ridge of 1e-8 of the variance is 1e-4 of the deviation; 6 of them
            assert!(z.chunks(100).all(|row| row.iter().all(|v| (v - row[0]).abs() < 6e-4)), "{family:?}");
            spec.correlation.theta = [f64::INFINITY; 2];
            let z = sample(&Generator::new(&spec).unwrap(), Normals::new(1, 0, "c", false), 2000);
            assert!(z.iter().all(|v| (v - z[0]).abs() < 6e-4), "{family:?}");
        }
    }

    #[test]
    fn mirrored_realisations_cancel_and_order_does_not_matter() {
        for theta in [1.0, 48.0] {
            let generator = Generator::new(&spec(Method::Auto, theta)).unwrap();
            let draw = |r: u64, mirrored: bool| sample(&generator, Normals::new(5, r, "c", mirrored), 2000);
            let (a, b, c) = (draw(0, false), draw(1, false), draw(0, true));
            assert!(a.iter().zip(&c).all(|(a, c)| a + c == 0.0));
            assert_ne!(a, b);
            let (mut scratch, mut again) = (Scratch::default(), vec![0.0; 2000]);
            for (r, wanted) in [(1, &b), (0, &a), (1, &b)] {
                generator.sample(&mut Normals::new(5, r, "c", false), &mut scratch, &mut again);
                assert_eq!(&again, wanted);
            }
        }
    }

    /// 4000 fields: means and covariances with a cell within four standard errors of what the table says.
    #[test]
    fn sampled_fields_have_the_covariance_of_the_table() {
        for (method, theta) in [(Method::Exact, 1.0), (Method::Auto, 48.0)] {
            let mut spec = spec(method, theta);
            spec.lattice.cells = [16, 8];
            spec.bound.correlation = 0.005;
            let generator = Generator::new(&spec).unwrap();
            let target = Table::new(&spec.correlation, spec.lattice.cell, spec.lattice.cells);
            let fields: Vec<Vec<f64>> =
                (0..4000).map(|r| sample(&generator, Normals::new(2, r, "c", false), 128)).collect();
            let mean = |of: &dyn Fn(&[f64]) -> f64| fields.iter().map(|z| of(z)).sum::<f64>() / 4000.0;
            let v = target.at(0, 0);
            for cell in (0..128).step_by(9) {
                assert!(mean(&|z| z[cell]).abs() < 4.0 * (v / 4000.0).sqrt());
                let wanted = target.at((cell % 16).abs_diff(7), (cell / 16).abs_diff(3));
                let error = ((v * v + wanted * wanted) / 4000.0).sqrt();
                // and what the generator may be off by
                let allowed = 4.0 * error + 0.005 * v;
                assert!((mean(&|z| z[cell] * z[3 * 16 + 7]) - wanted).abs() < allowed, "cell {cell}");
            }
        }
    }

    #[test]
    fn a_generator_is_shared_by_threads() {
        fn shared<T: Send + Sync>() {}
        shared::<Generator>();
    }
}
