//! `rmpm converge` and `rmpm compare schemes` from outside: their tables, ladders and pictures.

mod support;

use std::fs;

use support::program::{SLOPE, coarse, ends, folder, has, json, rmpm};

#[test]
fn converge_leaves_table_and_pictures() {
    let (_root, out) = folder();
    let mut command = coarse("converge");
    command.args(["--runs", "2", "--jobs", "2", "--out"]).arg(&out);
    let (stdout, _) = ends(command, 0);
    assert!(stdout.contains("median r"), "{stdout}");
    let study = json(&out.join("converge.json"));
    let rows = study["rows"].as_array().expect("rows");
    // the mesh as it is, 20/29 of it, and 16 points a cell; then two more Courant numbers
    let points: Vec<u64> = rows.iter().filter_map(|r| r["points"].as_u64()).collect();
    assert_eq!(points.len(), 5);
    assert_eq!(points[2], 4 * points[0]);
    assert_eq!((points[3], points[4]), (points[0], points[0]));
    let axes: Vec<&str> =
        study["ladders"].as_array().expect("ladders").iter().filter_map(|l| l["axis"].as_str()).collect();
    assert_eq!(axes, ["mesh", "points", "time_step"]);
    for row in rows {
        assert_eq!(row["runs"].as_array().map(Vec::len), Some(2));
        has(row, &[("/sliding_distance_m/median", 'n'), ("/failed", 'n'), ("/censored", 'n')]);
    }
    for name in ["converge.png", "ladders.png", "shapes.png"] {
        assert!(fs::read(out.join(name)).expect(name).starts_with(b"\x89PNG"));
    }
}

/// The tip of an elastic column, whose exact place is known: a clean rate, of one run a level.
#[test]
fn converge_finds_the_rate_of_a_smooth_problem() {
    let (_root, out) = folder();
    let mut command = rmpm(&["converge", "cases/column.toml", "--quantity", "tip", "--quantity", "external"]);
    command.args(["--set", "grid.cell=6.25", "--meshes", "6.25,3.125,1.5625", "--out"]).arg(&out);
    let (stdout, _) = ends(command, 0);
    assert!(stdout.contains("converges at the rate"), "{stdout}");
    let study = json(&out.join("converge.json"));
    assert_eq!(study["ladders"].as_array().map(Vec::len), Some(2));
    let tip = &study["ladders"][0];
    assert_eq!((tip["quantity"].as_str(), tip["verdict"].as_str()), (Some("tip"), Some("clean")));
    // one run a level: nothing yields
    assert_eq!(tip["levels"][0]["runs"].as_u64(), Some(1));
    has(tip, &[("/rate/value", 'n'), ("/limit", 'n'), ("/uncertainty", 'n'), ("/rate_of_errors", 'n')]);
}

/// The same two fields on two meshes.
#[test]
fn converge_pairs_realisations() {
    let (_root, out) = folder();
    let mut command =
        rmpm(&["converge", "cases/random-slope.toml", "--set", "end.time=2", "--quantity", "max_displacement"]);
    command.args(["--set", "explicit.time_step=0.005", "--realisations", "3", "--meshes", "1,0.5", "--out"]).arg(&out);
    let (stdout, _) = ends(command, 0);
    assert!(stdout.contains("means over 3 realisations, differences of pairs"), "{stdout}");
    let study = json(&out.join("converge.json"));
    let value = |row: usize, k: usize| study["rows"][row]["runs"][k]["values"][0].as_f64().expect("a value");
    let paired = (0..3).map(|k| value(1, k) - value(0, k)).sum::<f64>() / 3.0;
    let difference = study["ladders"][0]["levels"][0]["difference"]["value"].as_f64().expect("a difference");
    // rounding of sums of three
    assert!((difference - paired).abs() <= 1e-14 * value(0, 0).abs(), "{difference} {paired}");
    let mut alone = rmpm(&["converge", SLOPE, "--realisations", "2", "--meshes", "--out"]);
    alone.arg(out.join("alone"));
    let (_, stderr) = ends(alone, 2);
    assert!(stderr.contains("no random field"), "{stderr}");
}

/// Cells of 1 m and a weaker clay, which slides.
#[test]
fn compare_schemes_leaves_tables_and_a_picture() {
    let (_root, out) = folder();
    let mut command = rmpm(&["compare", "schemes", SLOPE, "--set", "grid.cell=1"]);
    command.args(["--set", "material.clay.cohesion=16", "--runs", "2", "--sweep-runs", "1", "--dt", "0.04,0.08"]);
    command.arg("--out").arg(&out);
    let (stdout, _) = ends(command, 0);
    for words in ["equilibrium lost at", "first block", "CPU seconds to the end", "- Onset:", "- Cost to the end:"] {
        assert!(stdout.contains(words), "{words}: {stdout}");
    }
    let study = json(&out.join("compare.json"));
    let rows = study["rows"].as_array().expect("rows");
    let names: Vec<&str> = rows.iter().filter_map(|r| r["variant"].as_str()).collect();
    let all = ["explicit", "implicit, 0.04 s", "implicit, 0.08 s", "implicit, 0.04 s, hht"];
    assert_eq!(names[..4], all);
    // both solve the same equations; 5 %: the steps of 0.04 s and the looks at the crest
    let onset = |k: usize| rows[k]["figures"]["onset_kn_m3"]["median"].as_f64().expect("an onset");
    assert!((onset(0) / onset(1) - 1.0).abs() < 0.05, "{} and {}", onset(0), onset(1));
    let csv = fs::read_to_string(out.join("compare.csv")).expect("compare.csv");
    assert_eq!(csv.lines().count(), 1 + names.len());
    assert!(fs::read(out.join("compare.png")).expect("a picture").starts_with(b"\x89PNG"));
}

#[test]
fn compare_schemes_of_a_bar_leaves_out_what_a_bar_has_not() {
    let (_root, out) = folder();
    let bar = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/bar.toml");
    let mut command = rmpm(&["compare", "schemes", bar, "--dt", "0.05", "--sweep-runs", "0"]);
    command.arg("--out").arg(&out);
    let (stdout, _) = ends(command, 0);
    assert!(stdout.contains("starts in motion") && stdout.contains("- Displacement:"), "{stdout}");
    assert!(!stdout.contains("sliding distance") && !stdout.contains("onset"), "{stdout}");
}
