//! Random fields in a scene: where their values go, and that they do not depend on what they should not.

use rmpm::{
    case::{self, Case},
    scene::{self, Scene},
};

fn read(overrides: &[&str]) -> Case {
    let text = include_str!("../cases/random-slope.toml");
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    case::read("random-slope", text, &overrides).unwrap_or_else(|e| panic!("{}", e.render(false))).0
}

fn scene(overrides: &[&str]) -> Scene {
    scene::build(&read(overrides), 1 << 30).unwrap_or_else(|e| panic!("{e}"))
}

/// Peak strength at the start by place (m).
fn strengths(overrides: &[&str]) -> Vec<([f64; 2], f64)> {
    let s = scene(overrides).simulation.snapshot();
    s.reference.iter().copied().zip(s.peak_strength.iter().copied()).collect()
}

fn mean_and_sd(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    (mean, (values.map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt())
}

#[test]
fn a_finer_grid_keeps_the_realisation() {
    let (coarse, fine) = (strengths(&[]), strengths(&["grid.cell=0.125"]));
    assert!(fine.len() > 3 * coarse.len());
    // both sets of points lie in cells of 0.25 m of the same field
    let cell = |x: [f64; 2]| [(x[0] / 0.25).floor() as i64, (x[1] / 0.25).floor() as i64];
    let known: std::collections::BTreeMap<[i64; 2], f64> = coarse.iter().map(|(x, c)| (cell(*x), *c)).collect();
    let shared: Vec<_> = fine.iter().filter_map(|(x, c)| Some((known.get(&cell(*x))?, c))).collect();
    assert!(shared.len() > 25_000);
    assert!(shared.iter().all(|(a, b)| a == b));
}

#[test]
fn rmpm_and_rfem_have_the_same_strengths() {
    let rfem = ["solver.scheme=implicit", "solver.kinematics=small", "solver.locking=b_bar"];
    assert_eq!(strengths(&[]), strengths(&rfem));
    assert_ne!(strengths(&[]), strengths(&["ensemble.realisation=1"]));
}

#[test]
fn opposite_realisations_have_opposite_strengths() {
    let of = |k: u32| {
        let key = format!("ensemble.realisation={k}");
        strengths(&["ensemble.antithetic=true", "field.strength.variation=0.1", &key])
    };
    let pair = of(6).into_iter().zip(of(7));
    assert!(pair.map(|(a, b)| a.1 + b.1 - 40.0).all(|sum| sum.abs() < 1e-12));
    assert_ne!(of(6), of(8));
}

/// Over many realisations the strength has the mean and the sd asked for; the latter less what the average over
/// a cell takes: the exact variance of a cell, from the table of the generator.
#[test]
fn strengths_have_the_moments_asked_for() {
    let case = read(&["field.strength.theta_h=1"]);
    let fields = scene::Fields::of(&case).expect("a generator");
    let n = 200;
    let draws: Vec<f64> = (0..n)
        .flat_map(|k| {
            let mut case = case.clone();
            case.ensemble.realisation = k;
            fields.draw(&case).expect("a draw").remove(0).factors
        })
        .collect();
    let (mean, sd) = mean_and_sd(draws.iter().copied());
    // a field of 25 x 5 m with theta = 1 m holds some 100 independent stretches; four standard errors
    assert!((mean - 1.0).abs() < 4.0 * 0.25 / 20_000f64.sqrt(), "{mean}");
    let generator = fields.models()[0].generator.as_ref().expect("it varies");
    let variance = generator.covariances(0).expect("a cell")[0];
    assert!((sd / (0.25 * variance.sqrt()) - 1.0).abs() < 4.0 / (2.0 * 20_000f64).sqrt(), "{sd} {variance}");
}

#[test]
fn the_mean_grows_with_depth() {
    let steady = ["field.strength.variation=0", "field.strength.depth_gradient=0.1"];
    for (x, c) in strengths(&steady) {
        assert!((c - 20.0 * (1.0 + 0.1 * (5.0 - x[1]))).abs() < 1e-12, "{x:?} {c}");
    }
}

#[test]
fn a_field_of_unit_weight_changes_the_mass_and_one_of_stiffness_the_step() {
    let one = |parameter: &str| {
        let key = format!("field.strength.parameters=[\"{parameter}\"]");
        let mut scene = scene(&[&key, "field.strength.theta_h=1"]);
        (scene.simulation.initial_mass, scene.simulation.stable_dt().expect("a step"))
    };
    let (even, heavy, stiff) = (one("cohesion"), one("unit_weight"), one("young_modulus"));
    let share = heavy.0 / even.0 - 1.0;
    assert!(share.abs() > 1e-6 && share.abs() < 0.1, "{share}");
    // the stiffest point decides
    assert!(stiff.1 < 0.9 * even.1, "{} {}", stiff.1, even.1);
}

#[test]
fn independent_fields_keep_the_residual_below_the_peak_and_say_how_often() {
    let text = include_str!("../cases/random-slope.toml").replace(
        "[ensemble]",
        "[field.residual]\nmaterial = \"clay\"\nparameters = [\"residual_cohesion\"]\nvariation = 1.0\ntheta_h = 1.0\ntheta_v = 1.0\n\n[ensemble]",
    );
    let keys = [
        "field.strength.parameters=[\"cohesion\"]",
        "field.strength.variation=0.9",
        "material.clay.residual_cohesion=19",
    ];
    let keys: Vec<String> = keys.iter().map(|k| (*k).to_owned()).collect();
    let (case, _) = case::read("two fields", &text, &keys).unwrap_or_else(|e| panic!("{}", e.render(false)));
    let scene = scene::build(&case, 1 << 30).expect("a scene");
    let said = scene.warnings.iter().find(|w| w.code == "limited_values").expect("a warning");
    let count: u64 = said.text.split(' ').next().and_then(|n| n.parse().ok()).expect("a count");
    // the residual is above the peak in nearly half of the points
    assert!((2000..5000).contains(&count), "{count}");
}

#[test]
fn what_cannot_be_drawn_is_refused_with_its_key() {
    let build = |keys: &[&str]| scene::build(&read(keys), 1 << 30).err().expect("refused");
    let none = build(&["field.strength.low_values=none", "field.strength.variation=1"]);
    assert!(none.key == "field.strength.low_values" && none.message.contains("not positive"), "{none}");
    let never =
        build(&["field.strength.low_values=resample", "field.strength.variation=1", "field.strength.floor=0.5"]);
    assert!(never.message.contains("1000 realisations"), "{never}");
}

#[test]
fn fields_drawn_again_are_told() {
    let keys = ["field.strength.low_values=resample", "field.strength.floor=0.3", "field.strength.theta_h=1"];
    let scene = scene(&keys);
    let again = scene.fields[0].counts.redrawn;
    assert!(again > 0);
    let said = scene.warnings.iter().find(|w| w.code == "redrawn_field").expect("a warning");
    assert!(said.text.contains(&format!("{} times", again + 1)), "{}", said.text);
    let lowest = scene.simulation.snapshot().peak_strength.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(lowest >= 0.3 * 20.0);
}

#[test]
fn floored_values_are_counted() {
    let scene = scene(&["field.strength.variation=1", "field.strength.theta_h=1"]);
    let note = &scene.fields[0];
    // P(1 + Z < 0.05) for a cell of variance 0.76 or so: 0.14 of 2000 cells
    assert!((150..450).contains(&note.counts.floored), "{:?}", note.counts);
    let lowest = scene.simulation.snapshot().peak_strength.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((lowest - 1.0).abs() < 1e-12, "{lowest}");
}
