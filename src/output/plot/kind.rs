//! The fields that a picture can show.

use super::colour::{ColourMap, PALETTE, Rgb, STAGES};
use super::ticks::nice_step;
use crate::snapshot::Snapshot;

/// What the points are coloured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FieldKind {
    /// Accumulated plastic shear strain invariant.
    #[default]
    PlasticStrain,
    /// Current cohesion (kPa).
    Strength,
    /// Peak cohesion (kPa).
    PeakStrength,
    /// Stage of the law, four classes.
    Stage,
    /// Length of the displacement (m).
    Displacement,
    /// Length of the velocity (m/s).
    Velocity,
    /// Horizontal Cauchy stress (kPa, tension positive).
    SigmaXx,
    /// Vertical Cauchy stress (kPa, tension positive).
    SigmaYy,
    /// Mean Cauchy stress (kPa, tension positive).
    MeanStress,
    /// Index of the material, classes.
    Material,
}

impl FieldKind {
    /// All fields, in the order in which they are listed to a user.
    pub const ALL: [FieldKind; 10] = [
        FieldKind::PlasticStrain,
        FieldKind::Strength,
        FieldKind::PeakStrength,
        FieldKind::Stage,
        FieldKind::Displacement,
        FieldKind::Velocity,
        FieldKind::SigmaXx,
        FieldKind::SigmaYy,
        FieldKind::MeanStress,
        FieldKind::Material,
    ];

    /// Name on the command line and in file names.
    pub fn name(self) -> &'static str {
        match self {
            FieldKind::PlasticStrain => "plastic_strain",
            FieldKind::Strength => "strength",
            FieldKind::PeakStrength => "peak_strength",
            FieldKind::Stage => "stage",
            FieldKind::Displacement => "displacement",
            FieldKind::Velocity => "velocity",
            FieldKind::SigmaXx => "sigma_xx",
            FieldKind::SigmaYy => "sigma_yy",
            FieldKind::MeanStress => "mean_stress",
            FieldKind::Material => "material",
        }
    }

    /// The field of a name; `plastic-strain` and `Plastic_Strain` are `plastic_strain`.
    pub fn parse(name: &str) -> Option<FieldKind> {
        let name = name.trim().to_ascii_lowercase().replace('-', "_");
        FieldKind::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Names of all fields.
    pub fn names() -> impl Iterator<Item = &'static str> {
        FieldKind::ALL.into_iter().map(FieldKind::name)
    }

    /// What stands at the colour bar, with the unit.
    pub fn title(self) -> &'static str {
        match self {
            FieldKind::PlasticStrain => "plastic shear strain invariant (-)",
            FieldKind::Strength => "cohesion c (kPa)",
            FieldKind::PeakStrength => "peak cohesion c₀ (kPa)",
            FieldKind::Stage => "stage of the law",
            FieldKind::Displacement => "displacement (m)",
            FieldKind::Velocity => "velocity (m/s)",
            FieldKind::SigmaXx => "horizontal stress σxx (kPa, tension positive)",
            FieldKind::SigmaYy => "vertical stress σyy (kPa, tension positive)",
            FieldKind::MeanStress => "mean stress p (kPa, tension positive)",
            FieldKind::Material => "material",
        }
    }

    /// Weak is blue and strong is red for strengths; one growing lightness for all else.
    pub fn map(self) -> ColourMap {
        match self {
            FieldKind::Strength | FieldKind::PeakStrength => ColourMap::Diverging,
            _ => ColourMap::Sequential,
        }
    }

    /// Whether the field has classes instead of a scale.
    pub fn has_classes(self) -> bool {
        matches!(self, FieldKind::Stage | FieldKind::Material)
    }

    /// Value at point `i`; the number of the class for a field of classes. NaN where there is none.
    pub fn value(self, s: &Snapshot, i: usize) -> f64 {
        let real = |v: &[f64]| v.get(i).copied();
        let length = |v: [f64; 2]| v[0].hypot(v[1]);
        let value = match self {
            FieldKind::PlasticStrain => real(&s.plastic_strain),
            FieldKind::Strength => real(&s.strength),
            FieldKind::PeakStrength => real(&s.peak_strength),
            FieldKind::Stage => s.stage.get(i).map(|x| f64::from(*x as u8)),
            FieldKind::Displacement => (i < s.reference.len()).then(|| length(s.displacement(i))),
            FieldKind::Velocity => s.velocity.get(i).map(|v| length(*v)),
            FieldKind::SigmaXx => s.stress.get(i).map(|t| t.xx),
            FieldKind::SigmaYy => s.stress.get(i).map(|t| t.yy),
            FieldKind::MeanStress => s.stress.get(i).map(|t| (t.xx + t.yy + t.zz) / 3.0),
            FieldKind::Material => s.material.get(i).map(|m| f64::from(*m)),
        };
        value.unwrap_or(f64::NAN)
    }

    /// Colour of a class.
    pub fn class_colour(self, class: usize) -> Rgb {
        match self {
            FieldKind::Stage => STAGES[class % STAGES.len()],
            _ => PALETTE[class % PALETTE.len()],
        }
    }

    /// Name of a class in the legend.
    pub fn class_name(self, class: usize) -> String {
        match (self, class) {
            (FieldKind::Stage, 0) => "elastic".into(),
            (FieldKind::Stage, 1) => "elastic unloading".into(),
            (FieldKind::Stage, 2) => "softening".into(),
            (FieldKind::Stage, 3) => "residual".into(),
            _ => format!("material {class}"),
        }
    }

    /// A scale for these values: from 0 where the field cannot be negative, and without the
    /// outermost 2 % (plastic strain) or 0.5 %, which the colour bar then marks with arrows.
    pub fn automatic_range(self, snapshots: &[&Snapshot]) -> (f64, f64) {
        let values = self.sorted_sample(snapshots);
        let tail = if self == FieldKind::PlasticStrain { 0.02 } else { 0.005 };
        let quantile = |q: f64| values.get((q * values.len().saturating_sub(1) as f64).round() as usize).copied();
        let (Some(lo), Some(hi)) = (quantile(tail), quantile(1.0 - tail)) else {
            return (0.0, 1.0);
        };
        let never_negative = matches!(self, FieldKind::PlasticStrain | FieldKind::Displacement | FieldKind::Velocity);
        let lo = if never_negative { 0.0 } else { lo };
        if never_negative && hi <= 0.0 {
            return (0.0, 1.0);
        }
        round_outwards(lo, hi)
    }

    /// At most about 200 000 of the finite values, in order.
    fn sorted_sample(self, snapshots: &[&Snapshot]) -> Vec<f64> {
        let total: usize = snapshots.iter().map(|s| s.len()).sum();
        let stride = total / 200_000 + 1;
        let mut values: Vec<f64> = snapshots
            .iter()
            .flat_map(|s| (0..s.len()).step_by(stride).map(|i| self.value(s, i)))
            .filter(|v| v.is_finite())
            .collect();
        values.sort_unstable_by(f64::total_cmp);
        values
    }
}

/// The interval widened to round numbers.
pub(super) fn round_outwards(lo: f64, hi: f64) -> (f64, f64) {
    let span = hi - lo;
    if !(span.is_finite() && span > 1e-6 * lo.abs().max(hi.abs())) {
        return (lo, hi);
    }
    let step = nice_step(span, 10);
    let (down, up) = ((lo / step + 1e-6).floor() * step, (hi / step - 1e-6).ceil() * step);
    if down.is_finite() && up.is_finite() { (down, up) } else { (lo, hi) }
}
