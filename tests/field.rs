//! `rmpm field` from outside: its files, its figures, its exit codes.

mod support;

use std::{fs, path::Path};

use assert_cmd::Command;
use serde_json::Value;
use support::program::{ends, folder};

const SLOPE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/validation/field/case.toml");
const UNIFORM: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/clay-slope.toml");

fn field(case: &str, out: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rmpm"));
    command.args(["field", case, "--out"]).arg(out).args(more);
    command
}

/// The numbers of an array, which stand in the last 8 x cells bytes.
fn numbers(path: &Path, cells: usize) -> Vec<f64> {
    let bytes = fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let raw = &bytes[bytes.len() - 8 * cells..];
    raw.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect()
}

#[test]
fn all_files_of_all_realisations_are_left_with_the_same_values() {
    let (_root, out) = folder();
    let (text, _) = ends(field(SLOPE, &out, &["-n", "2", "--realisation", "3"]), 0);
    assert!(text.contains("field strength") && text.contains("implied") && text.contains("+-"), "{text}");
    for k in [3, 4] {
        let path = |kind: &str| out.join(format!("field-strength-{k}.{kind}"));
        let values = numbers(&path("npy"), 2000);
        let mut table = csv::Reader::from_path(path("csv")).expect("a table");
        assert_eq!(table.headers().expect("a header"), vec!["x_m", "y_m", "cohesion_kPa"]);
        let rows: Vec<[f64; 3]> = table.deserialize().map(|row| row.expect("numbers")).collect();
        assert_eq!(rows.iter().map(|r| r[2]).collect::<Vec<_>>(), values);
        assert_eq!((rows[0][0], rows[0][1], rows[100][0], rows[100][1]), (0.125, 0.125, 0.125, 0.375));
        assert!(fs::metadata(path("vti")).is_ok_and(|m| m.len() > 16_000));
        assert!(fs::read(path("png")).expect("a picture").starts_with(b"\x89PNG"));
    }
}

#[test]
fn a_realisation_is_the_same_alone_and_among_others_and_twice() {
    let (_root, out) = folder();
    let record = |more: &[&str]| {
        let (text, _) = ends(field(SLOPE, &out, &[more, &["--formats", "npy", "--json"]].concat()), 0);
        let json: Value = serde_json::from_str(&text).expect("JSON and nothing else");
        (json["record"].clone(), out.join("field-strength-5.npy"))
    };
    let (several, path) = record(&["-n", "3", "--realisation", "4"]);
    let (values, file) = (numbers(&path, 2000), fs::read(out.join("field.json")).expect("a record"));
    assert_eq!(several["fields"][0]["drawn"][1]["realisation"], 5);
    let (again, _) = record(&["-n", "3", "--realisation", "4"]);
    assert_eq!((&several, &file), (&again, &fs::read(out.join("field.json")).expect("a record")));
    let (alone, path) = record(&["--set", "ensemble.realisation=5"]);
    assert_eq!(values, numbers(&path, 2000));
    assert_eq!(several["fields"][0]["drawn"][1], alone["fields"][0]["drawn"][0]);
    assert!(!out.join("field-strength-4.npy").exists(), "files of an earlier call are taken away");
}

/// Mean and standard deviation of 40 fields lie within four standard errors of the exact figures.
#[test]
fn figures_agree_with_what_is_expected() {
    let (_root, out) = folder();
    let (text, _) = ends(field(SLOPE, &out, &["-n", "40", "--formats", "npy", "--json"]), 0);
    let json: Value = serde_json::from_str(&text).expect("JSON");
    let field = &json["record"]["fields"][0];
    let number = |part: &str, key: &str| field[part][key].as_f64().unwrap_or(f64::NAN);
    for key in ["mean", "sd"] {
        let off = number("sampled", &format!("{key}_factor")) - number("expected", &format!("{key}_factor"));
        assert!(off.abs() < 4.0 * number("sampled", &format!("{key}_standard_error")), "{key}: {off}");
    }
    assert!(number("accuracy", "correlation_error") <= 0.05 && number("accuracy", "variance_error") <= 0.03);
    let worst = field["correlations"].as_array().expect("lags").iter().map(|lag| {
        let off = |k: usize| (lag["implied"][k].as_f64().unwrap() - lag["target"].as_f64().unwrap()).abs();
        off(0).max(off(1))
    });
    let worst = worst.fold(0.0, f64::max);
    assert!(worst <= number("accuracy", "correlation_error") + 1e-9, "{worst}: the largest over all lags is stated");
    assert!(json["timing"]["ms_per_field"]["strength"].as_f64().is_some_and(|ms| ms > 0.0));
}

#[test]
fn a_field_without_variation_is_its_mean() {
    let (_root, out) = folder();
    let (text, _) = ends(field(SLOPE, &out, &["--set", "field.strength.variation=0"]), 0);
    assert!(text.contains("nothing varies"), "{text}");
    assert!(numbers(&out.join("field-strength-0.npy"), 2000).iter().all(|c| *c == 20.0));
}

#[test]
fn what_cannot_be_done_is_refused() {
    let (_root, out) = folder();
    let (_, error) = ends(field(UNIFORM, &out, &[]), 2);
    assert!(error.contains("no [field.NAME]"), "{error}");
    let (_, error) = ends(field(SLOPE, &out, &["-n", "100000", "--max-memory", "1GB"]), 4);
    assert!(error.contains("--max-memory"), "{error}");
    fs::create_dir_all(&out).and_then(|()| fs::write(out.join("letter.txt"), "mine")).expect("a file");
    fs::remove_file(out.join(".rmpm-lock")).ok();
    let (_, error) = ends(field(SLOPE, &out, &[]), 3);
    assert!(error.contains("not overwritten"), "{error}");
}
