//! A scene without an effect executes the instructions of code that never had it.
//!
//! The elastic slope on smooth supports is stepped by the library, from its case, and by a loop
//! written out below: the same public kernels, but gravity with its work and rollers in place, no
//! list of effects, no books of the others, no control of the time step. Instructions are counted by valgrind
//! (callgrind) in processes of their own, over N and 2 N steps: the difference is N steps without
//! what comes before and after. The counts may differ by 2 %. Below are the counts of the whole
//! slope and of the scalar loop, and what each effect adds.
//!
//! `cargo bench --bench absent`; without valgrind it says so and passes.

mod common;
mod scalar;

use std::process::ExitCode;

use common::{SLOPE, advance, count, simulation};
use rmpm::{
    assembly::{Scatter, Scratch, Strain},
    body::Body,
    math::simd::FpPath,
    nodes::Nodes,
    space::{Grid, Linear, grid::Side},
    transfer::{Carrier, Push, Transfer},
};
use scalar::{Hencky, Law, Rate, Scalar};

/// Largest relative difference between scene and written-out loop.
const ALLOWED: f64 = 0.02;
const DT: f64 = 0.004;
const GRAVITY: [f64; 2] = [0.0, -9.81];
/// Steps of the short run; the long one has twice as many.
const STEPS: usize = 150;

/// The slope without strength, friction, damping, and PIC.
const BARE: [&str; 7] = [
    "grid.cell=0.5",
    "gravity.schedule=at_once",
    "explicit.time_step=0.004",
    "explicit.pic_rate=0",
    "boundary.base=roller",
    "boundary.left=roller",
    "material.clay.law=elastic",
];
/// The slope as it is, with gravity at once.
const WHOLE: [&str; 3] = ["grid.cell=0.5", "gravity.schedule=at_once", "explicit.time_step=0.004"];

/// What can be counted: a name and the overrides of the case; without overrides, a loop.
const SCENES: [(&str, &[&str], &[&str]); 8] = [
    ("bare", &BARE, &[]),
    ("bare + local damping", &BARE, &["damping.local=1e-9"]),
    ("bare + viscous damping", &BARE, &["damping.viscous=1e-9"]),
    ("bare + fixed right side", &BARE, &["boundary.right=fixed"]),
    ("whole slope", &WHOLE, &[]),
    ("whole, rate law", &WHOLE, &["solver.kinematics=rate"]),
    ("whole, jittered strength", &WHOLE, &["jitter.strength=0.0005"]),
    ("whole, automatic step", &["grid.cell=0.5", "gravity.schedule=at_once"], &[]),
];
/// Instructions per particle-step of the scalar loop, the yardstick of `speed`.
const PINNED: [(&str, f64); 2] = [("scalar hencky", 532.0), ("scalar rate", 411.4)];
const WRITTEN_OUT: &str = "written out";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    match args.as_slice() {
        [flag, name, steps] if flag == "--count" => {
            work(name, steps.parse().unwrap_or(STEPS));
            ExitCode::SUCCESS
        }
        _ => compare(),
    }
}

/// The work that is counted.
fn work(name: &str, steps: usize) {
    match name {
        "written out" => written_out(steps),
        "scalar hencky" => scalar_loop::<Hencky>(steps),
        "scalar rate" => scalar_loop::<Rate>(steps),
        _ => {
            let (_, keys, more) = SCENES.iter().find(|(n, ..)| *n == name).expect("a scene of that name");
            advance(&mut simulation(SLOPE, &[*keys, *more].concat()), steps);
        }
    }
}

fn scalar_loop<L: Law>(steps: usize) {
    let mut slope = Scalar::<L>::paper_slope(0.5, 2);
    slope.ramp = 0.0;
    slope.pic_rate = 0.5;
    for _ in 0..steps {
        slope.step(DT);
    }
}

/// The bare slope without the library's lists: what a program would be that has nothing else.
fn written_out(steps: usize) {
    // the body of the scene, which is stepped by hand
    let mut body = simulation(SLOPE, &BARE).body;
    let grid = Grid { origin: [0.0, 0.0], h: 0.5, cells: [120, 14] };
    let mut nodes = Nodes::new(grid);
    let mut scratch = Box::<Scratch<4>>::default();
    let mut sorted = 0;
    for _ in 0..steps {
        hand_step(&mut body, &mut nodes, &mut scratch, FpPath::best());
        // points that have left their cells are put in order by the library's rule
        let runs = scratch.runs.len();
        if sorted == 0 {
            sorted = runs;
        } else if runs > sorted + sorted / 4 + 8 {
            body.sort(&grid);
            sorted = 0;
        }
    }
}

fn hand_step(body: &mut Body, nodes: &mut Nodes, scratch: &mut Scratch<4>, path: FpPath) {
    nodes.begin();
    path.run(Scatter { scratch, body, nodes, cells: None, stretch: 0..body.len(), shape: Linear });
    std::hint::black_box(move_nodes(nodes));
    body.apart(|body, part| {
        let pass = Push { scratch, body, part, nodes, dt: DT, remap: true, shape: Linear };
        Carrier::new(Transfer::Flip { pic_rate: 0.0 }).push(pass, path).expect("points stay");
    });
    let n = nodes.count;
    for axis in 0..2 {
        let Nodes { strain_velocity, momentum, mass, .. } = &mut *nodes;
        for (v, (p, m)) in strain_velocity[axis][..n].iter_mut().zip(momentum[axis][..n].iter().zip(&mass[..n])) {
            *v = p / m;
        }
    }
    roll(nodes, |n| &mut n.strain_velocity);
    body.apart(|body, part| {
        let pass = Strain { scratch, body, part, nodes, cells: None, dt: DT, shape: Linear };
        path.run(pass).expect("points keep their shape");
    });
    body.commit();
}

/// v_old = p / m, f += m g, v = v_old + dt f / m, rollers; room for the remap: loop by loop as the
/// library has them, since what is counted is absence and not the fusing of what is there.
/// Returned are the work and the impulse of gravity, which belong to a gravity that keeps its
/// balance.
fn move_nodes(nodes: &mut Nodes) -> [f64; 3] {
    let n = nodes.count;
    let Nodes { old_velocity, velocity, momentum, force, mass, .. } = &mut *nodes;
    for axis in 0..2 {
        for (old, (p, m)) in old_velocity[axis][..n].iter_mut().zip(momentum[axis][..n].iter().zip(&mass[..n])) {
            *old = p / m;
        }
    }
    for axis in 0..2 {
        for (f, m) in force[axis][..n].iter_mut().zip(&mass[..n]) {
            *f += m * GRAVITY[axis];
        }
    }
    for axis in 0..2 {
        let known = force[axis][..n].iter().zip(&mass[..n]).zip(&old_velocity[axis][..n]);
        for (new, ((f, m), old)) in velocity[axis][..n].iter_mut().zip(known) {
            *new = old + DT * f / m;
        }
    }
    momentum.iter_mut().for_each(|p| p[..n].fill(0.0));
    roll(nodes, |n| &mut n.velocity);
    account(nodes)
}

fn account(nodes: &Nodes) -> [f64; 3] {
    let n = nodes.count;
    let mass: f64 = nodes.mass[..n].iter().sum();
    let [px, py] =
        [0, 1].map(|axis| nodes.mass[..n].iter().zip(&nodes.velocity[axis]).map(|(m, v)| m * v).sum::<f64>());
    [(GRAVITY[0] * px + GRAVITY[1] * py) * DT, GRAVITY[0] * mass * DT, GRAVITY[1] * mass * DT]
}

fn roll(nodes: &mut Nodes, columns: impl Fn(&mut Nodes) -> &mut [Vec<f64>; 2]) {
    for side in [Side::Left, Side::Base] {
        for k in 0..nodes.side(side).len() {
            let s = nodes.side(side)[k] as usize;
            columns(nodes)[side.axis()][s] = 0.0;
        }
    }
}

fn compare() -> ExitCode {
    if !count::possible() {
        return ExitCode::SUCCESS;
    }
    let points = simulation(SLOPE, &BARE).body.len() as f64;
    let per_point = |name: &str| -> f64 {
        let [short, long] = [STEPS, 2 * STEPS].map(|n| count::events(&["--count", name, &n.to_string()], &[])[0]);
        (long - short) / (STEPS as f64 * points)
    };
    println!("instructions per particle-step, {points} points, path {:?}", FpPath::best());
    let hand = per_point(WRITTEN_OUT);
    println!("{:<28}{hand:>9.1}", WRITTEN_OUT);
    let mut bare = f64::NAN;
    for (name, ..) in SCENES {
        let count = per_point(name);
        if name == "bare" {
            bare = count;
        }
        println!("{name:<28}{count:>9.1}   {:+.2} % of bare", 100.0 * (count / bare - 1.0));
    }
    let mut moved = false;
    for (name, pinned) in PINNED {
        let count = per_point(name);
        moved |= (count / pinned - 1.0).abs() > ALLOWED;
        println!("{name:<28}{count:>9.1}   pinned at {pinned}");
    }
    if moved {
        println!("the yardstick itself has moved: the scalar loop or its compiler has changed");
    }
    let excess = bare / hand - 1.0;
    println!(
        "scene without effects over the written-out loop: {:+.2} % (allowed {:.0} %)",
        100.0 * excess,
        100.0 * ALLOWED
    );
    if excess <= ALLOWED && !moved { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
