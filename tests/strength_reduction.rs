//! The search for the factor of safety, on a slope in coarse cells.

use rmpm::{
    case::{self, Case},
    run::Limits,
    scene,
    study::strength_reduction::{NoFactor, find},
};

/// The slope of the paper without softening, on a base that holds it, in cells of 1 m.
fn slope(keys: &[&str]) -> Case {
    let all = [
        "grid.cell=1",
        "boundary.base.kind=fixed",
        "material.clay.softening_modulus=0",
        "material.clay.residual_cohesion=20",
        "implicit.time_step=0.25",
        "strength_reduction={low=0.5, high=2.5, tolerance=0.05}",
    ];
    let keys: Vec<String> = all.iter().chain(keys).map(|k| (*k).to_owned()).collect();
    let text = case::template("rfem").expect("a template");
    case::read("rfem", text, &keys).unwrap_or_else(|e| panic!("{e}")).0
}

fn factor(keys: &[&str]) -> f64 {
    find(&slope(keys), 1 << 30, Limits::NONE, |_| {}).unwrap_or_else(|e| panic!("{e:?}")).factor_of_safety
}

/// Both ways to tell failure bracket one limit: they part by at most the bracket. Twice the strength is twice the
/// factor, since nothing else in small strain has a strength: within half of both brackets.
#[test]
fn equilibrium_and_motion_tell_the_same_factor() {
    let (motion, equilibrium) = (factor(&[]), factor(&["implicit.regime=quasi_static"]));
    assert!((motion - equilibrium).abs() <= 0.1, "{motion} {equilibrium}");
    let twice = [
        "implicit.regime=quasi_static",
        "material.clay.cohesion=40",
        "material.clay.residual_cohesion=40",
        "strength_reduction.high=5",
    ];
    let twice = factor(&twice);
    assert!((twice - 2.0 * equilibrium).abs() <= 0.075, "{twice} {equilibrium}");
}

#[test]
fn a_bracket_without_the_factor_is_refused_with_its_key() {
    for (set, key) in
        [("{low=0.1, high=0.2}", "`strength_reduction.high`"), ("{low=5, high=6}", "`strength_reduction.low`")]
    {
        let case = slope(&["implicit.regime=quasi_static", &format!("strength_reduction={set}")]);
        match find(&case, 1 << 30, Limits::NONE, |_| {}) {
            Err(NoFactor::Input(text)) => assert!(text.contains(key), "{text}"),
            other => panic!("{other:?}"),
        }
    }
    let explicit = slope(&["solver.kinematics=hencky", "solver.locking=none", "solver.scheme=explicit"]);
    assert!(matches!(find(&explicit, 1 << 30, Limits::NONE, |_| {}), Err(NoFactor::Input(_))));
}

/// Strengths that vary from point to point are divided alike.
#[test]
fn a_varying_strength_is_divided_too() {
    let case = slope(&["jitter.strength=0.2"]);
    let strengths = |factor: f64| {
        scene::build_reduced(&case, 1 << 30, &rmpm::scene::Fields::default(), factor)
            .expect("a scene")
            .simulation
            .snapshot()
            .peak_strength
    };
    let (whole, reduced) = (strengths(1.0), strengths(1.6));
    assert!(whole.iter().any(|c| *c != whole[0]));
    assert!(whole.iter().zip(&reduced).all(|(w, r)| w / 1.6 == *r));
}
