//! What is random in a resolved case: fields over the parameters of materials, and the realisations of
//! them. Units are kN, m, s, t (so kPa and kN/m3).

use serde::Serialize;

use super::Material;

/// The realisations of the random fields.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ensemble {
    /// The realisation that a single run takes, from 0. Default 0.
    pub realisation: u64,
    /// Realisations of an ensemble. Default 100, as in the paper.
    pub realisations: u64,
    /// Whether realisations 2k and 2k + 1 take opposite normals: their errors in what depends
    /// on the fields linearly cancel. Default false: independent realisations, as in the paper.
    pub antithetic: bool,
    /// A rule to stop early. Default none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until: Option<Until>,
}

/// Stop an ensemble when the standard error of a measure is small enough.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Until {
    /// A column of `ensemble.csv`, such as `sliding_distance_m`.
    pub measure: String,
    pub statistic: Statistic,
    /// Largest standard error, in the unit of the measure.
    pub standard_error: f64,
    /// Fewest realisations. Default 30: standard errors of fewer are guesses.
    pub at_least: u64,
}

/// The statistic whose standard error a rule looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    Mean,
    /// Standard deviation.
    Sd,
}

/// A random field of local averages that scales parameters of a material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Field {
    /// Key of the material.
    pub material: String,
    /// The parameters that the field scales, each about its own mean with the same V: they are fully
    /// correlated. Independent parameters are fields of their own.
    pub parameters: Vec<Parameter>,
    /// V, coefficient of variation of the point values; 0 leaves the means.
    pub variation: f64,
    /// Scales of fluctuation (m): theta_h along x ...
    pub theta_h: f64,
    /// ... and theta_v along the vertical.
    pub theta_v: f64,
    pub correlation: CorrelationFamily,
    #[serde(flatten)]
    pub marginal: Marginal,
    /// Growth of the mean with depth below `datum`, as a share of the mean there (1/m): mean x (1 +
    /// depth_gradient x depth), V staying the same. Default 0.
    pub depth_gradient: f64,
    /// y (m) at which the parameters have their means. Default: the top of the material.
    pub datum: f64,
    /// Side of the field's cells (m), over which the field is averaged. Default: a quarter of the smaller
    /// theta, whatever the cells of the grid are, so that a finer grid keeps the realisation.
    pub cell: f64,
    /// How the normals become a field. Default `auto`: the cheapest way that keeps the errors below.
    pub generator: FieldGenerator,
    /// Largest error of a correlation between two cells. Default 0.05.
    pub correlation_error: f64,
    /// Largest relative error of the variance of a cell. Default 0.03.
    pub variance_error: f64,
}

/// A parameter that may be a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Parameter {
    UnitWeight,
    YoungModulus,
    PoissonRatio,
    Cohesion,
    ResidualCohesion,
    SofteningModulus,
    YieldConstant,
}

impl Parameter {
    /// All of them, in the order of the words below.
    pub const ALL: [Parameter; 7] = [
        Parameter::UnitWeight,
        Parameter::YoungModulus,
        Parameter::PoissonRatio,
        Parameter::Cohesion,
        Parameter::ResidualCohesion,
        Parameter::SofteningModulus,
        Parameter::YieldConstant,
    ];

    /// The word of the case file.
    pub fn word(self) -> &'static str {
        match self {
            Parameter::UnitWeight => "unit_weight",
            Parameter::YoungModulus => "young_modulus",
            Parameter::PoissonRatio => "poisson_ratio",
            Parameter::Cohesion => "cohesion",
            Parameter::ResidualCohesion => "residual_cohesion",
            Parameter::SofteningModulus => "softening_modulus",
            Parameter::YieldConstant => "yield_constant",
        }
    }

    /// Its unit; empty for a number.
    pub fn unit(self) -> &'static str {
        match self {
            Parameter::UnitWeight => "kN/m3",
            Parameter::PoissonRatio | Parameter::YieldConstant => "",
            _ => "kPa",
        }
    }

    /// The mean that a material gives it; `None` for a law without it.
    pub fn of(self, material: &Material) -> Option<f64> {
        let (e, s) = match material {
            Material::Elastic { elastic } => (elastic, None),
            Material::VonMises { elastic, strength } => (elastic, Some(strength)),
        };
        match self {
            Parameter::UnitWeight => Some(e.unit_weight),
            Parameter::YoungModulus => Some(e.young_modulus),
            Parameter::PoissonRatio => Some(e.poisson_ratio),
            Parameter::Cohesion => s.map(|s| s.cohesion),
            Parameter::ResidualCohesion => s.map(|s| s.residual_cohesion),
            Parameter::SofteningModulus => s.map(|s| s.softening_modulus),
            Parameter::YieldConstant => s.map(|s| s.yield_constant),
        }
    }
}

/// Family of the correlation function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CorrelationFamily {
    /// exp(-2 sqrt((x/theta_h)^2 + (y/theta_v)^2)).
    Markov,
    /// exp(-2 |x|/theta_h - 2 |y|/theta_v).
    MarkovSeparable,
    /// exp(-pi ((x/theta_h)^2 + (y/theta_v)^2)).
    Gaussian,
    /// 1 - 3/2 s + 1/2 s^3 up to s = 1.
    Spherical,
}

/// Distribution of the values. The tag is the key `distribution`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "distribution", rename_all = "snake_case")]
pub enum Marginal {
    /// mean x (1 + V Z): may come out negative, so that a rule for low values belongs to it.
    Normal {
        #[serde(flatten)]
        low_values: LowValues,
    },
    /// exp of a normal; the averaging acts on the normal.
    Lognormal,
}

/// What becomes of values below a floor, a share of the mean. The tag is the key `low_values`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "low_values", rename_all = "snake_case")]
pub enum LowValues {
    /// They are raised to the floor, and counted.
    Floor { floor: f64 },
    /// The whole field is drawn again until none lies below; the tries are counted.
    Resample { floor: f64 },
    /// They stay as they are; a field with a value that is not positive is refused.
    None,
}

/// How a field is generated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FieldGenerator {
    /// The cheapest that keeps the errors asked for.
    Auto,
    /// Local average subdivision.
    Las,
    /// Cholesky factor of all cells.
    Exact,
    /// Circulant embedding.
    Embedding,
}
