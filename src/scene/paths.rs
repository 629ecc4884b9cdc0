//! The cheaper paths that a scene takes by itself, and what keeps it from the others.

use super::effects::sides;
use crate::case::{self, Case, Kinematics, Regime, Scheme, StrengthMeasure};

/// One sentence for each choice that the scene has made about how it is computed.
pub fn paths(case: &Case) -> Vec<String> {
    let mut out = Vec::new();
    match case.solver.scheme {
        Scheme::Explicit => out.push("no system of equations: steps are bound by the fastest wave".to_owned()),
        Scheme::Implicit => {
            out.extend(inertia(case.implicit.regime));
            out.push(equations(case));
            if case.solver.kinematics == Kinematics::Small {
                out.push("stencils and structure of the equations are made once: in small strain nothing moves among the nodes".into());
            }
        }
    }
    out.extend(smooth_sides(case));
    out
}

fn inertia(regime: Regime) -> Option<String> {
    match regime {
        Regime::QuasiStatic => {
            Some("no mass and no velocity in the equations: implicit.regime = \"quasi_static\"".into())
        }
        Regime::Auto { .. } => Some(
            "no mass and no velocity in the equations until the body loses its stability: implicit.regime = \"auto\""
                .into(),
        ),
        Regime::Newmark | Regime::Hht { .. } | Regime::BackwardEuler => None,
    }
}

/// Cholesky where all is symmetric; else what it is that calls for LU.
fn equations(case: &Case) -> String {
    let rubs = sides(case).filter_map(|(side, kind)| match kind {
        case::Side::Friction { coefficient, .. } if coefficient > 0.0 => {
            Some(format!("a node slides on boundary.{}", side.name()))
        }
        _ => None,
    });
    let finite = case.solver.kinematics != Kinematics::Small;
    let yields = case.material.iter().filter_map(|(name, material)| match material {
        case::Material::VonMises { strength, .. } if finite && strength.strength_measure == StrengthMeasure::Cauchy => {
            Some(format!("material.{name} yields, as strength_measure = \"cauchy\""))
        }
        _ => None,
    });
    let why: Vec<String> = rubs.chain(yields).collect();
    match why.is_empty() {
        true => "symmetric equations, L L^T: nothing slides, and no tangent is unsymmetric".into(),
        false => format!("L L^T while the equations are symmetric, L U while {}", why.join(" or while ")),
    }
}

/// Smooth sides that cannot open are rollers, without the bookkeeping of a contact.
fn smooth_sides(case: &Case) -> impl Iterator<Item = String> {
    let b = &case.boundary;
    let typed = [("left", b.left), ("right", b.right), ("base", b.base), ("top", b.top)];
    typed.into_iter().filter_map(|(name, side)| match side {
        case::Side::Friction { coefficient: 0.0, separation: false } => {
            Some(format!("boundary.{name} is smooth and cannot open: a roller"))
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(keys: &[&str]) -> String {
        let text = case::template("slope").expect("a template");
        let keys: Vec<String> = keys.iter().map(|k| (*k).to_owned()).collect();
        paths(&case::read("slope", text, &keys).unwrap_or_else(|e| panic!("{e}")).0).join("\n")
    }

    #[test]
    fn what_is_unsymmetric_is_named() {
        let implicit = "solver.scheme=implicit";
        let both = of(&[implicit]);
        assert!(both.contains("slides on boundary.base or while material.clay yields"), "{both}");
        let kirchhoff = "material.clay.strength_measure=kirchhoff";
        let smooth = of(&[implicit, kirchhoff, "boundary.base=roller"]);
        assert!(smooth.contains("symmetric equations, L L^T"), "{smooth}");
        assert!(of(&["boundary.base={kind=\"friction\",coefficient=0.0,separation=false}"]).contains("a roller"));
    }

    #[test]
    fn inertia_is_left_out_where_it_may_be() {
        let regime = |r: &str| of(&["solver.scheme=implicit", &format!("implicit.regime={r}")]);
        assert!(regime("quasi_static").contains("no mass") && regime("auto").contains("until the body loses"));
        assert!(!regime("newmark").contains("no mass"));
    }
}
