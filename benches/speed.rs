//! The explicit step against the scalar loop, in one run.
//!
//! Everything that the paper's slope calls for is on: MUSL, softening, friction, gravity, a
//! roller, the automatic time step and the sorting of the points. Solver and loop take turns in
//! short repeats (A B A B ...), so that what else the machine does falls on both. Printed are
//! million particle-steps per CPU second, best of the repeats, and the median of the paired
//! ratios solver / loop.
//!
//! `cargo bench --bench speed` runs all; `-- --profile LAW POINTS STEPS SHAPE` takes bare steps of
//! the solver (`hencky` or `rate`, `coarse` or `fine`) for a profiler, `-- --quick` halves the work.
//! A second table has the wider shape functions against the bilinear ones.

mod common;
mod scalar;

use common::{Clock, FINE, SLOPE, advance, median, simulation, yielded};
use rmpm::sim::Simulation;
use scalar::{Hencky, Law, Rate, Scalar};

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    match args.first().map(String::as_str) {
        Some("--profile") => profile(&args[1..]),
        Some("--quick") => all(6),
        _ => all(12),
    }
}

fn all(pairs: usize) {
    println!("million particle-steps per second of {}", Clock::start().name());
    println!(
        "{:<8}{:>9}{:>9}{:>9}{:>9}{:>16}{:>10}{:>14}",
        "law", "points", "solver", "loop", "best", "median (range)", "yielded", "bytes/point"
    );
    for size in [COARSE, DENSE] {
        compare::<Hencky>("hencky", size, pairs);
        compare::<Rate>("rate", size, pairs);
    }
    println!(
        "\n{:<10}{:>9}{:>9}{:>9}{:>18}{:>14}",
        "shape", "points", "rate", "linear", "median (range)", "bytes/point"
    );
    for size in [COARSE, DENSE] {
        for shape in ["bspline", "gimp", "gimp_wide"] {
            compare_shape(shape, size, pairs);
        }
    }
}

/// Wider shape functions against the bilinear ones, with the Hencky law, in turns.
fn compare_shape(shape: &str, size: Size, pairs: usize) {
    let mut sims = [shape, "linear"].map(|s| solver("hencky", s, size));
    let points = sims[0].body.len();
    let work = (size.steps * points) as f64 * 1e-6;
    let mut rates = [Vec::new(), Vec::new()];
    for _ in 0..pairs {
        for (sim, rates) in sims.iter_mut().zip(&mut rates) {
            let clock = Clock::start();
            advance(sim, size.steps);
            rates.push(work / clock.seconds());
        }
    }
    let ratios: Vec<f64> = rates[0].iter().zip(&rates[1]).map(|(a, b)| a / b).collect();
    let [low, high] = range(&ratios);
    let [rate, linear] = rates.map(|r| range(&r)[1]);
    println!(
        "{shape:<10}{points:>9}{rate:>9.2}{linear:>9.2}{:>18}{:>14.0}",
        format!("{:.2} ({low:.2}-{high:.2})", median(&ratios)),
        sims[0].bytes() as f64 / points as f64,
    );
}

/// A size of the problem.
#[derive(Clone, Copy)]
struct Size {
    /// Overrides of the case file.
    keys: &'static [&'static str],
    cell: f64,
    /// Ramp of gravity (s), and the time at which measuring starts (s).
    ramp: f64,
    start: f64,
    /// Step of the scalar loop (s), and steps in a repeat.
    dt: f64,
    steps: usize,
}

/// 7,240 points, after the onset of failure.
const COARSE: Size = Size { keys: &[], cell: 0.25, ramp: 5.0, start: 6.0, dt: 0.002, steps: 150 };
/// 198,660 points with gravity at once.
const DENSE: Size = Size {
    keys: &["grid.cell=5/105", "gravity.schedule=at_once"],
    cell: FINE,
    ramp: 0.0,
    start: 0.25,
    dt: 0.0004,
    steps: 8,
};

fn solver(law: &str, shape: &str, size: Size) -> Simulation {
    let chosen = [format!("solver.kinematics={law}"), format!("solver.shape={shape}")];
    let keys: Vec<&str> = size.keys.iter().copied().chain(chosen.iter().map(String::as_str)).collect();
    let mut sim = simulation(SLOPE, &keys);
    while sim.time < size.start {
        advance(&mut sim, 1);
    }
    sim
}

fn bare_loop<L: Law>(size: Size) -> Scalar<L> {
    let mut slope = Scalar::paper_slope(size.cell, 2);
    slope.ramp = size.ramp;
    slope.pic_rate = 0.5;
    while slope.time < size.start {
        slope.step(size.dt);
    }
    slope
}

fn compare<L: Law>(name: &str, size: Size, pairs: usize) {
    let (mut sim, mut slope) = (solver(name, "linear", size), bare_loop::<L>(size));
    let points = sim.body.len();
    assert_eq!(points, slope.points());
    let work = (size.steps * points) as f64 * 1e-6;
    let mut rates = [Vec::new(), Vec::new()];
    for _ in 0..pairs {
        let clock = Clock::start();
        advance(&mut sim, size.steps);
        rates[0].push(work / clock.seconds());
        let clock = Clock::start();
        for _ in 0..size.steps {
            slope.step(size.dt);
        }
        rates[1].push(work / clock.seconds());
    }
    let ratios: Vec<f64> = rates[0].iter().zip(&rates[1]).map(|(a, b)| a / b).collect();
    let [low, high] = range(&ratios);
    let best = rates.map(|r| range(&r)[1]);
    println!(
        "{name:<8}{points:>9}{:>9.2}{:>9.2}{:>9.3}  {:>16}{:>10}{:>14.0}",
        best[0],
        best[1],
        best[0] / best[1],
        format!("{:.2} ({low:.2}-{high:.2})", median(&ratios)),
        format!("{:.2}/{:.2}", yielded(&sim), slope.yielded()),
        sim.bytes() as f64 / points as f64,
    );
}

fn range(sample: &[f64]) -> [f64; 2] {
    sample.iter().fold([f64::MAX, f64::MIN], |[a, b], &v| [a.min(v), b.max(v)])
}

fn profile(args: &[String]) {
    let get = |k: usize, other: &'static str| args.get(k).cloned().unwrap_or(other.to_owned());
    let size = if get(1, "coarse") == "fine" { DENSE } else { COARSE };
    let mut sim = solver(&get(0, "hencky"), &get(3, "linear"), size);
    let steps = get(2, "2000").parse().unwrap_or(2000);
    let clock = Clock::start();
    advance(&mut sim, steps);
    let rate = (steps * sim.body.len()) as f64 * 1e-6 / clock.seconds();
    println!("{rate:.2} million particle-steps per second, sorts {}, bits {:016x}", sim.work.sorts, bits(&sim));
}

/// A hash (FNV-1a) of the positions and velocities: equal for equal bits.
fn bits(sim: &Simulation) -> u64 {
    let s = sim.snapshot();
    let values = s.position.iter().chain(&s.velocity).flatten();
    values.fold(0xcbf2_9ce4_8422_2325, |hash, v| (hash ^ v.to_bits()).wrapping_mul(0x0100_0000_01b3))
}
