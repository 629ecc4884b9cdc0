//! Laws, their parameters, and the stress at the start.

use super::{SceneError, softening};
use crate::{
    block::{Law, PointLaw},
    body::Column,
    case::{self, Case},
    field::stream::{Purpose, Stream},
    kinematics::{Hencky, Rate, Small, StrengthMeasure},
    material::{Columns, Elastic, Elasticity, Material, NonlocalVonMises, Strength, VonMises},
    math::{outline::Outline, tensor::Voigt},
};

/// The law of a material with the case's strain measure. A new law is one line here.
pub fn law(material: &case::Material, kinematics: case::Kinematics) -> Box<dyn Law> {
    match material {
        case::Material::Elastic { .. } => with_kinematics(Elastic, StrengthMeasure::Cauchy, kinematics),
        case::Material::VonMises { strength, .. } => {
            let measure = measure(strength.strength_measure);
            match strength.regularisation {
                case::Regularisation::Nonlocal { .. } => with_kinematics(NonlocalVonMises, measure, kinematics),
                _ => with_kinematics(VonMises, measure, kinematics),
            }
        }
    }
}

/// Elasticity in place of any law, over the same columns.
pub fn elastic_stand_in(kinematics: case::Kinematics) -> Box<dyn Law> {
    with_kinematics(Elastic, StrengthMeasure::Cauchy, kinematics)
}

fn with_kinematics<M: Material>(m: M, measure: StrengthMeasure, kinematics: case::Kinematics) -> Box<dyn Law> {
    match kinematics {
        case::Kinematics::Hencky => Box::new(PointLaw::<M, Hencky>::new(m, measure)),
        case::Kinematics::Rate => Box::new(PointLaw::<M, Rate>::new(m, measure)),
        case::Kinematics::Small => Box::new(PointLaw::<M, Small>::new(m, measure)),
    }
}

fn measure(m: case::StrengthMeasure) -> StrengthMeasure {
    match m {
        case::StrengthMeasure::Cauchy => StrengthMeasure::Cauchy,
        case::StrengthMeasure::Kirchhoff => StrengthMeasure::Kirchhoff,
    }
}

/// Parameter columns of points whose materials are given, one a point. `first` is the identity of the first.
///
/// # Errors
/// A point whose strength would drop faster than its stress.
pub fn columns(case: &Case, points: &[case::Material], first: usize) -> Result<Vec<Column>, SceneError> {
    match points.first() {
        None => Ok(Vec::new()),
        Some(case::Material::Elastic { .. }) => Ok(gather(points.iter().map(|m| elasticity(m.elastic())))),
        Some(case::Material::VonMises { strength: of_first, .. }) => {
            // no field scales a length, so that all points share the factor
            let slope = softening::factor(case, of_first);
            let factors = jitter(case, first, points.len());
            let points = points.iter().zip(factors);
            let params: Result<Vec<_>, _> = points.filter_map(|(m, f)| strength(case, m, f, slope)).collect();
            Ok(gather(params?.into_iter()))
        }
    }
}

fn elasticity(e: &case::Elastic) -> Elasticity {
    Elasticity::from_young(e.young_modulus, e.poisson_ratio)
}

/// Strength of a point, `factor` times that of its material and with `slope` times its softening.
fn strength(case: &Case, material: &case::Material, factor: f64, slope: f64) -> Option<Result<Strength, SceneError>> {
    let case::Material::VonMises { elastic, strength: s } = material else { return None };
    let params = Strength {
        elasticity: elasticity(elastic),
        cohesion: factor * s.cohesion,
        residual_cohesion: factor * s.residual_cohesion,
        softening_modulus: slope * s.softening_modulus,
        yield_constant: s.yield_constant,
    };
    Some(softening::check(case, s, &params).map(|()| params))
}

/// One column a parameter; uniform where all points have the same value.
fn gather<P: Columns>(params: impl Iterator<Item = P>) -> Vec<Column> {
    let mut columns = vec![Vec::new(); P::NAMES.len()];
    params.for_each(|p| p.write(|k, v| columns[k].push(v)));
    columns.into_iter().map(column).collect()
}

fn column(values: Vec<f64>) -> Column {
    match values.first() {
        Some(&first) if values.iter().any(|v| *v != first) => Column::Varying(values),
        first => Column::Uniform(first.copied().unwrap_or(0.0)),
    }
}

/// Divides cohesion and residual cohesion by `factor`, whatever they vary with; 1 leaves the bits as they are.
pub fn reduce(material: &case::Material, columns: &mut [Column], factor: f64) {
    let case::Material::VonMises { .. } = material else { return };
    for (column, name) in columns.iter_mut().zip(Strength::NAMES) {
        match (*name, column) {
            ("cohesion" | "residual_cohesion", Column::Uniform(c)) => *c /= factor,
            ("cohesion" | "residual_cohesion", Column::Varying(c)) => c.iter_mut().for_each(|c| *c /= factor),
            _ => {}
        }
    }
}

/// Factors 1 + jitter U(-1, 1) on the strength of the points `first` to `first + n`.
fn jitter(case: &Case, first: usize, n: usize) -> Vec<f64> {
    if case.jitter.strength == 0.0 {
        return vec![1.0; n];
    }
    let mut stream = Stream::new(case.seed, case.jitter.realisation, Purpose::Jitter);
    let factors = std::iter::repeat_with(|| 1.0 + case.jitter.strength * stream.symmetric());
    factors.skip(first).take(n).collect()
}

/// Cauchy stress (kPa) at a point before the first step.
pub fn initial_stress(case: &Case, outlines: &[Outline], x: [f64; 2]) -> Voigt {
    match case.initial_stress {
        case::InitialStress::None => Voigt::default(),
        case::InitialStress::Given { xx, yy, zz, xy } => Voigt::new(xx, yy, zz, xy),
        case::InitialStress::K0 { k0 } => {
            let weight = |(region, outline): (&case::Region, &Outline)| {
                case.material[&region.material].elastic().unit_weight * outline.height_above(x)
            };
            let vertical: f64 = -case.region.iter().zip(outlines).map(weight).sum::<f64>();
            Voigt::new(k0 * vertical, vertical, k0 * vertical, 0.0)
        }
    }
}
