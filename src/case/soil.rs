//! Types of `[material.NAME]`.

use serde::Serialize;

/// A soil. The tag is the key `law`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "law", rename_all = "snake_case")]
pub enum Material {
    /// Isotropic linear elasticity (Hencky's in finite strain).
    Elastic {
        #[serde(flatten)]
        elastic: Elastic,
    },
    /// Von Mises with linear cohesion softening (eq. 4 of the paper).
    VonMises {
        #[serde(flatten)]
        elastic: Elastic,
        #[serde(flatten)]
        strength: Strength,
    },
}

impl Material {
    /// Weight and stiffness, which every law has.
    pub fn elastic(&self) -> &Elastic {
        match self {
            Material::Elastic { elastic } | Material::VonMises { elastic, .. } => elastic,
        }
    }

    /// Whether the law has a strength.
    pub fn yields(&self) -> bool {
        matches!(self, Material::VonMises { .. })
    }

    /// Whether it softens and nothing gives its shear bands a width but the cells.
    pub fn softens_without_length(&self) -> bool {
        matches!(self, Material::VonMises { strength: s, .. }
            if s.softening_modulus < 0.0 && s.regularisation == Regularisation::None)
    }
}

/// Weight and stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Elastic {
    /// Unit weight (kN/m3). The file may give `density` (t/m3) instead.
    pub unit_weight: f64,
    /// E (kPa).
    pub young_modulus: f64,
    /// nu.
    pub poisson_ratio: f64,
}

/// Strength of a von Mises soil.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Strength {
    /// Peak cohesion c0 (kPa).
    pub cohesion: f64,
    /// Residual cohesion c_r (kPa).
    pub residual_cohesion: f64,
    /// H (kPa), slope of cohesion over plastic strain; negative softens, 0 is perfectly plastic.
    pub softening_modulus: f64,
    /// k in q <= k c. sqrt(3): then c is the plane-strain shear strength.
    pub yield_constant: f64,
    pub strength_measure: StrengthMeasure,
    #[serde(flatten)]
    pub regularisation: Regularisation,
}

/// What gives softening a length. The tag is the key `regularisation`; the default is `none`, as the paper has
/// none.
///
/// `reference_length` (m) is the width of the shear band for which `softening_modulus` was given. It has no
/// default: no width belongs to every soil.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "regularisation", rename_all = "snake_case")]
pub enum Regularisation {
    /// H as it stands: bands are a cell wide and what they dissipate goes with `grid.cell`.
    None,
    /// H is scaled by the width of a band of the grid over `reference_length`.
    FractureEnergy { reference_length: f64 },
    /// The strength follows (1 - m) eps_p + m <eps_p>, with a Gaussian average <.> of length `reference_length` and m =
    /// `nonlocal_weight`; H is scaled so that a band dissipates what one of the reference length does. The default
    /// m = 2 is usual; with m = 1 the localisation of linear softening has no limit (Vermeer & Brinkgreve 1994).
    Nonlocal { reference_length: f64, nonlocal_weight: f64 },
}

/// The stress that the strength is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StrengthMeasure {
    /// q(sigma) <= k c.
    Cauchy,
    /// q(tau) <= k c, with tau = J sigma.
    Kirchhoff,
}
