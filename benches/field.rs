//! What a realisation of a random field costs, and what it takes to set one up.
//!
//! CPU time of one thread, best of some repeats; the normals are drawn anew each time.
//! `cargo bench --bench field`.

mod common;

use common::Clock;
use rmpm::field::{
    correlation::{Correlation, Family},
    exact::Exact,
    generator::{Bound, Generator, Method, Scratch, Spec},
    map::Map,
    normals::Normals,
    squash::Squash,
    table::{Lattice, Table},
};

fn main() {
    println!("{:<42}{:>12}{:>14}{:>12}{:>12}", "generator", "cells", "set-up ms", "field ms", "ns a cell");
    plain([100, 20], 1.0, 400);
    plain([512, 512], 5.0, 20);
    plain([2048, 2048], 5.0, 5);
    exact([100, 20]);
    for theta in [1.0, 6.0, 48.0] {
        auto([100, 20], theta);
    }
}

fn correlation(theta: f64) -> Correlation {
    Correlation { family: Family::Markov, theta: [theta, theta.min(5.0)] }
}

fn lattice(cells: [usize; 2]) -> Lattice {
    Lattice { cell: [0.25; 2], cells }
}

/// Subdivision with stage 0 of at most 256 cells.
fn plain(cells: [usize; 2], theta: f64, repeats: usize) {
    let start = Clock::start();
    let Some(map) = Squash::new(&correlation(theta), &lattice(cells), [1, 1], 256) else { return };
    let set_up = start.seconds();
    time("plain subdivision", cells, set_up, repeats, |normals, scratch, out| map.apply(normals, scratch, out));
}

/// The factor of all cells.
fn exact(cells: [usize; 2]) {
    let start = Clock::start();
    let table = Table::new(&correlation(1.0), [0.25; 2], cells);
    let Some(map) = Exact::new(&table, cells) else { return };
    let set_up = start.seconds();
    time("exact", cells, set_up, 20, |normals, scratch, out| map.apply(normals, scratch, out));
}

/// What `auto` takes for theta_v = 1 m.
fn auto(cells: [usize; 2], theta: f64) {
    let correlation = Correlation { family: Family::Markov, theta: [theta, 1.0] };
    let bound = Bound { correlation: 0.05, variance: 0.03 };
    let spec = Spec { correlation, lattice: lattice(cells), method: Method::Auto, bound };
    let start = Clock::start();
    let generator = Generator::new(&spec).unwrap_or_else(|e| panic!("{e}"));
    let set_up = start.seconds();
    println!("theta_h = {theta} m: {}", generator.choice());
    let name = format!("auto, theta_h = {theta} m");
    time(&name, cells, set_up, 50, |normals, scratch, out| generator.sample(normals, scratch, out));
}

fn time(
    name: &str,
    cells: [usize; 2],
    set_up: f64,
    repeats: usize,
    mut sample: impl FnMut(&mut Normals, &mut Scratch, &mut [f64]),
) {
    let n = cells[0] * cells[1];
    let (mut scratch, mut out, mut best) = (Scratch::default(), vec![0.0; n], f64::INFINITY);
    for realisation in 0..=repeats as u64 {
        let start = Clock::start();
        sample(&mut Normals::new(1, realisation, "strength", false), &mut scratch, &mut out);
        best = best.min(start.seconds());
    }
    let size = format!("{} x {}", cells[0], cells[1]);
    println!("{name:<42}{size:>12}{:>14.1}{:>12.4}{:>12.1}", set_up * 1e3, best * 1e3, best * 1e9 / n as f64);
}
