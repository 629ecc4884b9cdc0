//! `rmpm multilevel` from outside: its files, the same figures at any number of threads, what is refused.

use std::{
    fs,
    path::{Path, PathBuf},
};

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

const CASE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/random-slope.toml");

/// The paper's slope with a weaker clay that slides, up to 7 s, in cells of 2 and 1 m: some tens of milliseconds a run.
const SET: [&str; 6] = [
    "field.strength.cell=1",
    "field.strength.correlation_error=1",
    "field.strength.variance_error=1",
    "material.clay.cohesion=16",
    "end.time=7",
    "output.history=0.1",
];

fn command(out: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rmpm"));
    command.args(["multilevel", CASE, "--levels", "2,1", "--pilot", "8,5", "--json", "--out"]).arg(out);
    command.args(SET.iter().flat_map(|key| ["--set", key]));
    command.args(more);
    command
}

fn out() -> (TempDir, PathBuf) {
    let root = tempfile::tempdir().expect("a folder");
    let path = root.path().join("out");
    (root, path)
}

/// `levels.csv` without its last column, the CPU time.
fn rows(out: &Path) -> Vec<String> {
    let text = fs::read_to_string(out.join("levels.csv")).expect("levels.csv");
    text.lines().map(|line| line.rsplit_once(',').expect("columns").0.to_owned()).collect()
}

fn study(out: &Path, more: &[&str]) -> Value {
    let done = command(out, more).assert().code(0);
    serde_json::from_slice(&done.get_output().stdout).expect("JSON")
}

#[test]
fn the_same_figures_at_any_number_of_threads() {
    let ((_a, one), (_b, three)) = (out(), out());
    let (first, second) = (study(&one, &["-j", "1"]), study(&three, &["-j", "3"]));
    assert_eq!(rows(&one), rows(&three));
    for pointer in
        ["/quantities/0/terms", "/quantities/0/mean_se", "/beyond", "/pilot/realisations", "/split/offers/1/bias"]
    {
        let (a, b) = (first.pointer(pointer), second.pointer(pointer));
        assert!(a.is_some() && a == b, "{pointer}: {a:?} {b:?}");
    }
    // 8 runs of level 0, 5 pairs, and each with 9 points and with twice the step
    assert_eq!(rows(&one).len(), 1 + 8 * 3 + 5 * 4);
    let main = &first["quantities"][0];
    assert_eq!(main["name"], "sliding_distance_m");
    let mean = |term: usize| main["terms"][term]["mean"].as_f64().expect("a mean");
    assert!((main["mean"].as_f64().expect("a mean") - mean(0) - mean(1)).abs() < 1e-12);
    // the bias of the coarse level is the difference to the fine one, with the other sign
    assert_eq!(first["split"]["offers"][0]["bias"].as_f64(), Some(-mean(1)));
    for name in ["multilevel.json", "multilevel.png", "beyond.png"] {
        assert!(fs::metadata(one.join(name)).is_ok_and(|m| m.len() > 1000), "{name}");
    }
}

#[test]
fn a_budget_adds_realisations_of_the_same_rows() {
    let ((_a, start), (_b, more)) = (out(), out());
    let only = ["--cells-only", "--error", "0.8"];
    let first = study(&start, &only);
    let second = study(&more, &[&only[..], &["--budget", "1e9"]].concat());
    let wanted: Vec<u64> = serde_json::from_value(second["pilot"]["realisations"].clone()).expect("counts");
    assert_eq!(first["pilot"]["realisations"], second["pilot"]["realisations"]);
    let had = [8, 5];
    for (term, (wanted, had)) in wanted.iter().zip(had).enumerate() {
        assert_eq!(second["quantities"][0]["terms"][term]["n"], (*wanted).max(had), "term {term}");
    }
    assert!(wanted.iter().zip(had).any(|(w, h)| *w > h), "{wanted:?}");
    let longer = rows(&more);
    assert!(rows(&start).iter().all(|row| longer.contains(row)));
}

#[test]
fn what_cannot_be_done_is_said_before_anything_runs() {
    for (more, said) in [
        (&["--set", "field.strength.variation=0"][..], "nothing in this case is random"),
        (&["--levels", "1,2"], "the coarsest first"),
        (&["--at-level", "0:seed=3"], "must not change from level to level"),
        (&["--at-level", "7:seed=3"], "levels go from 0 to 1"),
        (&["--quantity", "beauty"], "`beauty`"),
    ] {
        let (_root, out) = out();
        let done = command(&out, more).assert().code(2);
        let text = String::from_utf8_lossy(&done.get_output().stderr).into_owned();
        assert!(text.contains(said), "{text}");
    }
}
