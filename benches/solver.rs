//! Sparse solvers on the stiffness of slabs, one thread: minimum degree against nested dissection,
//! LU against GMRES.
//!
//! `cargo bench --bench solver`; `-- --full` adds the slab of 129,600 cells. `-- --peer FOLDER` takes turns with
//! another program (`peers`).

mod common;
mod peers;
mod slab;

use common::Clock;
use rmpm::{
    math::linear::{Options, Ordering, Solver, Unsymmetric},
    work::Work,
};
use slab::{Kind, Slab};

/// Cells along and up, repeats, and milliseconds of the same library in an earlier measurement on
/// slabs of about the same size: numeric L L^T, symbolic, solve, and numeric LU (0: not measured).
const SIZES: [([u32; 2], usize, [f64; 4]); 4] = [
    ([90, 20], 20, [1.07, 0.48, 0.22, 10.3]),
    ([180, 45], 20, [9.6, 2.7, 1.1, 43.0]),
    ([360, 90], 8, [55.0, 13.0, 11.5, 253.0]),
    ([720, 180], 4, [313.0, 69.0, 63.0, 0.0]),
];
/// Targets at the first size (ms): factor and solve, symmetric and by LU.
const TARGETS: [f64; 2] = [1.5, 10.0];

fn main() {
    let args: Vec<String> = std::env::args().collect();
    if let Some(at) = args.iter().position(|a| a == "--peer") {
        return peers::serve(args.get(at + 1).expect("a folder for the matrices").as_ref());
    }
    let full = args.iter().any(|a| a == "--full");
    let sizes = if full { &SIZES[..] } else { &SIZES[..3] };
    println!("milliseconds of {}, best of the repeats; reference figures in brackets", Clock::start().name());
    symmetric(sizes);
    unsymmetric(sizes);
    println!("targets at 1,800 cells: {} symmetric, {} by LU, factor and solve with the check", TARGETS[0], TARGETS[1]);
}

fn symmetric(sizes: &[([u32; 2], usize, [f64; 4])]) {
    println!(
        "\n{:<9}{:<12}{:>17}{:>17}{:>17}{:>10}{:>11}",
        "cells", "order", "symbolic", "factor", "solve", "both", "fill (M)"
    );
    for &(cells, repeats, [llt, symbolic, solve, _]) in sizes {
        let slab = Slab::new(cells, Kind::Elastic);
        for (name, ordering) in [("degree", Ordering::Amd), ("dissection", Ordering::NestedDissection)] {
            let mut run = Run::new(&slab, Options { ordering, ..Options::default() }, true);
            let both = run.best(repeats, false);
            let first = run.best(repeats.min(6), true);
            let again = run.again(repeats);
            println!(
                "{:<9}{name:<12}{:>17}{:>17}{:>17}{both:>10.2}{:>11.2}",
                cells[0] * cells[1],
                beside(first - both, symbolic),
                beside(both - again, llt),
                beside(again, solve),
                run.solver.fill() as f64 * 1e-6,
            );
        }
    }
}

fn beside(value: f64, reference: f64) -> String {
    if reference > 0.0 { format!("{value:.2} [{reference}]") } else { format!("{value:.2}") }
}

fn unsymmetric(sizes: &[([u32; 2], usize, [f64; 4])]) {
    println!("\n{:<9}{:<22}{:>17}{:>17}{:>12}", "cells", "unsymmetric by", "LU, both", "GMRES, both", "iterations");
    for &(cells, repeats, [.., lu]) in sizes {
        for (name, kind) in CASES {
            let slab = Slab::new(cells, kind);
            let mut times = [0.0; 2];
            let mut said = String::new();
            for (time, unsymmetric) in times.iter_mut().zip([Unsymmetric::Lu, Unsymmetric::Gmres]) {
                let mut run = Run::new(&slab, Options { unsymmetric, ..Options::default() }, false);
                *time = run.best(repeats.min(8), false);
                said = run.said();
            }
            println!("{:<9}{name:<22}{:>17}{:>17.2}{said:>12}", cells[0] * cells[1], beside(times[0], lu), times[1]);
        }
    }
}

const CASES: [(&str, Kind); 5] = [
    ("slip along the base", Kind::Slipping),
    ("3 % plastic, slope .3", Kind::Plastic { part: 0.03, slope: 0.3 }),
    ("30 % plastic, slope .1", Kind::Plastic { part: 0.3, slope: 0.1 }),
    ("30 % plastic, slope .3", Kind::Plastic { part: 0.3, slope: 0.3 }),
    ("all plastic, slope .1", Kind::Plastic { part: 1.0, slope: 0.1 }),
];

/// A slab and a solver that is warm.
struct Run<'a> {
    slab: &'a Slab,
    solver: Solver,
    symmetric: bool,
    x: Vec<f64>,
    work: Work,
}

impl<'a> Run<'a> {
    fn new(slab: &'a Slab, options: Options, symmetric: bool) -> Self {
        let (x, work) = (vec![0.0; slab.rhs.len()], Work::default());
        let mut run = Run { slab, solver: Solver::new(options), symmetric, x, work };
        run.solve();
        run
    }

    fn solve(&mut self) {
        let Slab { pattern, values, rhs } = self.slab;
        let solved = self.solver.solve(pattern, values, self.symmetric, rhs, &mut self.x, &mut self.work);
        solved.unwrap_or_else(|e| panic!("{e}"));
    }

    /// Factor, solution and check; with the symbolic factor if it is to be forgotten each time.
    fn best(&mut self, repeats: usize, forget: bool) -> f64 {
        let time = |run: &mut Self| {
            let clock = Clock::start();
            if forget {
                run.solver.forget();
            }
            run.solve();
            1e3 * clock.seconds()
        };
        (0..repeats).map(|_| time(self)).fold(f64::INFINITY, f64::min)
    }

    /// Solution and check by the last factor.
    fn again(&mut self, repeats: usize) -> f64 {
        let Slab { pattern, values, rhs } = self.slab;
        let mut time = || {
            let clock = Clock::start();
            self.solver.solve_again(pattern, values, rhs, &mut self.x).expect("a factor");
            1e3 * clock.seconds()
        };
        (0..repeats).map(|_| time()).fold(f64::INFINITY, f64::min)
    }

    /// Iterations of GMRES a solve, and whether LU had to help.
    fn said(&self) -> String {
        let iterations = self.work.gmres_iterations as f64 / self.work.solves as f64;
        format!("{iterations:.0}{}", if self.work.fallback_solves > 0 { ", LU" } else { "" })
    }
}
