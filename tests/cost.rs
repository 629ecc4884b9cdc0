//! `rmpm cost` from outside, on a bar of few cells.

use std::{fs, path::Path};

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

const BAR: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/vibrating-bar.toml");

/// Both schemes on two meshes of the bar, an eighth of a period long.
fn cost(out: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rmpm"));
    command.args(["cost", BAR, "--levels", "2", "--set", "end.time=1.25", "--vary", "solver.shape=linear"]);
    command.args(["--set", "probe.end.exact=1.1253953951963826e-4", "--quiet", "--out"]).arg(out).args(more);
    command
}

fn study(out: &Path, more: &[&str]) -> Value {
    let done = cost(out, more).arg("--json").assert().success();
    serde_json::from_slice(&done.get_output().stdout).expect("JSON and nothing else")
}

/// Without what the clock says.
fn timeless(mut study: Value) -> Value {
    for key in ["answers", "remarks"] {
        study[key] = Value::Null;
    }
    for row in study["rows"].as_array_mut().expect("rows") {
        for key in ["cpu_s", "repeats", "on_front"] {
            row[key] = Value::Null;
        }
    }
    study
}

#[test]
fn all_but_the_times_is_the_same_at_any_number_of_threads() {
    let folder = TempDir::new().expect("a folder");
    let one = study(&folder.path().join("one"), &["--jobs", "1"]);
    let two = study(&folder.path().join("two"), &["--jobs", "2"]);
    let rows = one["rows"].as_array().expect("rows");
    // two meshes x (2 Courant numbers, 3 time steps)
    assert_eq!(rows.len(), 2 * (2 + 3));
    assert!(rows.iter().all(|r| r["fault"].is_null() && r["cpu_s"].as_f64().is_some_and(|s| s >= 0.0)));
    assert_eq!(one["reference"]["basis"], "exact");
    assert_eq!(timeless(one), timeless(two));
}

/// u = (v / omega) sin(omega t) has order 2 in h and dt; the finest of both schemes have (k h)^2 = 6e-3 at most.
#[test]
fn the_finest_bars_are_right_and_the_files_are_there() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("bar");
    let done = cost(&out, &[]).assert().success();
    let text = String::from_utf8_lossy(&done.get_output().stdout).into_owned();
    assert!(text.contains("for 1 % in end: ") && text.contains("errors against"), "{text}");
    let read = |name: &str| fs::read_to_string(out.join(name)).expect("a file");
    assert_eq!(read("cost.csv").lines().count(), 1 + 10);
    assert!(fs::metadata(out.join("cost.png")).is_ok_and(|m| m.len() > 10_000));
    let study: Value = serde_json::from_str(&read("cost.json")).expect("JSON");
    let least = |scheme: &str| {
        let rows = study["rows"].as_array().expect("rows").iter().filter(|r| r["scheme"] == scheme);
        rows.filter_map(|r| r["error"].as_f64()).fold(f64::INFINITY, f64::min)
    };
    assert!(least("explicit") < 6e-3 && least("implicit") < 6e-3, "{text}");
}

#[test]
fn a_budget_of_nothing_skips_what_is_dear_and_says_so() {
    let folder = TempDir::new().expect("a folder");
    let done = cost(&folder.path().join("none"), &["--budget", "1e-9"]).assert().code(1);
    let text = String::from_utf8_lossy(&done.get_output().stdout).into_owned();
    assert!(text.contains("not run, over what is left of the budget (10)"), "{text}");
}

#[test]
fn what_no_run_can_have_is_bad_input() {
    let folder = TempDir::new().expect("a folder");
    let told = |more: &[&str]| {
        let done = cost(&folder.path().join("none"), more).assert().code(2);
        String::from_utf8_lossy(&done.get_output().stderr).into_owned()
    };
    let text = told(&["--quantity", "tip"]);
    assert!(text.contains("unknown quantity 'tip'; there are end, sliding_distance"), "{text}");
    let text = told(&["--jitter=-1"]);
    assert!(text.contains("jitter.strength=-1.0"), "{text}");
    let text = told(&["--vary", "foo.bar=1,2"]);
    assert!(text.contains("unknown key `foo`") && text.contains("--set:1:1"), "{text}");
}

#[test]
fn a_scheme_that_is_asked_for_is_the_only_one() {
    let folder = TempDir::new().expect("a folder");
    let study = study(&folder.path().join("one"), &["--scheme", "implicit"]);
    let rows = study["rows"].as_array().expect("rows");
    // two meshes x three time steps
    assert!(rows.len() == 2 * 3 && rows.iter().all(|r| r["scheme"] == "implicit"), "{study}");
}
