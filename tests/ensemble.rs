//! `rmpm ensemble` and `rmpm merge` from outside: the same bytes whatever the threads, the shards and
//! the interruptions, and no row lost.

mod support;

use std::{
    fs,
    path::{Path, PathBuf},
};

use assert_cmd::Command;
use serde_json::Value;
use support::program::ends;
use tempfile::TempDir;

const SLOPE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/clay-slope.toml");

/// The paper's slope in cells of 1 m, with a weaker clay that slides, up to 7 s: some tens of milliseconds.
const SMALL: &[&str] =
    &["grid.cell=1", "material.clay.cohesion=16", "end.time=7", "output.history=0.1", "jitter.strength=0.02"];

/// What must be the same to the byte.
const SAME: [&str; 3] = ["ensemble.csv", "summary.json", "case.toml"];

/// A command on the small slope, into `out`.
fn ensemble(out: &Path, n: usize, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rmpm"));
    command.args(["ensemble", SLOPE, "-q", "-n", &n.to_string(), "--out"]).arg(out);
    SMALL.iter().for_each(|set| {
        command.args(["--set", set]);
    });
    command.args(more);
    command
}

fn merge(shards: &[PathBuf], out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rmpm"));
    command.arg("merge").args(shards).arg("--out").arg(out);
    command
}

fn read(path: PathBuf) -> Vec<u8> {
    fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn json(path: PathBuf) -> Value {
    serde_json::from_slice(&read(path)).expect("JSON")
}

#[track_caller]
fn same(a: &Path, b: &Path) {
    for name in SAME {
        assert!(read(a.join(name)) == read(b.join(name)), "{name} of {} and {}", a.display(), b.display());
    }
}

/// Columns of `ensemble.csv` by name.
fn column(out: &Path, name: &str) -> Vec<String> {
    let bytes = read(out.join("ensemble.csv"));
    let mut reader = csv::Reader::from_reader(&bytes[..]);
    let at = reader.headers().expect("a header").iter().position(|h| h == name).expect("a column");
    reader.records().map(|r| r.expect("a row")[at].to_owned()).collect()
}

/// The shards of an ensemble, each run.
fn shards(root: &TempDir, n: usize, of: usize) -> Vec<PathBuf> {
    let shard = |index: usize| {
        let out = root.path().join(format!("shard{index}of{of}"));
        ends(ensemble(&out, n, &["--shard", &format!("{index}/{of}")]), 0);
        out
    };
    (1..=of).map(shard).collect()
}

#[test]
fn threads_and_shards_leave_no_trace() {
    let root = tempfile::tempdir().expect("a folder");
    let one = root.path().join("one");
    let (stdout, _) = ends(ensemble(&one, 16, &["-j", "1"]), 0);
    assert!(stdout.contains("16 realisations") && stdout.contains("sliding distance (m)"), "{stdout}");
    for j in ["2", "3"] {
        let out = root.path().join(j);
        ends(ensemble(&out, 16, &["-j", j]), 0);
        same(&one, &out);
    }
    let merged = root.path().join("merged");
    ends(merge(&shards(&root, 16, 7), &merged), 0);
    same(&one, &merged);
    // the realisations are draws, not copies
    let mut r = column(&one, "external_kj_per_m");
    r.sort();
    r.dedup();
    assert_eq!(r.len(), 16);
    assert_eq!(column(&one, "realisation"), (0..16).map(|k| k.to_string()).collect::<Vec<_>>());
    let summary = json(one.join("summary.json"));
    assert_eq!(summary["done"], 16);
    assert!(summary["deterministic"]["measures"]["sliding_distance_m"].is_number());
    let values: Vec<f64> = column(&one, "runout_m").iter().map(|v| v.parse().expect("a number")).collect();
    let mean = values.iter().sum::<f64>() / 16.0;
    let told = summary["statistics"]["runout_m"]["mean"].as_f64().expect("a mean");
    // the same 16 numbers, perhaps summed in another order
    assert!((told / mean - 1.0).abs() < 16.0 * f64::EPSILON, "{told} and {mean}");
    assert!(summary["sliding_distance"]["no_slide"]["share"].is_number());
}

#[test]
fn json_is_all_that_goes_to_standard_output() {
    let root = tempfile::tempdir().expect("a folder");
    let out = root.path().join("run");
    let (stdout, _) = ends(ensemble(&out, 2, &["--json", "-j", "2"]), 0);
    let report: Value = serde_json::from_str(&stdout).expect("JSON");
    assert_eq!(report["summary"], json(out.join("summary.json")));
    assert_eq!(report["timing"], json(out.join("timing.json")));
    assert_eq!(report["timing"]["threads"], 2);
    for name in ["histogram.png", "exceedance.png", "convergence.png"] {
        assert!(read(out.join(name)).starts_with(b"\x89PNG"), "{name}");
    }
    let timed = String::from_utf8(read(out.join("ensemble_timing.csv"))).expect("text");
    assert_eq!(timed.lines().count(), 3);
}

#[test]
fn more_realisations_can_follow_and_a_first_one_be_chosen() {
    let root = tempfile::tempdir().expect("a folder");
    let [short, long, late, merged] = ["short", "long", "late", "merged"].map(|name| root.path().join(name));
    ends(ensemble(&short, 3, &[]), 0);
    ends(ensemble(&long, 6, &[]), 0);
    ends(ensemble(&late, 3, &["--first", "3"]), 0);
    ends(merge(&[short.clone(), late], &merged), 0);
    same(&long, &merged);
    ends(ensemble(&short, 6, &["--resume"]), 0);
    same(&long, &short);
    assert_eq!(json(short.join("timing.json"))["realisations"], 3);
}

#[test]
fn the_rule_stops_at_the_same_n_whatever_the_threads_and_what_was_done_before() {
    let root = tempfile::tempdir().expect("a folder");
    let rule =
        ["ensemble.until.measure=external_kj_per_m", "ensemble.until.standard_error=1", "ensemble.until.at_least=5"];
    let rule: Vec<&str> = rule.iter().flat_map(|set| ["--set", set]).collect();
    let [one, three, gone_on] = ["one", "three", "gone on"].map(|name| root.path().join(name));
    ends(ensemble(&one, 200, &[&rule[..], &["-j", "1"]].concat()), 0);
    ends(ensemble(&three, 200, &[&rule[..], &["-j", "3"]].concat()), 0);
    ends(ensemble(&gone_on, 150, &["-j", "2"]), 0);
    ends(ensemble(&gone_on, 200, &[&rule[..], &["--resume"]].concat()), 0);
    let summary = json(one.join("summary.json"));
    let n = summary["done"].as_u64().expect("a number");
    assert!((5..150).contains(&n), "{n}");
    assert_eq!((&summary["until"]["reached"], summary["until"]["n"].as_u64()), (&Value::Bool(true), Some(n)));
    same(&one, &three);
    same(&one, &gone_on);
    // by hand: the first n with sd / sqrt(n) <= 1
    let values: Vec<f64> = column(&gone_on, "external_kj_per_m").iter().map(|v| v.parse().expect("a number")).collect();
    let error = |n: usize| {
        let mean = values[..n].iter().sum::<f64>() / n as f64;
        let squares: f64 = values[..n].iter().map(|v| (v - mean).powi(2)).sum();
        (squares / (n as f64 - 1.0) / n as f64).sqrt()
    };
    let n = n as usize;
    assert!(error(n) <= 1.0 && (5..n).all(|m| error(m) > 1.0), "{n}");
    let (_, stderr) = ends(ensemble(&one, 9, &[&rule[..], &["--shard", "1/2", "--fresh"]].concat()), 2);
    assert!(stderr.contains("ensemble.until"), "{stderr}");
}

/// A random field of strength, in opposite pairs.
const FIELD: &str = r#"
[ensemble]
antithetic = true
[field.strength]
material = "clay"
parameters = ["cohesion", "residual_cohesion"]
variation = 0.25
theta_h = 6.0
theta_v = 1.0
cell = 1.0
"#;

#[test]
fn realisations_of_a_field_come_in_opposite_pairs_and_the_mean_is_the_run_without_it() {
    let root = tempfile::tempdir().expect("a folder");
    let [with, plain] = ["with.toml", "plain.toml"].map(|name| root.path().join(name));
    let text = String::from_utf8(read(SLOPE.into())).expect("text");
    fs::write(&with, format!("{text}\n{FIELD}")).expect("a case");
    fs::write(&plain, &text).expect("a case");
    let out = root.path().join("run");
    let sets = || SMALL.iter().filter(|set| !set.starts_with("jitter")).flat_map(|set| ["--set", set]);
    let mut command = Command::new(env!("CARGO_BIN_EXE_rmpm"));
    command.arg("ensemble").arg(&with).args(["-q", "-n", "6", "--out"]).arg(&out).args(sets());
    ends(command, 0);
    assert_eq!(column(&out, "antithetic"), ["1", "0", "3", "2", "5", "4"]);
    let mut energies = column(&out, "external_kj_per_m");
    energies.sort();
    energies.dedup();
    assert_eq!(energies.len(), 6);
    let solved = root.path().join("solved");
    let mut command = Command::new(env!("CARGO_BIN_EXE_rmpm"));
    command.arg("solve").arg(&plain).args(["-q", "--no-frames", "--out"]).arg(&solved).args(sets());
    ends(command, 0);
    let mean = &json(out.join("summary.json"))["deterministic"]["measures"]["external_kj_per_m"];
    assert_eq!(mean, &json(solved.join("record.json"))["measures"]["energy_kj_per_m"]["external"]);
}

#[test]
fn what_cannot_be_gone_on_with_is_refused() {
    let root = tempfile::tempdir().expect("a folder");
    let out = root.path().join("run");
    ends(ensemble(&out, 4, &["--time-limit", "0"]), 4);
    assert_eq!(column(&out, "realisation").len(), 0);
    let (_, stderr) = ends(ensemble(&out, 4, &[]), 2);
    assert!(stderr.contains("--resume") && stderr.contains("--fresh"), "{stderr}");
    let (_, stderr) = ends(ensemble(&out, 4, &["--resume", "--set", "seed=2"]), 2);
    assert!(stderr.contains("seed is 1"), "{stderr}");
    let (_, stderr) = ends(ensemble(&out, 4, &["--resume", "--set", "grid.cell=0.5"]), 2);
    assert!(stderr.contains("another case"), "{stderr}");
    let (_, stderr) = ends(ensemble(&out, 4, &["--resume", "--shard", "1/2"]), 2);
    assert!(stderr.contains("shard 1/1"), "{stderr}");
    let (_, stderr) = ends(ensemble(&out, 4, &["--fresh", "--set", "jitter.strength=0"]), 2);
    assert!(stderr.contains("jitter.strength"), "{stderr}");
    ends(ensemble(&out, 4, &["--resume"]), 0);
    assert_eq!(column(&out, "status").len(), 4);
    // a finished one may be started over
    ends(ensemble(&out, 2, &["--set", "seed=2"]), 0);
    assert_eq!(column(&out, "seed"), ["2", "2"]);
}

#[test]
fn a_damaged_journal_is_told_and_mended() {
    let root = tempfile::tempdir().expect("a folder");
    let [whole, out] = ["whole", "out"].map(|name| root.path().join(name));
    ends(ensemble(&whole, 6, &[]), 0);
    ends(ensemble(&out, 6, &[]), 0);
    let journal = out.join("journal.jsonl");
    let mut bytes = read(journal.clone());
    // the second row, one bit in the middle; and a last line cut short
    let lines: Vec<usize> = bytes.iter().enumerate().filter(|(_, b)| **b == b'\n').map(|(i, _)| i).collect();
    bytes[usize::midpoint(lines[1], lines[2])] ^= 4;
    bytes.truncate(lines[6] - 20);
    fs::write(&journal, &bytes).expect("written");
    let (_, stderr) = ends(ensemble(&out, 6, &["--resume"]), 0);
    assert!(stderr.contains("line 3 is damaged") && stderr.contains("not whole"), "{stderr}");
    assert_eq!(json(out.join("timing.json"))["realisations"], 3, "two damaged, and the last");
    same(&whole, &out);
}

#[test]
fn merge_tells_what_is_missing_doubled_foreign_and_damaged() {
    let root = tempfile::tempdir().expect("a folder");
    let parts = shards(&root, 8, 4);
    let out = root.path().join("merged");
    let (_, stderr) = ends(merge(&parts[..3], &out), 2);
    assert!(stderr.contains("realisations 3, 7") && stderr.contains("shard 4/4 is not among"), "{stderr}");
    assert!(!out.exists());

    let twice: Vec<PathBuf> = parts.iter().chain(&parts[1..2]).cloned().collect();
    let (_, stderr) = ends(merge(&twice, &out), 0);
    assert!(stderr.contains("twice and alike"), "{stderr}");

    let foreign = root.path().join("foreign");
    ends(ensemble(&foreign, 8, &["--shard", "4/4", "--set", "seed=2"]), 0);
    let mixed: Vec<PathBuf> = parts[..3].iter().chain([&foreign]).cloned().collect();
    let (_, stderr) = ends(merge(&mixed, &out), 2);
    assert!(stderr.contains("foreign is of another ensemble: seed 2"), "{stderr}");

    let (_, stderr) = ends(merge(&parts, &parts[0]), 2);
    assert!(stderr.contains("is one of the shards"), "{stderr}");

    let nothing = root.path().join("nothing");
    let (_, stderr) = ends(merge(&[nothing], &out), 2);
    assert!(stderr.contains("holds no ensemble"), "{stderr}");

    let journal = parts[3].join("journal.jsonl");
    let mut bytes = read(journal.clone());
    let at = bytes.iter().position(|b| *b == b'\n').expect("a line") + 300;
    bytes[at] ^= 1;
    fs::write(&journal, &bytes).expect("written");
    let (_, stderr) = ends(merge(&parts, &out), 2);
    assert!(stderr.contains("line 2 is damaged") && stderr.contains("shard4of4 (shard 4/4) lacks 1"), "{stderr}");
}

/// A block thrown out through the free right side.
const THROWN: &str = r#"
title = "A block thrown out of the grid"
[grid]
cell = 0.5
size = [4.0, 2.0]
[gravity]
schedule = "none"
[jitter]
strength = 0.001
[end]
time = 1.0
at_rest = false
[boundary]
base = "roller"
[material.stiff]
law = "elastic"
unit_weight = 20.0
young_modulus = 1e4
poisson_ratio = 0.3
[[region]]
name = "block"
material = "stiff"
polygon = [[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]]
velocity = [20.0, 0.0]
"#;

#[test]
fn a_failed_realisation_is_a_row_with_its_reason() {
    let root = tempfile::tempdir().expect("a folder");
    let (case, out) = (root.path().join("thrown.toml"), root.path().join("run"));
    fs::write(&case, THROWN).expect("a case");
    let mut command = Command::new(env!("CARGO_BIN_EXE_rmpm"));
    command.args(["ensemble", "-n", "3", "--out"]).arg(&out).arg(&case);
    let (_, stderr) = ends(command, 5);
    assert!(stderr.contains("4 runs failed"), "{stderr}");
    assert_eq!(column(&out, "status"), ["failed"; 3]);
    assert!(column(&out, "fault").iter().all(|f| f.contains("left the grid")));
    assert!(column(&out, "steps").iter().all(|s| s.parse::<u64>().is_ok_and(|n| n > 0)));
    assert!(column(&out, "runout_m").iter().all(String::is_empty));
    assert_eq!(json(out.join("summary.json"))["counts"]["failed"], 3);
}

#[cfg(unix)]
mod signals {
    use std::{
        process::{Child, Command as Process, Stdio},
        thread::sleep,
        time::{Duration, Instant},
    };

    use super::*;

    fn rows(out: &Path) -> usize {
        fs::read(out.join("journal.jsonl")).map_or(0, |b| b.iter().filter(|b| **b == b'\n').count().saturating_sub(1))
    }

    fn started(out: &Path, n: usize, more: &[&str]) -> Child {
        let prepared = ensemble(out, n, more);
        let mut command = Process::new(env!("CARGO_BIN_EXE_rmpm"));
        command.args(prepared.get_args()).stdout(Stdio::null()).stderr(Stdio::piped());
        command.spawn().expect("a run")
    }

    /// Waits until `count` rows are safe.
    fn wait_for(child: &mut Child, out: &Path, count: usize) {
        let patience = Instant::now();
        while rows(out) < count {
            assert!(patience.elapsed() < Duration::from_secs(60), "no rows come");
            assert!(child.try_wait().expect("a state").is_none(), "the run ended early");
            sleep(Duration::from_millis(2));
        }
    }

    fn send(signal: &str, child: &Child) {
        let sent = Process::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
        assert!(sent.success());
    }

    fn is_interrupted(child: Child) {
        let output = child.wait_with_output().expect("an end");
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(130), "{stderr}");
        assert!(stderr.contains("go on with: ") && stderr.contains("--resume"), "{stderr}");
    }

    #[test]
    fn signals_finish_what_is_under_way_and_the_rest_can_follow() {
        let root = tempfile::tempdir().expect("a folder");
        let whole = root.path().join("whole");
        ends(ensemble(&whole, 40, &[]), 0);
        for signal in ["-TERM", "-USR1", "-INT"] {
            let out = root.path().join(signal);
            let mut child = started(&out, 40, &["-j", "2"]);
            wait_for(&mut child, &out, 3);
            send(signal, &child);
            is_interrupted(child);
            let done = column(&out, "realisation").len();
            assert!((2..40).contains(&done), "{done}");
            assert_eq!(json(out.join("summary.json"))["missing"], 40 - done);
            ends(ensemble(&out, 40, &["--resume"]), 0);
            same(&whole, &out);
        }
    }

    /// In cells of 0.1 m a realisation takes minutes: only one that is abandoned ends soon.
    #[test]
    fn a_second_signal_abandons_what_is_under_way() {
        let root = tempfile::tempdir().expect("a folder");
        let out = root.path().join("run");
        let mut child = started(&out, 4, &["-j", "2", "--set", "grid.cell=0.1"]);
        let patience = Instant::now();
        while !out.join("case.toml").exists() {
            assert!(patience.elapsed() < Duration::from_secs(60) && child.try_wait().expect("a state").is_none());
            sleep(Duration::from_millis(5));
        }
        send("-TERM", &child);
        sleep(Duration::from_millis(200));
        assert!(child.try_wait().expect("a state").is_none(), "the first signal has ended it");
        send("-USR1", &child);
        let asked = Instant::now();
        is_interrupted(child);
        assert!(asked.elapsed() < Duration::from_secs(20));
        assert_eq!(column(&out, "realisation").len(), 0);
    }

    /// Kills at random moments, 12 of them, or as many as RMPM_KILLS says.
    #[test]
    fn kills_at_random_moments_lose_nothing() {
        const N: usize = 60;
        let kills: u64 = std::env::var("RMPM_KILLS").ok().and_then(|v| v.parse().ok()).unwrap_or(12);
        let root = tempfile::tempdir().expect("a folder");
        let whole = root.path().join("whole");
        let began = Instant::now();
        ends(ensemble(&whole, N, &[]), 0);
        let span = began.elapsed().as_micros() as u64;
        let mut done = 0;
        for round in 0.. {
            let out = root.path().join(format!("run{round}"));
            let mut first = true;
            loop {
                let mut child = started(&out, N, if first { &["--fresh"] } else { &["--resume"] });
                first = false;
                if done == kills {
                    break assert!(child.wait().expect("an end").success());
                }
                // the moments are spread over a third of a whole run by the golden ratio
                let part = ((done.wrapping_mul(11_400_714_819_323_198_485) >> 32) * (span / 3)) >> 32;
                sleep(Duration::from_micros(part));
                let ended = child.try_wait().expect("a state");
                child.kill().expect("killed");
                child.wait().expect("an end");
                done += 1;
                if let Some(status) = ended {
                    break assert!(status.success());
                }
            }
            same(&whole, &out);
            if done == kills {
                break;
            }
        }
    }
}
