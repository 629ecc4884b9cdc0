//! Counting what a bench executes, by valgrind, in a process of its own.

use std::process::Command;

/// Whether valgrind is there; if not, says so.
pub fn possible() -> bool {
    let there = Command::new("valgrind").arg("--version").output().is_ok();
    if !there {
        println!("\n*** SKIPPED: valgrind is not installed; nothing was counted. ***\n");
    }
    there
}

/// The totals that callgrind collects while this program runs with `args`: instructions first, and with
/// `--cache-sim=yes` among the `options` data reads, data writes, then the misses of the first level: instructions,
/// reads, writes; and those of the last.
pub fn events(args: &[&str], options: &[&str]) -> Vec<f64> {
    events_on("avx2", args, options)
}

/// As [`events`], on an instruction path: valgrind knows none beyond AVX2.
pub fn events_on(path: &str, args: &[&str], options: &[&str]) -> Vec<f64> {
    let program = std::env::current_exe().expect("this program has a path");
    let output = Command::new("valgrind")
        .env("RMPM_FP_PATH", path)
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .args(options)
        .arg(program)
        .args(args)
        .output()
        .expect("valgrind starts");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{args:?}: {text}");
    let line = text.lines().find_map(|l| l.split_once("Collected :")).unwrap_or_else(|| panic!("no count in: {text}"));
    line.1.split_whitespace().map(|n| n.parse().unwrap_or_else(|e| panic!("{e} in {text}"))).collect()
}
