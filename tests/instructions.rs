//! A guard of the speed that no clock can give: instructions of a few set-ups, counted by valgrind (callgrind) in
//! processes of their own, against the figures in `tests/instructions.txt`, within 3 %.
//!
//! The counts belong to this profile, to a version of the compiler and to the AVX2 path, which valgrind offers whatever
//! the processor has beyond it; they stand in the file. With another compiler or profile the counts are printed and
//! not judged. `RMPM_RENEW=1 cargo test --test instructions` writes the file anew: read what has moved before it is committed.
//! Without valgrind, or without AVX2, it says so and passes.

#[path = "../benches/common/mod.rs"]
mod common;

use std::{fs, hint::black_box, process::ExitCode};

use common::{SLOPE, advance, count, simulation};
use rmpm::{
    field::{
        correlation::{Correlation, Family},
        generator::Scratch,
        map::Map,
        normals::Normals,
        squash::Squash,
        table::Lattice,
    },
    math::simd::FpPath,
};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/instructions.txt");
const RFEM: &str = include_str!("../cases/clay-slope-rfem.toml");

/// Relative change that is let pass: counts repeat to some 1e-5, and what a change of code moves at random, as where a
/// loop is inlined, stays below this.
const BAND: f64 = 0.03;

const EXPLICIT: [&str; 3] = ["grid.cell=0.5", "gravity.schedule=at_once", "explicit.time_step=0.004"];
const IMPLICIT: [&str; 4] =
    ["grid.cell=0.5", "solver.scheme=implicit", "gravity.schedule=at_once", "implicit.regime=newmark"];
const ROUGH: [&str; 2] = ["boundary.base.kind=fixed", "material.clay.strength_measure=kirchhoff"];

/// Steps of a case: those before, and those that are counted.
struct Steps(&'static str, &'static [&'static [&'static str]], [usize; 2]);

const STEPS: [(&str, Steps); 6] = [
    ("explicit, bilinear, Hencky", Steps(SLOPE, &[&EXPLICIT], [20, 60])),
    ("explicit, gimp", Steps(SLOPE, &[&EXPLICIT, &["solver.shape=gimp"]], [5, 20])),
    ("implicit, L L^T", Steps(SLOPE, &[&IMPLICIT, &ROUGH, &["implicit.symmetric=direct"]], [2, 4])),
    ("implicit, conjugate gradients", Steps(SLOPE, &[&IMPLICIT, &ROUGH, &["implicit.symmetric=pcg"]], [2, 4])),
    ("implicit, LU", Steps(SLOPE, &[&IMPLICIT], [2, 3])),
    ("RFEM", Steps(RFEM, &[&["grid.cell=0.5"]], [2, 4])),
];
const FIELD: &str = "field";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if let [flag, name] = args.as_slice()
        && flag == "--count"
    {
        work(name);
        return ExitCode::SUCCESS;
    }
    // libtest's options, as a name to look for: this is one test
    if args.iter().any(|a| a == "--list") || FpPath::best() == FpPath::BASELINE || !count::possible() {
        println!("instructions: not counted");
        return ExitCode::SUCCESS;
    }
    judge(&counts())
}

/// What is counted stands in [`counted`], and nothing else.
fn work(name: &str) {
    if let Some((_, Steps(text, keys, [before, steps]))) = STEPS.iter().find(|(n, _)| *n == name) {
        let mut sim = simulation(text, &keys.concat());
        advance(&mut sim, *before);
        counted(&mut || advance(&mut sim, *steps));
        return;
    }
    let correlation = Correlation { family: Family::Markov, theta: [5.0, 1.0] };
    let map = Squash::new(&correlation, &Lattice { cell: [0.25; 2], cells: [128, 128] }, [1, 1], 256).expect("a field");
    let (mut scratch, mut field) = (Scratch::default(), vec![0.0; 128 * 128]);
    let mut draw = |realisation| map.apply(&mut Normals::new(1, realisation, "clay", false), &mut scratch, &mut field);
    draw(0);
    counted(&mut || (1..6).for_each(&mut draw));
    black_box(&field);
}

/// callgrind counts while this runs.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
    black_box(());
}

fn counts() -> Vec<(&'static str, f64)> {
    let names = STEPS.iter().map(|(name, _)| *name).chain([FIELD]);
    let toggle = ["--toggle-collect=instructions::counted*"];
    names.map(|name| (name, count::events(&["--count", name], &toggle)[0])).collect()
}

/// Compiler and profile that counts belong to.
fn maker() -> String {
    let version = std::process::Command::new("rustc").arg("--version").output();
    let version = version.ok().and_then(|o| String::from_utf8(o.stdout).ok()).unwrap_or_default();
    format!("{}, {}", version.trim(), if cfg!(debug_assertions) { "dev" } else { "release" })
}

fn judge(counts: &[(&str, f64)]) -> ExitCode {
    let maker = maker();
    let stored = fs::read_to_string(FILE).unwrap_or_default();
    if std::env::var_os("RMPM_RENEW").is_some() {
        let lines = counts.iter().map(|(name, n)| format!("{n:.0} {name}\n"));
        fs::write(FILE, format!("{maker}\n{}", lines.collect::<String>())).expect("the figures can be written");
    }
    let known = |name: &str| -> Option<f64> {
        stored.lines().find_map(|l| l.split_once(' ').filter(|(_, n)| *n == name)?.0.parse().ok())
    };
    let same = stored.lines().next() == Some(&maker);
    let mut off = false;
    for (name, n) in counts {
        let change = known(name).map(|k| n / k - 1.0);
        off |= change.is_none_or(|c| c.abs() > BAND);
        println!("{n:>14.0} {name:<32}{:>8}", change.map_or("new".into(), |c| format!("{:+.2} %", 100.0 * c)));
    }
    if !same {
        println!("the stored figures are of another compiler or profile, and judge nothing: this is {maker}");
    } else if off {
        println!("more than {} % off: mend it, or renew {FILE} by RMPM_RENEW=1", 100.0 * BAND);
    }
    let renewed = std::env::var_os("RMPM_RENEW").is_some();
    if off && same && !renewed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}
