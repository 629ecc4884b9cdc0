//! Laws, their parameters, and the stress at the start.

use crate::{
    block::{Law, PointLaw},
    body::Column,
    case::{self, Case},
    field::stream::{Purpose, Stream},
    kinematics::{Hencky, Rate, Small, StrengthMeasure},
    material::{Columns, Elastic, Elasticity, Material, Strength, VonMises},
    math::{outline::Outline, tensor::Voigt},
};

/// The law of a material with the case's strain measure. A new law is one line here.
pub fn law(material: &case::Material, kinematics: case::Kinematics) -> Box<dyn Law> {
    match material {
        case::Material::Elastic { .. } => with_kinematics(Elastic, StrengthMeasure::Cauchy, kinematics),
        case::Material::VonMises { strength, .. } => {
            with_kinematics(VonMises, measure(strength.strength_measure), kinematics)
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

/// Parameter columns of a material's points; `first` is the identity of the first of them.
pub fn columns(case: &Case, material: &case::Material, first: usize, n: usize) -> Vec<Column> {
    let e = material.elastic();
    let elasticity = Elasticity::from_young(e.young_modulus, e.poisson_ratio);
    match material {
        case::Material::Elastic { .. } => uniform(&elasticity),
        case::Material::VonMises { strength: s, .. } => {
            let mut columns = uniform(&Strength {
                elasticity,
                cohesion: s.cohesion,
                residual_cohesion: s.residual_cohesion,
                softening_modulus: s.softening_modulus,
                yield_constant: s.yield_constant,
            });
            if case.jitter.strength > 0.0 {
                let factors = jitter(case, first, n);
                columns[2] = Column::Varying(factors.iter().map(|f| f * s.cohesion).collect());
                columns[3] = Column::Varying(factors.iter().map(|f| f * s.residual_cohesion).collect());
            }
            columns
        }
    }
}

fn uniform<P: Columns>(params: &P) -> Vec<Column> {
    let mut columns = vec![Column::Uniform(0.0); P::NAMES.len()];
    params.write(|k, v| columns[k] = Column::Uniform(v));
    columns
}

/// Factors 1 + jitter U(-1, 1) on the strength of the points `first` to `first + n`.
fn jitter(case: &Case, first: usize, n: usize) -> Vec<f64> {
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
