//! The program from outside: files, streams and exit codes.

mod support;

use std::{collections::BTreeMap, fs, path::Path};

use assert_cmd::Command;
use serde_json::Value;
use support::program::{SLOPE, coarse, ends, folder, has, json, rmpm};

/// A block thrown out through the free right side.
const THROWN: &str = r#"
title = "A block thrown out of the grid"
[grid]
cell = 0.5
size = [4.0, 2.0]
[gravity]
schedule = "none"
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

fn solve(out: &Path) -> Command {
    let mut command = coarse("solve");
    command.arg("--out").arg(out);
    command
}

/// Every file below a folder by its relative path, but for the lock and what depends on the hour.
fn deterministic_files(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut open = vec![root.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                open.push(path);
                continue;
            }
            let name = path.strip_prefix(root).expect("below").to_string_lossy().into_owned();
            if name != "timing.json" && name != ".rmpm-lock" {
                files.insert(name, fs::read(&path).expect("a file"));
            }
        }
    }
    files
}

#[test]
fn solve_leaves_every_file_of_the_contract() {
    let (_root, out) = folder();
    let (stdout, _) = ends(solve(&out), 0);
    assert!(stdout.contains("r = ") && stdout.contains("energy"), "{stdout}");
    for name in ["case.toml", "record.json", "timing.json", "history.csv", "run.pvd"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let pictures = ["plastic_strain", "strength", "stage", "displacement", "sliding_distance", "energies"];
    for name in pictures {
        let bytes = fs::read(out.join(format!("pictures/{name}.png"))).expect(name);
        assert!(bytes.starts_with(b"\x89PNG"), "{name}");
    }
    // t = 0 and every second up to 6
    let pvd = fs::read_to_string(out.join("run.pvd")).expect("run.pvd");
    for k in 0..=6 {
        let name = format!("frames/{k:05}.vtp");
        assert!(pvd.contains(&name) && out.join(&name).is_file(), "{name}");
    }
    record_has_every_key(&json(&out.join("record.json")));
    timing_has_every_key(&json(&out.join("timing.json")));
    history_has_every_column(&out.join("history.csv"));
}

/// Asserts the type of each `pointer`: s(tring), n(umber), b(ool), a(rray), o(bject), 0 (null).
fn record_has_every_key(record: &Value) {
    has(record, &[("/schema_version", 'n'), ("/units", 's'), ("/case_hash", 's'), ("/inputs", 'a')]);
    has(record, &[("/build/version", 's'), ("/build/commit", 's'), ("/build/rustc", 's'), ("/build/fp_path", 's')]);
    has(record, &[("/inputs/0/path", 's'), ("/inputs/0/sha256", 's'), ("/overrides", 'a')]);
    has(record, &[("/scheme", 's'), ("/kinematics", 's'), ("/shape", 's'), ("/seed", 'n')]);
    has(record, &[("/effects/0/name", 's'), ("/effects/0/on", 'b'), ("/effects/0/why", 's')]);
    has(record, &[("/dt_s/min", 'n'), ("/dt_s/mean", 'n'), ("/dt_s/max", 'n')]);
    has(record, &[("/outcome/status", 's'), ("/outcome/time_s", 'n'), ("/outcome/message", 's'), ("/fault", '0')]);
    has(record, &[("/regime", '0'), ("/events", 'a')]);
    has(record, &[("/warnings/0/code", 's'), ("/warnings/0/text", 's'), ("/warnings/0/key", 's')]);
    for key in ["sliding_distance_m", "blocks", "slide_volume_m3_per_m", "runout_m"] {
        has(record, &[(&format!("/measures/{key}"), 'n')]);
    }
    has(record, &[("/measures/sliding_distance_at", 'o'), ("/measures/sliding_distance_censored", 'b')]);
    for key in ["kinetic", "nodal_kinetic", "strain", "external", "dissipated", "numerical"] {
        has(record, &[(&format!("/measures/energy_kj_per_m/{key}"), 'n')]);
    }
    for key in WORK {
        has(record, &[(&["", "work", key].join("/"), 'n')]);
    }
    assert_eq!(record["scheme"], "explicit");
    assert_eq!(record["outcome"]["status"], "end_time");
    assert!(record["measures"]["sliding_distance_m"].as_f64() > Some(2.0));
    assert_eq!(record["work"]["points"], 4 * record["work"]["cells"].as_u64().expect("cells"));
}

const WORK: [&str; 9] = [
    "points",
    "cells",
    "steps",
    "rejected_steps",
    "particle_steps",
    "newton_iterations",
    "factorisations",
    "symbolic_factorisations",
    "fallback_solves",
];

fn timing_has_every_key(timing: &Value) {
    has(timing, &[("/wall_s", 'n'), ("/threads", 'n'), ("/by_phase/solve", 'n'), ("/by_phase/pictures", 'n')]);
    for key in ["cpu_s", "peak_memory_bytes", "particle_steps_per_cpu_s"] {
        assert!(timing.get(key).is_some_and(|v| v.is_number() || v.is_null()), "{key}");
    }
}

fn history_has_every_column(path: &Path) {
    let text = fs::read_to_string(path).expect("history.csv");
    let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let promised = [
        "time_s",
        "dt_s",
        "kinetic_kj_per_m",
        "nodal_kinetic_kj_per_m",
        "strain_kj_per_m",
        "external_kj_per_m",
        "dissipated_kj_per_m",
        "sliding_distance_m",
        "newton_iterations",
        "residual",
    ];
    for column in promised {
        assert!(header.contains(&column), "{column}");
    }
    // a row at t = 0 and one every 0.1 s up to 6 s
    assert_eq!(text.lines().count(), 1 + 61);
}

#[test]
fn two_runs_leave_the_same_bytes() {
    let ((_a, first), (_b, second)) = (folder(), folder());
    ends(solve(&first), 0);
    ends(solve(&second), 0);
    let (first, second) = (deterministic_files(&first), deterministic_files(&second));
    assert!(first.len() > 15);
    assert_eq!(first.keys().collect::<Vec<_>>(), second.keys().collect::<Vec<_>>());
    for (name, bytes) in &first {
        assert!(*bytes == second[name], "{name} differs");
    }
}

/// Wider vectors only do more of the operations of the baseline at once: they round alike.
#[test]
fn the_baseline_instructions_leave_the_same_bytes() {
    let ((_a, first), (_b, second)) = (folder(), folder());
    ends(solve(&first), 0);
    let mut baseline = solve(&second);
    baseline.env("RMPM_FP_PATH", "baseline");
    ends(baseline, 0);
    assert_eq!(json(&second.join("timing.json"))["instruction_path"], "baseline");
    assert!(deterministic_files(&first) == deterministic_files(&second));
}

#[test]
fn a_second_run_in_the_same_folder_takes_its_place() {
    let (_root, out) = folder();
    ends(solve(&out), 0);
    let mut again = solve(&out);
    again.args(["--set", "end.time=2"]);
    ends(again, 0);
    assert_eq!(fs::read_dir(out.join("frames")).expect("frames").count(), 3);
}

#[test]
fn json_is_all_there_is_on_standard_output() {
    let (_root, out) = folder();
    let mut command = solve(&out);
    command.args(["--json", "--no-frames"]);
    let (stdout, _) = ends(command, 0);
    let printed: Value = serde_json::from_str(&stdout).expect("one JSON value");
    assert_eq!(printed["record"], json(&out.join("record.json")));
    assert_eq!(printed["timing"], json(&out.join("timing.json")));
    assert_eq!(printed.as_object().map(|o| o.len()), Some(2));
}

#[test]
fn an_override_is_recorded() {
    let (_root, out) = folder();
    let mut command = solve(&out);
    command.args(["--set", "material.clay.cohesion=18", "--no-frames"]);
    ends(command, 0);
    let record = json(&out.join("record.json"));
    let overrides = record["overrides"].as_array().expect("a list");
    assert!(overrides.contains(&Value::from("material.clay.cohesion=18")), "{overrides:?}");
    let resolved = fs::read_to_string(out.join("case.toml")).expect("case.toml");
    assert!(resolved.contains("cohesion = 18"), "{resolved}");
}

#[test]
fn an_unknown_key_ends_with_2_and_a_caret() {
    let (_root, out) = folder();
    let mut command = solve(&out);
    command.args(["--set", "material.clay.cohesin=18"]);
    let (_, stderr) = ends(command, 2);
    assert!(stderr.contains("^^^^^^^") && stderr.contains("did you mean `cohesion`?"), "{stderr}");
    assert!(!out.exists());
}

#[test]
fn the_implicit_scheme_tells_what_it_took_and_when_the_slope_lost_its_stability() {
    let (_root, out) = folder();
    let mut command = solve(&out);
    command.args(["--scheme", "implicit", "--set", "grid.cell=1", "--set", "implicit.time_step=0.04"]);
    command.args(["--set", "material.clay.cohesion=16"]);
    let (stdout, _) = ends(command, 0);
    for words in ["iterations a step", "stability lost", "inertia on"] {
        assert!(stdout.contains(words), "{words}: {stdout}");
    }
    let record = json(&out.join("record.json"));
    has(&record, &[("/events/0/time_s", 'n'), ("/events/0/kind", 's'), ("/events/0/why", 's')]);
    assert_eq!((record["scheme"].as_str(), record["regime"].as_str()), (Some("implicit"), Some("auto")));
    let text = fs::read_to_string(out.join("history.csv")).expect("history.csv");
    let row = |line: Option<&str>| -> Vec<String> { line.expect("a row").split(',').map(str::to_owned).collect() };
    let (names, last) = (row(text.lines().next()), row(text.lines().last()));
    let of =
        |name: &str| last[names.iter().position(|n| n == name).unwrap_or_else(|| panic!("{name}: {names:?}"))].clone();
    let (iterations, residual) = (of("newton_iterations"), of("residual"));
    assert!(iterations.parse::<u32>().is_ok_and(|n| n > 0), "{iterations}");
    assert!(residual.parse::<f64>().is_ok_and(|r| r > 0.0 && r < 1e-3), "{residual}");
}

#[test]
fn the_scheme_is_an_option_of_every_verb_that_reads_a_case() {
    for verb in ["check", "explain", "solve", "converge"] {
        let (_, stderr) = ends(rmpm(&[verb, SLOPE, "--scheme", "magic"]), 2);
        assert!(stderr.contains("`solver.scheme` cannot be \"magic\""), "{verb}: {stderr}");
    }
}

#[test]
fn a_missing_file_ends_with_3() {
    let (_, stderr) = ends(rmpm(&["solve", "no-such-case.toml"]), 3);
    assert!(stderr.contains("no-such-case.toml"), "{stderr}");
    ends(rmpm(&["plot", "no-such-folder"]), 3);
}

#[test]
fn a_foreign_folder_is_not_overwritten() {
    let (_root, out) = folder();
    fs::create_dir(&out).expect("a folder");
    fs::write(out.join("thesis.tex"), "years of work").expect("a file");
    let (_, stderr) = ends(solve(&out), 3);
    assert!(stderr.contains("not overwritten"), "{stderr}");
    assert_eq!(fs::read_dir(&out).expect("the folder").count(), 1);
}

#[test]
fn too_much_memory_ends_with_4_before_anything_is_written() {
    let (_root, out) = folder();
    let mut command = rmpm(&["solve", SLOPE, "--max-memory", "1MB", "--out"]);
    command.arg(&out);
    let (_, stderr) = ends(command, 4);
    assert!(stderr.contains("--max-memory"), "{stderr}");
    assert!(!out.exists());
}

#[test]
fn a_time_limit_ends_with_4_and_keeps_the_record() {
    let (_root, out) = folder();
    let mut command = solve(&out);
    command.args(["--time-limit", "0"]);
    ends(command, 4);
    let record = json(&out.join("record.json"));
    assert_eq!(record["outcome"]["status"], "resource_cap");
    assert!(out.join("timing.json").is_file());
}

#[test]
fn a_failed_run_ends_with_1_and_keeps_the_record_with_its_fault() {
    let (root, out) = folder();
    let case = root.path().join("thrown.toml");
    fs::write(&case, THROWN).expect("a case");
    let mut command = rmpm(&["solve", "--out"]);
    command.arg(&out).arg(&case);
    let (_, stderr) = ends(command, 1);
    assert!(stderr.contains("left the grid") && stderr.contains("grid.size"), "{stderr}");
    let record = json(&out.join("record.json"));
    assert_eq!(record["outcome"]["status"], "failed");
    has(&record, &[("/fault/kind", 's'), ("/fault/step", 'n'), ("/fault/time_s", 'n'), ("/fault/point", 'n')]);
    has(&record, &[("/fault/node", '0'), ("/fault/x_m", 'a'), ("/fault/values", 'o')]);
    assert_eq!(record["fault"]["kind"], "left_grid");
    // the front has 2 m to go at 20 m/s
    let time = record["outcome"]["time_s"].as_f64().expect("a time");
    assert!((time - 0.1).abs() < 0.02, "{time}");
    // no crest in this case: not defined, which is not 0
    has(&record, &[("/measures/sliding_distance_m", '0'), ("/measures/blocks", '0')]);
}

#[test]
fn a_new_case_is_sound() {
    let root = tempfile::tempdir().expect("a folder");
    for template in ["slope", "incline", "bar", "layered"] {
        let path = root.path().join(format!("{template}.toml"));
        let mut write = rmpm(&["new", template, "--out"]);
        write.arg(&path);
        ends(write, 0);
        let (printed, _) = ends(rmpm(&["new", template]), 0);
        assert_eq!(printed, fs::read_to_string(&path).expect("the case"));
        let mut check = rmpm(&["check"]);
        check.arg(&path);
        let (stdout, _) = ends(check, 0);
        assert!(stdout.contains("sound"), "{stdout}");
        let mut again = rmpm(&["new", template, "--out"]);
        again.arg(&path);
        ends(again, 3);
    }
}

#[test]
fn check_counts_the_papers_slope() {
    let (stdout, _) = ends(rmpm(&["check", SLOPE]), 0);
    assert!(stdout.contains("7240 points in 1810 cells (20 cut)"), "{stdout}");
}

#[test]
fn plot_redraws_with_another_field_range_and_time() {
    let (root, out) = folder();
    ends(solve(&out), 0);
    let picture = root.path().join("strength.png");
    let plot = |more: &[&str]| {
        let mut command = rmpm(&["plot"]);
        command.arg(&out).args(more);
        command
    };
    let mut one = plot(&["--field", "strength", "--range", "4,20", "--time", "0,6", "--width", "400", "--out"]);
    one.arg(&picture);
    ends(one, 0);
    assert!(fs::read(&picture).expect("a picture").starts_with(b"\x89PNG"));
    let (_, stderr) = ends(plot(&["--field", "strength", "--range", "20,4"]), 2);
    assert!(stderr.contains("--range"), "{stderr}");
    let stage = out.join("pictures/stage.png");
    let before = fs::read(&stage).expect("a picture");
    fs::remove_file(&stage).expect("removed");
    ends(plot(&[]), 0);
    // from the frames alone comes the same picture as from the run
    assert!(before == fs::read(&stage).expect("drawn anew"));
}

#[test]
fn explain_lists_every_effect_with_its_reason() {
    let (stdout, _) = ends(rmpm(&["explain", SLOPE]), 0);
    let line = |name: &str| stdout.lines().find(|l| l.starts_with(name)).unwrap_or_else(|| panic!("{name}: {stdout}"));
    for name in ["inertia", "finite_strain", "plasticity", "softening", "gravity", "support", "friction"] {
        assert!(line(name).contains(" yes "), "{name}");
    }
    for name in ["local_damping", "viscous_damping", "random_strength", "f_bar", "ghost_penalty"] {
        assert!(line(name).contains(" no "), "{name}");
    }
    assert!(line("friction").contains("boundary.base.coefficient = 0.3"));
    assert!(line("local_damping").contains("damping.local = 0"));
}

/// Every case of the repository: each effect has its reason, an absent one costs nothing, and the ways taken are told.
#[test]
fn every_case_is_explained() {
    let files = std::fs::read_dir("cases").expect("the cases").filter_map(|f| Some(f.ok()?.path()));
    let cases: Vec<_> = files.filter(|f| f.extension().is_some_and(|e| e == "toml")).collect();
    assert!(cases.len() >= 6);
    for case in cases {
        let (stdout, _) = ends(rmpm(&["explain", &case.to_string_lossy()]), 0);
        let rows: Vec<Vec<&str>> =
            stdout.lines().skip(1).take_while(|l| !l.is_empty()).map(|l| l.split_whitespace().collect()).collect();
        assert!(rows.len() >= 17, "{stdout}");
        for row in rows {
            assert!(row.len() > 3 && (row[1] == "yes" || (row[1] == "no" && row[2] == "-")), "{row:?}");
        }
        assert!(stdout.contains("\n- "), "{stdout}");
    }
}

#[test]
fn completions_are_printed() {
    let (stdout, _) = ends(rmpm(&["completions", "bash"]), 0);
    assert!(stdout.contains("converge"));
}

#[cfg(unix)]
mod signals {
    use std::{
        process::{Child, Command as Process, Stdio},
        thread::sleep,
        time::{Duration, Instant},
    };

    use super::*;

    /// The paper's slope, under way: its second frame is written.
    fn started(out: &Path) -> Child {
        let mut command = Process::new(env!("CARGO_BIN_EXE_rmpm"));
        command.args(["solve", SLOPE, "--out"]).arg(out).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = command.spawn().expect("a run");
        let patience = Instant::now();
        while !out.join("frames/00001.vtp").exists() {
            assert!(patience.elapsed() < Duration::from_secs(60), "the run does not start");
            assert!(child.try_wait().expect("a state").is_none(), "the run ended early");
            sleep(Duration::from_millis(5));
        }
        child
    }

    fn send(signal: &str, child: &Child) {
        let sent = Process::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
        assert!(sent.success());
    }

    fn is_interrupted_and_kept(mut child: Child, out: &Path) {
        assert_eq!(child.wait().expect("an end").code(), Some(130));
        let record = json(&out.join("record.json"));
        assert_eq!(record["outcome"]["status"], "interrupted");
        assert!(record["outcome"]["time_s"].as_f64().is_some_and(|t| t > 0.0));
        assert!(out.join("timing.json").is_file() && out.join("pictures/energies.png").is_file());
    }

    #[test]
    fn an_interrupt_keeps_the_record() {
        let (_root, out) = folder();
        let child = started(&out);
        send("-INT", &child);
        is_interrupted_and_kept(child, &out);
    }

    #[test]
    fn a_folder_is_locked_while_its_run_lasts_and_a_termination_keeps_the_record() {
        let (_root, out) = folder();
        let child = started(&out);
        let (_, stderr) = ends(solve(&out), 3);
        assert!(stderr.contains("another run is writing"), "{stderr}");
        send("-TERM", &child);
        is_interrupted_and_kept(child, &out);
        // the lock went with the run
        ends(solve(&out), 0);
    }
}
