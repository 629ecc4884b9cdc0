//! What each effect adds: instructions, bytes moved and bytes held, a point and step.
//!
//! Each row is the slope with one thing more than the row that it is compared with. Instructions, and lines of 64 bytes
//! that the first-level cache takes in, are counted by valgrind (callgrind) in processes of their own, over N and
//! 2 N steps; bytes held are those of the points, nodes and matrices. Counts are of executed code, so they repeat.
//! Implicit rows are steps of small increments, two to three iterations each.
//!
//! `cargo bench --bench effects`; without valgrind it says so and passes.

mod common;

use std::process::ExitCode;

use common::{SLOPE, advance, count, simulation};

/// Bytes of a line of the cache.
const LINE: f64 = 64.0;

/// A scene: its name, the row that it is compared with, and the overrides beside those of its scheme.
type Row = (&'static str, Option<&'static str>, &'static [&'static str]);

/// Keys of all explicit rows: elastic soil on smooth supports, no damping, pure FLIP.
const EXPLICIT: &[&str] = &[
    "grid.cell=0.5",
    "gravity.schedule=at_once",
    "explicit.time_step=0.004",
    "boundary.base=roller",
    "boundary.left=roller",
];
/// Steps of the short run of an explicit row.
const EXPLICIT_STEPS: usize = 120;

/// Keys of all implicit rows.
const IMPLICIT: &[&str] = &[
    "grid.cell=0.5",
    "solver.scheme=implicit",
    "implicit.regime=quasi_static",
    "implicit.time_step=0.01",
    "boundary.base=roller",
    "boundary.left=roller",
];
const IMPLICIT_STEPS: usize = 12;

const ELASTIC: &str = "material.clay.law=elastic";
const PERFECT: [&str; 2] = ["material.clay.softening_modulus=0", "material.clay.residual_cohesion=20"];

/// Rows of the explicit scheme.
const EXPLICIT_ROWS: &[Row] = &[
    ("elastic, rate law", None, &[ELASTIC, "solver.kinematics=rate"]),
    ("+ finite strain by logarithm", Some("elastic, rate law"), &[ELASTIC]),
    ("+ gravity ramp instead of at once", Some("+ finite strain by logarithm"), &[ELASTIC, "gravity.schedule=ramp"]),
    ("+ local damping", Some("+ finite strain by logarithm"), &[ELASTIC, "damping.local=1e-9"]),
    ("+ viscous damping", Some("+ finite strain by logarithm"), &[ELASTIC, "damping.viscous=1e-9"]),
    ("+ friction", Some("+ finite strain by logarithm"), &[ELASTIC, FRICTION]),
    ("+ contact separation", Some("+ friction"), &[ELASTIC, OPENING]),
    ("+ load", Some("+ finite strain by logarithm"), &[ELASTIC, "load=[{box=[[0, 4], [9, 5]], force=[0, -1e-6]}]"]),
    ("+ drive", Some("+ finite strain by logarithm"), &[ELASTIC, "drive=[{box=[[0, 0], [1, 1]], velocity_x=0}]"]),
    ("+ plasticity", Some("+ finite strain by logarithm"), &PERFECT),
    ("+ softening", Some("+ plasticity"), &[]),
    ("+ random strength", Some("+ softening"), &["jitter.strength=0.0005"]),
    ("+ b_bar", Some("+ softening"), &["solver.locking=b_bar"]),
    ("+ gimp", Some("+ softening"), &["solver.shape=gimp"]),
    ("+ gimp_wide", Some("+ softening"), &["solver.shape=gimp_wide"]),
    ("+ bspline", Some("+ softening"), &["solver.shape=bspline"]),
    ("+ apic", Some("+ softening"), &["solver.transfer=apic"]),
    ("+ xpic, order 3", Some("+ softening"), &["solver.transfer=xpic", "solver.xpic_order=3"]),
    ("+ fracture energy", Some("+ softening"), &[ENERGY, LENGTH]),
    ("+ nonlocal softening", Some("+ softening"), &["material.clay.regularisation=nonlocal", LENGTH]),
];
const ENERGY: &str = "material.clay.regularisation=fracture_energy";
const LENGTH: &str = "material.clay.reference_length=1";
const FRICTION: &str = "boundary.base={kind=\"friction\",coefficient=0.3,separation=false}";
const OPENING: &str = "boundary.base={kind=\"friction\",coefficient=0.3,separation=true}";

/// Rows of the implicit scheme.
const IMPLICIT_ROWS: &[Row] = &[
    ("elastic, small strain", None, &[ELASTIC, "solver.kinematics=small"]),
    ("+ finite strain", Some("elastic, small strain"), &[ELASTIC]),
    ("+ inertia", Some("+ finite strain"), &[ELASTIC, "implicit.regime=newmark"]),
    ("+ friction (unsymmetric)", Some("+ finite strain"), &[ELASTIC, FRICTION]),
    ("+ plasticity and softening", Some("+ finite strain"), &[]),
    ("+ b_bar", Some("+ finite strain"), &[ELASTIC, "solver.locking=b_bar"]),
    ("+ ghost penalty", Some("+ finite strain"), &[ELASTIC, "implicit.ghost_stiffness=0.01"]),
    ("+ gimp", Some("+ finite strain"), &[ELASTIC, "solver.shape=gimp"]),
    ("+ bspline", Some("+ finite strain"), &[ELASTIC, "solver.shape=bspline"]),
];

/// What a row costs, a point and step.
#[derive(Clone, Copy)]
struct Cost {
    instructions: f64,
    moved: f64,
    held: f64,
}

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    match args.as_slice() {
        [flag, scheme, name, steps] if flag == "--count" => {
            advance(&mut scene(scheme, name), steps.parse().unwrap_or(1));
        }
        _ if count::possible() => {
            table("explicit", EXPLICIT_ROWS, EXPLICIT_STEPS);
            table("implicit", IMPLICIT_ROWS, IMPLICIT_STEPS);
        }
        _ => {}
    }
    ExitCode::SUCCESS
}

fn scene(scheme: &str, name: &str) -> rmpm::sim::Simulation {
    let (common, rows) = if scheme == "implicit" { (IMPLICIT, IMPLICIT_ROWS) } else { (EXPLICIT, EXPLICIT_ROWS) };
    let (.., keys) = rows.iter().find(|(n, ..)| *n == name).expect("a row of that name");
    simulation(SLOPE, &[common, keys].concat())
}

fn table(scheme: &str, rows: &[Row], steps: usize) {
    let points = scene(scheme, rows[0].0).body.len() as f64;
    println!("\n{scheme}, {points} points: a point and step, and what it adds");
    println!("{:<36}{:>13}{:>9}{:>13}{:>9}{:>13}{:>9}", "", "instructions", "", "bytes moved", "", "bytes held", "");
    let mut known: Vec<(&str, Cost)> = Vec::new();
    for (name, than, _) in rows {
        let cost = cost(scheme, name, steps, points);
        let before = than.and_then(|than| known.iter().find(|(n, _)| *n == than)).map(|(_, c)| *c);
        let added = |f: fn(&Cost) -> f64| before.map_or(String::new(), |b| format!("{:+.1}", f(&cost) - f(&b)));
        println!(
            "{name:<36}{:>13.1}{:>9}{:>13.1}{:>9}{:>13.1}{:>9}",
            cost.instructions,
            added(|c| c.instructions),
            cost.moved,
            added(|c| c.moved),
            cost.held,
            added(|c| c.held)
        );
        known.push((name, cost));
    }
}

fn cost(scheme: &str, name: &str, steps: usize, points: f64) -> Cost {
    // valgrind 3.19 does not know an instruction of the tangent on the wider paths
    let path = if scheme == "implicit" { "baseline" } else { "avx2" };
    let run = |n: usize| count::events_on(path, &["--count", scheme, name, &n.to_string()], &["--cache-sim=yes"]);
    let (short, long) = (run(steps), run(2 * steps));
    let per_point = |k: usize| (long[k] - short[k]) / (steps as f64 * points);
    let mut sim = scene(scheme, name);
    advance(&mut sim, 2);
    // reads and writes that miss the first level
    Cost { instructions: per_point(0), moved: LINE * (per_point(4) + per_point(5)), held: sim.bytes() as f64 / points }
}
