//! Same case, same bits: twice in a row, and on every instruction path.

mod support;

use std::process::Command;

use rmpm::math::simd::FpPath;
use support::{QUICK, SLOPE, advance, bits, digest, simulation, yielded};

/// 1500 steps, from rest through the failure.
fn through_failure(keys: &[&str]) -> rmpm::sim::Simulation {
    let mut sim = simulation(SLOPE, &[&QUICK, keys].concat());
    advance(&mut sim, 1500);
    assert!(yielded(&sim) > 0.3, "the slope has not failed");
    assert!(sim.work.sorts > 0, "the points were never sorted");
    sim
}

#[test]
fn two_runs_give_the_same_bits() {
    for keys in [&[][..], &["solver.kinematics=rate"], &["jitter.strength=0.01"], &["solver.shape=bspline"]] {
        let (a, b) = (through_failure(keys), through_failure(keys));
        assert!(bits(&a) == bits(&b), "{keys:?}");
        assert_eq!(a.work, b.work);
    }
}

#[test]
fn another_realisation_gives_other_bits() {
    let keys = ["jitter.strength=0.01", "jitter.realisation=1"];
    assert!(bits(&through_failure(&keys[..1])) != bits(&through_failure(&keys)));
}

/// The implicit scheme, from quasi-static through the loss of stability.
fn implicitly() -> rmpm::sim::Simulation {
    let keys = ["solver.scheme=implicit", "grid.cell=0.5", "implicit.time_step=0.05", "gravity.ramp_time=4"];
    let mut sim = simulation(SLOPE, &keys);
    advance(&mut sim, 150);
    assert!(!sim.events().is_empty(), "inertia was never brought in");
    sim
}

#[test]
fn the_implicit_scheme_gives_the_same_bits() {
    let (a, b) = (implicitly(), implicitly());
    assert!(bits(&a) == bits(&b));
    assert_eq!(a.work, b.work);
}

/// The processes of the paths print a digest each: of both laws, softening on both, and
/// of the wider shape functions, and of the transfers.
#[test]
fn every_instruction_path_gives_the_same_bits() {
    let best = digests_of_a_process(None);
    assert_eq!(best.len(), 7);
    for path in FpPath::all().map(|p| p.to_string()).filter(|p| *p != FpPath::best().to_string()) {
        assert_eq!(best, digests_of_a_process(Some(&path)), "{path}");
    }
}

/// Runs `helper` below in a process of its own, since a process chooses its path once.
fn digests_of_a_process(path: Option<&str>) -> Vec<String> {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", "helper_prints_digests", "--nocapture", "--test-threads=1"]);
    command.env("RMPM_PRINT_DIGESTS", "yes");
    command.env_remove("RMPM_FP_PATH");
    if let Some(path) = path {
        command.env("RMPM_FP_PATH", path);
    }
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains(&format!("on {}", path.unwrap_or("best"))), "{text}");
    text.lines().filter_map(|l| l.split_once("digest ")).map(|(_, d)| d.to_owned()).collect()
}

/// Does its work in the processes that `every_instruction_path_gives_the_same_bits` starts.
#[test]
fn helper_prints_digests() {
    if std::env::var_os("RMPM_PRINT_DIGESTS").is_none() {
        return;
    }
    println!("on {}", std::env::var("RMPM_FP_PATH").unwrap_or("best".to_owned()));
    let choices = [
        "solver.kinematics=hencky",
        "solver.kinematics=rate",
        "solver.shape=gimp",
        "solver.shape=gimp_wide",
        "solver.shape=bspline",
        "solver.transfer=apic",
        "solver.transfer=xpic",
    ];
    for choice in choices {
        println!("digest {:016x}", digest(&through_failure(&[choice])));
    }
}
