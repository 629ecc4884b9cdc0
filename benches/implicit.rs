//! What a Newton iteration of the implicit scheme costs on the paper's slope: the assembly a point,
//! and the equations.
//!
//! Best of the steps of a run, by the wall clock inside the integrator: what else the machine does
//! only adds. `cargo bench --bench implicit`; `-- --large` runs 100,000 cells instead.

mod common;

use common::{SLOPE, simulation, yielded};
use rmpm::{sim::Simulation, work::Work};

fn main() {
    let large = std::env::args().any(|a| a == "--large");
    println!(
        "{:<34}{:>8}{:>8}{:>10}{:>14}{:>16}{:>14}{:>10}",
        if large { "100,000 cells, 400,000 points" } else { "1810 cells, 7,240 points" },
        "steps",
        "it/step",
        "yielded",
        "assembly us/pt",
        "equations ms/it",
        "rest ms/it",
        "LU share"
    );
    let rough = ["boundary.base.kind=fixed", "material.clay.strength_measure=kirchhoff"];
    let slip = ["end.time=40"];
    if large {
        let fine = [&rough[..], &["grid.cell=5/149", "implicit.symmetric=direct"]].concat();
        measure("rough base, L L^T", &fine, 0.02, 3);
        let short = [&fine[..3], &["implicit.regime=newmark", "implicit.time_step=0.002"]].concat();
        measure("the same, steps of 2 ms, auto", &short, 0.002, 3);
        println!("memory at its peak: {}", peak());
        return;
    }
    measure("rough base, Kirchhoff (symmetric)", &rough, 3.0, 60);
    let short = [&rough[..], &["implicit.regime=newmark", "implicit.time_step=0.01"]].concat();
    for way in ["direct", "pcg", "auto"] {
        let way = format!("implicit.symmetric={way}");
        measure(&format!("steps of 10 ms, {way}"), &[&short[..], &[way.as_str()]].concat(), 1.0, 20);
    }
    measure("frictional base, Cauchy, ramp", &slip, 3.0, 60);
    measure("frictional base, Cauchy, sliding", &slip, 6.0, 60);
    measure("the same, b_bar", &["solver.locking=b_bar"], 4.0, 20);
    measure("the same, gimp", &["solver.shape=gimp"], 4.0, 20);
    measure("the same, gimp_wide", &["solver.shape=gimp_wide"], 4.0, 10);
}

/// Most memory that this process has held, where the system tells.
fn peak() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.map_or("unknown".into(), |l| l.trim().to_owned())
}

/// Seconds of the phases, and the counters, of the steps so far.
struct Spent {
    assembly: f64,
    equations: f64,
    all: f64,
    work: Work,
}

impl Spent {
    fn of(sim: &Simulation) -> Self {
        let phases = sim.phases();
        let of = |name: &str| phases.iter().find(|(n, _)| *n == name).map_or(0.0, |p| p.1);
        let all = phases.iter().map(|p| p.1).sum();
        Spent { assembly: of("assembly"), equations: of("equations"), all, work: sim.work.clone() }
    }
}

/// Runs to `from` (s), then `steps` steps, and prints the cheapest of them.
fn measure(name: &str, keys: &[&str], from: f64, steps: usize) {
    let mut sim = simulation(SLOPE, &[&["solver.scheme=implicit"], keys].concat());
    while sim.time < from {
        sim.step(f64::INFINITY).unwrap_or_else(|e| panic!("{e}"));
    }
    let (mut assembly, mut equations, mut rest) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
    let start = Spent::of(&sim);
    for _ in 0..steps {
        let before = Spent::of(&sim);
        sim.step(f64::INFINITY).unwrap_or_else(|e| panic!("{e}"));
        let after = Spent::of(&sim);
        let blocks = (after.work.law_blocks - before.work.law_blocks) as f64;
        let iterations = (after.work.newton_iterations - before.work.newton_iterations) as f64;
        // every evaluation walks over all blocks
        let points = blocks * sim.body.len() as f64 / (sim.body.len() as f64 / 32.0).ceil();
        assembly = assembly.min((after.assembly - before.assembly) / points);
        equations = equations.min((after.equations - before.equations) / iterations);
        let other =
            (after.all - before.all) - (after.assembly - before.assembly) - (after.equations - before.equations);
        rest = rest.min(other / iterations);
    }
    let end = Spent::of(&sim);
    let newton = (end.work.newton_iterations - start.work.newton_iterations) as f64;
    let lu = (end.work.lu_factorisations - start.work.lu_factorisations) as f64 / newton;
    println!(
        "{name:<34}{steps:>8}{:>8.1}{:>9.0}%{:>14.2}{:>16.2}{:>14.2}{:>9.0}%",
        newton / steps as f64,
        100.0 * yielded(&sim),
        assembly * 1e6,
        equations * 1e3,
        rest * 1e3,
        100.0 * lu
    );
}
