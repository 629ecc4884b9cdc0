//! The random fields of a case: made once for all realisations, drawn for one.

use serde::Serialize;

use super::{SceneError, refuse};
use crate::{
    case::{self, Case, Parameter},
    field::{
        correlation::{Correlation, Family},
        generator::{Accuracy, Bound, FieldError, Generator, Method, Spec},
        marginal::{Low, Marginal},
        model::{Counts, Draw, DrawError, Drawn, Model},
        table::Lattice,
    },
    math::stats::Summary,
};

/// The generators of a case's fields, in the order of their names. They hold no realisation: threads share
/// them.
#[derive(Default)]
pub struct Fields(Vec<Model>);

impl Fields {
    /// Makes the generators of a case.
    ///
    /// # Errors
    /// A field whose generator cannot keep the errors that the case asks for.
    pub fn of(case: &Case) -> Result<Fields, SceneError> {
        case.field.iter().map(|(name, field)| model(case, name, field)).collect::<Result<_, _>>().map(Fields)
    }

    /// The fields, in the order of `case.field`.
    pub fn models(&self) -> &[Model] {
        &self.0
    }

    /// The realisation that the case names.
    ///
    /// # Errors
    /// A field that cannot be drawn as its rule for low values asks.
    pub fn draw(&self, case: &Case) -> Result<Vec<Drawn>, SceneError> {
        let draw =
            Draw { master: case.seed, realisation: case.ensemble.realisation, antithetic: case.ensemble.antithetic };
        let refused = |name: &str, e: DrawError| refuse(&format!("field.{name}.low_values"), e.to_string());
        self.0.iter().map(|model| model.draw(draw).map_err(|e| refused(&model.name, e))).collect()
    }
}

fn model(case: &Case, name: &str, field: &case::Field) -> Result<Model, SceneError> {
    let (origin, lattice) = lattice(case, field);
    let spec = Spec {
        correlation: correlation(field),
        lattice,
        method: method(field.generator),
        bound: Bound { correlation: field.correlation_error, variance: field.variance_error },
    };
    let varies = field.variation > 0.0;
    let generator = varies.then(|| Generator::new(&spec)).transpose();
    let generator = generator.map_err(|e| refuse(&format!("field.{name}.{}", key(&e)), e.to_string()))?;
    Ok(Model { name: name.to_owned(), origin, lattice, marginal: marginal(field), generator })
}

/// The key to change: numbers out of range are sizes in cells.
fn key(error: &FieldError) -> &'static str {
    match error {
        FieldError::Invalid { .. } => "cell",
        FieldError::Inaccurate { .. } | FieldError::Unavailable { .. } => "generator",
    }
}

/// Cells over the rectangle around the material, from its lower left corner.
fn lattice(case: &Case, field: &case::Field) -> ([f64; 2], Lattice) {
    let own = case.region.iter().filter(|r| r.material == field.material).map(|r| r.shape.bounds());
    let around = |[a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]| {
        [[a[0].min(c[0]), a[1].min(c[1])], [b[0].max(d[0]), b[1].max(d[1])]]
    };
    let [low, high] = own.reduce(around).unwrap_or_default();
    let cells = [0, 1].map(|a| ((high[a] - low[a]) / field.cell - 1e-9).ceil().max(1.0) as usize);
    (low, Lattice { cell: [field.cell; 2], cells })
}

/// Family and scales of fluctuation of a field.
pub fn correlation(field: &case::Field) -> Correlation {
    Correlation { family: family(field.correlation), theta: [field.theta_h, field.theta_v] }
}

fn family(family: case::CorrelationFamily) -> Family {
    match family {
        case::CorrelationFamily::Markov => Family::Markov,
        case::CorrelationFamily::MarkovSeparable => Family::MarkovSeparable,
        case::CorrelationFamily::Gaussian => Family::Gaussian,
        case::CorrelationFamily::Spherical => Family::Spherical,
    }
}

fn method(generator: case::FieldGenerator) -> Method {
    match generator {
        case::FieldGenerator::Auto => Method::Auto,
        case::FieldGenerator::Las => Method::Las,
        case::FieldGenerator::Exact => Method::Exact,
        case::FieldGenerator::Embedding => Method::Embedding,
    }
}

fn marginal(field: &case::Field) -> Marginal {
    let variation = field.variation;
    match field.marginal {
        case::Marginal::Lognormal => Marginal::Lognormal { variation },
        case::Marginal::Normal { low_values } => {
            let low = match low_values {
                case::LowValues::Floor { floor } => Low::Floor(floor),
                case::LowValues::Resample { floor } => Low::Resample(floor),
                case::LowValues::None => Low::Keep,
            };
            Marginal::Normal { variation, low }
        }
    }
}

/// The fields of one material in one realisation: its parameters at each place.
pub struct Varied<'a> {
    material: &'a case::Material,
    fields: Vec<(&'a case::Field, &'a Drawn)>,
}

impl<'a> Varied<'a> {
    /// The fields that scale a material; `drawn` is in the order of `case.field`.
    pub fn new(case: &'a Case, name: &str, drawn: &'a [Drawn]) -> Option<Self> {
        let fields = case.field.values().zip(drawn).filter(|(field, _)| field.material == name).collect();
        Some(Varied { material: case.material.get(name)?, fields })
    }

    /// Whether no field scales the material.
    pub fn is_uniform(&self) -> bool {
        self.fields.is_empty()
    }

    /// The material at a place (m), with the number of values that had to give way to their limits.
    ///
    /// A parameter is mean x (1 + depth_gradient x depth) x factor of the cell.
    pub fn at(&self, x: [f64; 2]) -> (case::Material, u64) {
        let mut material = *self.material;
        for (field, drawn) in &self.fields {
            let factor = trend(field, x[1]) * drawn.at(x);
            field.parameters.iter().for_each(|p| scale(&mut material, *p, factor));
        }
        let limited = limit(&mut material);
        (material, limited)
    }
}

/// Mean of a parameter at a height (m), over its mean at the datum.
pub fn trend(field: &case::Field, y: f64) -> f64 {
    1.0 + field.depth_gradient * (field.datum - y)
}

fn scale(material: &mut case::Material, parameter: Parameter, factor: f64) {
    let (e, s) = match material {
        case::Material::Elastic { elastic } => (elastic, None),
        case::Material::VonMises { elastic, strength } => (elastic, Some(strength)),
    };
    match (parameter, s) {
        (Parameter::UnitWeight, _) => e.unit_weight *= factor,
        (Parameter::YoungModulus, _) => e.young_modulus *= factor,
        (Parameter::PoissonRatio, _) => e.poisson_ratio *= factor,
        (Parameter::Cohesion, Some(s)) => s.cohesion *= factor,
        (Parameter::ResidualCohesion, Some(s)) => s.residual_cohesion *= factor,
        (Parameter::SofteningModulus, Some(s)) => s.softening_modulus *= factor,
        (Parameter::YieldConstant, Some(s)) => s.yield_constant *= factor,
        (_, None) => {}
    }
}

/// Largest Poisson's ratio that a field may give.
const POISSON: f64 = 0.49;

/// Where fields of their own bring a parameter past its limit it stops there: Poisson's ratio at +-0.49,
/// a residual strength at the peak strength (a softening soil does not harden).
fn limit(material: &mut case::Material) -> u64 {
    let mut limited = 0;
    let mut stop = |value: &mut f64, low: f64, high: f64| {
        if *value < low || *value > high {
            *value = value.clamp(low, high);
            limited += 1;
        }
    };
    match material {
        case::Material::Elastic { elastic } => stop(&mut elastic.poisson_ratio, -POISSON, POISSON),
        case::Material::VonMises { elastic, strength } => {
            stop(&mut elastic.poisson_ratio, -POISSON, POISSON);
            if strength.softening_modulus < 0.0 {
                stop(&mut strength.residual_cohesion, 0.0, strength.cohesion);
            }
        }
    }
    limited
}

/// What the record tells of a field.
#[derive(Clone, Debug, Serialize)]
pub struct FieldNote {
    pub name: String,
    pub material: String,
    pub parameters: Vec<Parameter>,
    pub realisation: u64,
    /// What generates it, and why; `None` where nothing varies.
    pub generator: Option<String>,
    /// Exact errors of the generator against the covariance asked for.
    pub accuracy: Option<Accuracy>,
    pub counts: Counts,
    /// Of the factors on the mean, over the cells of this realisation.
    pub mean_factor: f64,
    pub sd_factor: f64,
}

/// Notes on the fields of a realisation.
pub fn notes(case: &Case, fields: &Fields, drawn: &[Drawn]) -> Vec<FieldNote> {
    let each = case.field.iter().zip(fields.models()).zip(drawn);
    each.map(|(((name, field), model), drawn)| {
        let summary = Summary::of(&drawn.factors);
        FieldNote {
            name: name.clone(),
            material: field.material.clone(),
            parameters: field.parameters.clone(),
            realisation: case.ensemble.realisation,
            generator: model.generator.as_ref().map(|g| g.choice().to_owned()),
            accuracy: model.generator.as_ref().map(|g| *g.accuracy()),
            counts: drawn.counts,
            mean_factor: summary.map_or(f64::NAN, |s| s.mean),
            sd_factor: summary.map_or(f64::NAN, |s| s.sd),
        }
    })
    .collect()
}
