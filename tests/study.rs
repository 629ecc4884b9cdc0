//! `rmpm study` from outside: the files of two arms, RFEM beside one, what is refused before anything
//! runs, and a kill that loses nothing.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command as Process, Stdio},
    time::{Duration, Instant},
};

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

const CASE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/random-slope.toml");

/// The paper's slope in cells of 1 m, with a weaker clay that slides, up to 7 s: some tens of milliseconds a
/// realisation; RFEM takes a second.
const STUDY: &str = r#"
title = "two arms"
realisations = 3
set = ["grid.cell=1", "field.strength.cell=1", "field.strength.correlation_error=1", "field.strength.variance_error=1",
       "material.clay.cohesion=16", "end.time=7", "output.history=0.1", "slide.threshold=0.25"]

[[arm]]
name = "short"
group = "scale"
set = ["field.strength.theta_h=2"]
rfem = true
expect = { mean = 9.43, source = "a paper" }

[[arm]]
name = "long"
group = "scale"
set = ["field.strength.theta_h=20"]
"#;

/// A study file beside a copy of the case; the temporary folder holds the results too.
fn folder(text: &str) -> (TempDir, PathBuf) {
    let root = tempfile::tempdir().expect("a folder");
    let path = root.path().join("study.toml");
    fs::copy(CASE, root.path().join("slope.toml")).expect("the case");
    fs::write(&path, format!("case = \"slope.toml\"\n{text}")).expect("the study");
    (root, path)
}

fn arguments(study: &Path, out: &Path, more: &[&str]) -> Vec<String> {
    let fixed = ["study".to_owned(), study.display().to_string(), "-q".to_owned(), "--out".to_owned()];
    fixed.into_iter().chain([out.display().to_string()]).chain(more.iter().map(|s| (*s).to_owned())).collect()
}

/// Standard output and standard error of a study that ends with `code`.
#[track_caller]
fn ends(study: &Path, out: &Path, more: &[&str], code: i32) -> (String, String) {
    let assert = Command::new(env!("CARGO_BIN_EXE_rmpm")).args(arguments(study, out, more)).assert().code(code);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("text");
    (text(&assert.get_output().stdout), text(&assert.get_output().stderr))
}

fn read(path: PathBuf) -> String {
    fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// `study.json` without the CPU times, the one thing in it that the machine decides.
fn timeless(out: &Path) -> Value {
    let mut study: Value = serde_json::from_str(&read(out.join("study.json"))).expect("JSON");
    for arm in study["arms"].as_array_mut().expect("arms") {
        for method in ["rmpm", "rfem"] {
            if let Some(figures) = arm[method].as_object_mut() {
                assert!(figures.remove("cpu_s").is_some_and(|s| s.as_f64() > Some(0.0)));
            }
        }
    }
    study
}

/// Columns of a table by its header.
fn column(path: PathBuf, name: &str) -> Vec<String> {
    let text = read(path);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let at = reader.headers().expect("a header").iter().position(|h| h == name).expect("a column");
    reader.records().map(|r| r.expect("a row")[at].to_owned()).collect()
}

#[test]
fn arms_stand_side_by_side_whatever_the_threads() {
    let (root, study) = folder(STUDY);
    let [one, two] = ["one", "two"].map(|name| root.path().join(name));
    let (stdout, _) = ends(&study, &one, &["-j", "1"], 0);
    assert!(stdout.contains("short, RFEM") && stdout.contains("a paper"), "{stdout}");
    ends(&study, &two, &["-j", "2"], 0);
    assert_eq!(timeless(&one), timeless(&two));
    for file in ["short-pairs.csv", "short/ensemble.csv", "short-rfem/ensemble.csv", "long/summary.json"] {
        assert_eq!(read(one.join(file)), read(two.join(file)), "{file}");
    }
    // the pairs are the rows of both ensembles, realisation by realisation
    let r = |folder: &str| column(one.join(folder).join("ensemble.csv"), "sliding_distance_m");
    assert_eq!(column(one.join("short-pairs.csv"), "rmpm_r_m"), r("short"));
    assert_eq!(column(one.join("short-pairs.csv"), "rfem_r_m"), r("short-rfem"));
    assert_ne!(r("short"), r("long"));
    let report = read(one.join("report.md"));
    for name in ["histograms-scale.png", "short-pairs.png"] {
        assert!(report.contains(name), "{report}");
        assert!(fs::read(one.join(name)).expect("a picture").starts_with(b"\x89PNG"), "{name}");
    }
    let study = timeless(&one);
    let mean = r("short").iter().map(|v| v.parse::<f64>().expect("a number")).sum::<f64>() / 3.0;
    let told = study["arms"][0]["rmpm"]["sliding_distance_m"]["mean"].as_f64().expect("a mean");
    // three numbers, perhaps summed in another order
    assert!((told - mean).abs() <= 4.0 * f64::EPSILON * mean, "{told} and {mean}");
    assert_eq!(
        (&study["arms"][0]["pairs"]["difference_m"]["n"], &study["arms"][1]["pairs"]),
        (&3.into(), &Value::Null)
    );
}

#[test]
fn what_is_wrong_in_a_later_arm_is_told_before_anything_runs() {
    let unknown = STUDY.replace("theta_h=20", "theta=20");
    let uniform = STUDY.replace("theta_h=20", "variation=0");
    let impossible = STUDY.replace("field.strength.theta_h=20", "field.strength.theta_h=1e-6");
    for (text, word) in [(unknown, "unknown key"), (uniform, "nothing in the case is random"), (impossible, "scale")] {
        let (root, study) = folder(&text);
        let out = root.path().join("out");
        let (_, stderr) = ends(&study, &out, &[], 2);
        assert!(stderr.contains("arm \"long\"") && stderr.contains(word), "{stderr}");
        assert!(!out.join("short").exists(), "{word}: an arm was begun");
    }
}

#[test]
fn what_needs_a_crest_is_refused_without_one() {
    let (root, study) = folder(STUDY);
    let path = root.path().join("slope.toml");
    let text = read(path.clone());
    let (head, tail) = text.split_once("[slide]").expect("a table");
    let rest = tail.split_once("[boundary]").expect("the next").1;
    fs::write(&path, format!("{head}[boundary]{rest}")).expect("the case");
    let own = STUDY.replace(", \"slide.threshold=0.25\"", "");
    fs::write(&study, format!("case = \"slope.toml\"\n{own}")).expect("the study");
    let (_, stderr) = ends(&study, &root.path().join("out"), &[], 2);
    assert!(stderr.contains("`slide`"), "{stderr}");
    let set = ["--set", "grid.cell=1", "--set", "ensemble.until={standard_error=1}", "--out"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_rmpm"));
    command.arg("ensemble").arg(&path).args(set).arg(root.path().join("one"));
    let stderr = command.assert().code(2).get_output().stderr.clone();
    assert!(String::from_utf8_lossy(&stderr).contains("`slide`"));
}

#[test]
fn a_study_that_is_not_whole_is_not_begun_again_in_silence() {
    let (root, study) = folder(&STUDY.replace("rfem = true", ""));
    let out = root.path().join("out");
    ends(&study, &out, &["-n", "2"], 0);
    let journal = read(out.join("short/journal.jsonl"));
    fs::remove_dir_all(out.join("long")).expect("as if killed between the arms");
    let (_, stderr) = ends(&study, &out, &["-n", "2"], 2);
    assert!(stderr.contains("1 of 2 ensembles") && stderr.contains("--resume"), "{stderr}");
    assert_eq!(read(out.join("short/journal.jsonl")), journal);
    let before = column(out.join("short/ensemble.csv"), "external_kj_per_m");
    // a larger number extends what is there
    ends(&study, &out, &["-n", "3", "--resume"], 0);
    assert_eq!(column(out.join("short/ensemble.csv"), "external_kj_per_m")[..2], before);
    assert_eq!(column(out.join("long/ensemble.csv"), "realisation"), ["0", "1", "2"]);
    let (_, stderr) = ends(&study, &out, &["--resume", "--set", "seed=2"], 2);
    assert!(stderr.contains("arm \"short\"") && stderr.contains("seed"), "{stderr}");
}

/// Waits for a number of rows in the journal of an arm.
fn wait_for(child: &mut Child, journal: &Path, rows: usize) {
    let began = Instant::now();
    let count = || fs::read_to_string(journal).map_or(0, |text| text.matches("\"row\"").count());
    while count() < rows {
        assert!(child.try_wait().expect("a state").is_none(), "ended before it was killed");
        assert!(began.elapsed() < Duration::from_secs(120), "no row came");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_killed_study_goes_on_where_it_was() {
    let (root, study) = folder(&STUDY.replace("rfem = true", ""));
    let [whole, cut] = ["whole", "cut"].map(|name| root.path().join(name));
    ends(&study, &whole, &["-n", "12"], 0);
    let mut child = Process::new(env!("CARGO_BIN_EXE_rmpm"))
        .args(arguments(&study, &cut, &["-n", "12", "-j", "1"]))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("a process");
    wait_for(&mut child, &cut.join("long/journal.jsonl"), 2);
    child.kill().expect("killed");
    child.wait().expect("ended");
    assert!(!cut.join("study.json").exists());
    let (_, stderr) = ends(&study, &cut, &["-n", "12"], 2);
    assert!(stderr.contains("not finished") && stderr.contains("--resume"), "{stderr}");
    ends(&study, &cut, &["-n", "12", "--resume"], 0);
    assert_eq!(timeless(&whole), timeless(&cut));
}
