//! Every validation problem in its short form, and the promises about the table.

use rmpm::study::validate::{Effort, Report, choose, problems, section};

fn report(name: &str) -> Report {
    let problem = choose(&[name.to_owned()]).unwrap_or_else(|e| panic!("{e}"))[0];
    problem.run(Effort::Short).unwrap_or_else(|e| panic!("{e}"))
}

fn holds(name: &str) {
    let report = report(name);
    // in every problem but that of the fields something moves
    assert!(!report.rows.is_empty() && (report.particle_steps > 0 || name == "field"));
    assert!(report.pass(), "{}", section(&report));
}

#[test]
fn field() {
    holds("field");
}

#[test]
fn vibrating_bar() {
    holds("vibrating-bar");
}

#[test]
fn long_run() {
    holds("long-run");
}

#[test]
fn two_discs() {
    holds("two-discs");
}

#[test]
fn incline() {
    holds("incline");
}

#[test]
fn courant() {
    holds("courant");
}

#[test]
fn rigid() {
    holds("rigid");
}

#[test]
fn patch() {
    holds("patch");
}

#[test]
fn in_situ() {
    holds("in-situ");
}

#[test]
fn light_node() {
    holds("light-node");
}

#[test]
fn cut_cell() {
    holds("cut-cell");
}

#[test]
fn newton() {
    holds("newton");
}

#[test]
fn incompressible() {
    holds("incompressible");
}

#[test]
fn cook() {
    holds("cook");
}

#[test]
fn prandtl() {
    holds("prandtl");
}

#[test]
fn undrained_slopes() {
    holds("undrained-slopes");
}

#[test]
fn factor_of_safety() {
    holds("factor-of-safety");
}

#[test]
fn perfect_correlation() {
    holds("perfect-correlation");
}

#[test]
fn column() {
    holds("column");
}

#[test]
fn cantilever() {
    holds("cantilever");
}

#[test]
fn block_collapse() {
    holds("block-collapse");
}

#[test]
fn hard_cases() {
    holds("hard-cases");
}

#[test]
fn shear_layer() {
    holds("shear-layer");
}

#[test]
fn random_scenes() {
    holds("random-scenes");
}

#[test]
fn manufactured() {
    holds("manufactured");
}

#[test]
fn time_order() {
    holds("time-order");
}

#[test]
fn thick_cylinder() {
    holds("thick-cylinder");
}

#[test]
fn column_collapse() {
    holds("column-collapse");
}

#[test]
fn no_problem_is_left_out_here() {
    let tested = include_str!("validation.rs");
    for problem in problems() {
        assert!(tested.contains(&format!("holds(\"{}\")", problem.name())), "{} has no test", problem.name());
    }
}

#[test]
fn each_problem_has_a_folder_of_its_name() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("validation");
    // a folder without a case is a comparison with another program
    let folders =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).filter(|p| p.join("case.toml").exists());
    let mut names: Vec<_> = folders.map(|p| p.file_name().unwrap().to_str().unwrap().to_owned()).collect();
    let mut known: Vec<_> = problems().iter().map(|p| p.name().to_owned()).collect();
    names.sort();
    known.sort();
    assert_eq!(names, known);
}

#[test]
fn a_report_is_the_same_twice_and_serialises() {
    let once = || serde_json::to_string(&report("patch")).unwrap();
    let json = once();
    assert_eq!(json, once());
    assert!(json.contains("\"why_tolerance\"") && json.contains("\"particle_steps\""));
}
