//! What the random fields of a case are: the exact figures of their generators, and what realisations came to.

mod expected;
mod profile;
mod text;

use std::time::Instant;

use serde::Serialize;

use crate::{
    case::{self, Case, Parameter},
    field::{
        correlation::Correlation,
        generator::Accuracy,
        model::{Counts, Draw, Drawn, Model},
        table::Table,
    },
    math::stats::Summary,
    scene::{Fields, SceneError, fields},
};

pub use expected::Expected;
pub use profile::profile;
pub use text::table;

/// A field: what is asked for, what was built, how far it is from the target.
#[derive(Clone, Debug, Serialize)]
pub struct FieldReport {
    pub name: String,
    pub material: String,
    pub parameters: Vec<Parameter>,
    /// Unit of the first parameter, which the values below are of; empty for a number.
    pub unit: &'static str,
    /// Mean of point values at the datum.
    pub mean: f64,
    /// Standard deviation of point values at the datum.
    pub sd: f64,
    #[serde(flatten)]
    pub marginal: case::Marginal,
    pub correlation: case::CorrelationFamily,
    /// Scales of fluctuation (m) along x and the vertical.
    pub theta_m: [f64; 2],
    /// Growth of the mean with depth, as a share (1/m).
    pub depth_gradient: f64,
    /// Lower left corner (m).
    pub origin_m: [f64; 2],
    pub cell_m: [f64; 2],
    pub cells: [usize; 2],
    /// What generates it, and why; `None` where nothing varies.
    pub generator: Option<String>,
    /// Normals that a realisation takes.
    pub normals: usize,
    /// Exact errors of the generator.
    pub accuracy: Option<Accuracy>,
    /// Largest errors that are allowed: of a correlation, and of the variance (relative).
    pub allowed: [f64; 2],
    /// Variance of the average over a cell of a field whose points have variance 1.
    pub target_variance: f64,
    /// Exact figures of the factor on the mean in a cell.
    pub expected: Expected,
    /// Correlations at a few lags along each axis.
    pub correlations: Vec<Lag>,
    pub realisations: Vec<u64>,
    pub drawn: Vec<Realised>,
    pub sampled: Sampled,
}

/// A correlation between cells.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Lag {
    pub lag_cells: [usize; 2],
    pub lag_m: [f64; 2],
    pub target: f64,
    /// Lowest and highest that the generator implies, over pairs of cells spread over the lattice.
    pub implied: [f64; 2],
}

/// One realisation.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Realised {
    pub realisation: u64,
    #[serde(flatten)]
    pub counts: Counts,
    /// Mean of the factors over the cells.
    pub mean_factor: f64,
    /// Mean square of the factors about their exact mean, over the cells, and its root.
    pub sd_factor: f64,
    pub lowest_factor: f64,
    pub highest_factor: f64,
}

/// All realisations together.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Sampled {
    /// Mean of the factors, and its exact standard error.
    pub mean_factor: f64,
    pub mean_standard_error: f64,
    /// Root of the mean square of the factors about their exact mean, and its standard error for a normal field (a
    /// lognormal one scatters a little more).
    pub sd_factor: f64,
    pub sd_standard_error: f64,
}

/// Realisations of one field, and the time each took on average (ms).
pub struct Draws {
    pub drawn: Vec<Drawn>,
    pub ms_per_field: f64,
}

/// Draws `count` realisations of a field, from `first` on.
///
/// # Errors
/// A field that cannot be drawn as its rule for low values asks.
pub fn draw(case: &Case, model: &Model, first: u64, count: u64) -> Result<Draws, SceneError> {
    let started = Instant::now();
    let one = |k: u64| {
        let draw =
            Draw { master: case.seed, realisation: first.saturating_add(k), antithetic: case.ensemble.antithetic };
        model.draw(draw).map_err(|e| SceneError {
            key: format!("field.{}.low_values", model.name),
            message: e.to_string(),
            too_large: false,
        })
    };
    let drawn: Vec<Drawn> = (0..count).map(one).collect::<Result<_, _>>()?;
    Ok(Draws { drawn, ms_per_field: 1e3 * started.elapsed().as_secs_f64() / count.max(1) as f64 })
}

/// Describes a field and its realisations, the first of which is `first`. `None` for a field without a mean, which
/// the case does not allow.
pub fn report(case: &Case, fields: &Fields, name: &str, first: u64, drawn: &[Drawn]) -> Option<FieldReport> {
    let field = case.field.get(name)?;
    let model = fields.models().iter().find(|m| m.name == name)?;
    let parameter = *field.parameters.first()?;
    let mean = parameter.of(case.material.get(&field.material)?)?;
    let generator = model.generator.as_ref();
    let target = target(field, model);
    let expected = Expected::of(&model.marginal, target.at(0, 0));
    Some(FieldReport {
        name: name.to_owned(),
        material: field.material.clone(),
        parameters: field.parameters.clone(),
        unit: parameter.unit(),
        mean,
        sd: mean * field.variation,
        marginal: field.marginal,
        correlation: field.correlation,
        theta_m: [field.theta_h, field.theta_v],
        depth_gradient: field.depth_gradient,
        origin_m: model.origin,
        cell_m: model.lattice.cell,
        cells: model.lattice.cells,
        generator: generator.map(|g| g.choice().to_owned()),
        normals: generator.map_or(0, |g| g.normals()),
        accuracy: generator.map(|g| *g.accuracy()),
        allowed: [field.correlation_error, field.variance_error],
        target_variance: target.at(0, 0),
        expected,
        correlations: correlations(model, &target),
        realisations: (0..drawn.len() as u64).map(|k| first + k).collect(),
        drawn: drawn.iter().zip(first..).map(|(d, k)| realised(d, k, &expected)).collect(),
        sampled: sampled(model, &target, &expected, drawn),
    })
}

/// Covariances of the cells' averages, as far as they are not 0 to rounding.
fn target(field: &case::Field, model: &Model) -> Table {
    /// Scales of fluctuation after which every family has lost its correlation.
    const FAR: f64 = 20.0;
    let correlation: Correlation = fields::correlation(field);
    let lags = [0, 1].map(|k| {
        let far = (FAR * correlation.theta[k] / model.lattice.cell[k]).ceil() + 2.0;
        // a cast of what is too large takes the largest number
        model.lattice.cells[k].min(far as usize).max(1)
    });
    Table::new(&correlation, model.lattice.cell, lags)
}

/// Lags of 1, 2, 4, 8, ... cells along x, then along the vertical.
fn correlations(model: &Model, target: &Table) -> Vec<Lag> {
    let Some(generator) = &model.generator else { return Vec::new() };
    let axis = |k: usize| {
        let lengths = std::iter::successors(Some(1_usize), |n| n.checked_mul(2));
        lengths.take_while(move |n| *n < target.lags()[k]).map(move |n| if k == 0 { [n, 0] } else { [0, n] })
    };
    let lags: Vec<[usize; 2]> = axis(0).chain(axis(1)).collect();
    let lag = |(cells, implied): (&[usize; 2], [f64; 2])| Lag {
        lag_cells: *cells,
        lag_m: [0, 1].map(|k| cells[k] as f64 * model.lattice.cell[k]),
        target: target.at(cells[0], cells[1]) / target.at(0, 0),
        implied,
    };
    lags.iter().zip(generator.implied(&lags)).map(lag).collect()
}

fn realised(drawn: &Drawn, realisation: u64, expected: &Expected) -> Realised {
    let fold = |start: f64, pick: fn(f64, f64) -> f64| drawn.factors.iter().copied().fold(start, pick);
    Realised {
        realisation,
        counts: drawn.counts,
        mean_factor: mean(&drawn.factors, |f| f),
        sd_factor: mean(&drawn.factors, |f| (f - expected.mean_factor).powi(2)).sqrt(),
        lowest_factor: fold(f64::INFINITY, f64::min),
        highest_factor: fold(f64::NEG_INFINITY, f64::max),
    }
}

fn sampled(model: &Model, target: &Table, expected: &Expected, drawn: &[Drawn]) -> Sampled {
    let over = |f: &dyn Fn(f64) -> f64| {
        let means: Vec<f64> = drawn.iter().map(|d| mean(&d.factors, f)).collect();
        Summary::of(&means).map_or(f64::NAN, |s| s.mean)
    };
    let sd = over(&|f| (f - expected.mean_factor).powi(2)).sqrt();
    let [mean_error, square_error] = expected::standard_errors(model, target, expected, drawn.len());
    Sampled {
        mean_factor: over(&|f| f),
        mean_standard_error: mean_error,
        sd_factor: sd,
        // d sqrt(q) = dq / (2 sqrt(q))
        sd_standard_error: if sd > 0.0 { square_error / (2.0 * sd) } else { 0.0 },
    }
}

fn mean(values: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    values.iter().map(|v| f(*v)).sum::<f64>() / values.len() as f64
}
