//! What a setting will cost, before it is run: a rough count of its work, put right by the runs that are done.

use super::setting::Setting;
use crate::case::{Case, Scheme, ShapeFunctions};

/// CPU seconds of a point in an explicit step, of a point in an implicit iteration (bilinear shapes), and of the
/// factor of 2000 cells: of the order of what the benches print. Only the ratios within a scheme count for long.
const EXPLICIT_POINT: f64 = 1e-7;
const IMPLICIT_POINT: f64 = 1e-6;
const FACTOR: f64 = 2e-3;
/// Iterations of an implicit step.
const ITERATIONS: f64 = 4.0;

/// CPU seconds of a run to the end time, at a guess.
pub fn guess(case: &Case) -> f64 {
    let area: f64 = case.region.iter().map(|region| region.shape.area()).sum();
    let cells = area / (case.grid.cell * case.grid.cell);
    let points = cells * (case.points.per_axis * case.points.per_axis) as f64;
    let wide = if case.solver.shape == ShapeFunctions::Linear { 1.0 } else { 3.0 };
    match case.solver.scheme {
        Scheme::Explicit => {
            let step = case.explicit.time_step.unwrap_or(case.explicit.courant * case.grid.cell / wave_speed(case));
            case.end.time / step * points * EXPLICIT_POINT * wide
        }
        Scheme::Implicit => {
            // nested dissection: about cells^1.5 for the factor in the plane
            let factor = FACTOR * (cells / 2000.0).powf(1.5) * wide;
            case.end.time / case.implicit.time_step * ITERATIONS * (points * IMPLICIT_POINT * wide + factor)
        }
    }
}

/// The fastest compression wave (m/s), sqrt(M / rho) with M = E (1 - nu) / ((1 + nu) (1 - 2 nu)).
fn wave_speed(case: &Case) -> f64 {
    let speed = |m: &crate::case::Material| {
        let (e, nu) = (m.elastic().young_modulus, m.elastic().poisson_ratio);
        let modulus = e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
        (modulus * case.gravity.acceleration / m.elastic().unit_weight).sqrt()
    };
    case.material.values().map(speed).fold(0.0, f64::max)
}

/// One run that is done.
struct Paid {
    scheme: Scheme,
    shape: ShapeFunctions,
    guess: f64,
    cpu_s: f64,
}

/// The budget of a study: what is spent, what is under way, and what runs have cost over what was guessed.
pub struct Prices {
    budget: f64,
    spent: f64,
    under_way: f64,
    paid: Vec<Paid>,
}

impl Prices {
    /// With so many CPU seconds to spend.
    pub fn new(budget: f64) -> Self {
        Prices { budget, spent: 0.0, under_way: 0.0, paid: Vec::new() }
    }

    /// CPU seconds to be expected of `runs` runs: the guess times what the dearest run so far of the same scheme
    /// and shape, else of the same scheme, has cost over its own.
    pub fn predict(&self, setting: &Setting, runs: usize) -> f64 {
        let solver = &setting.case.solver;
        let alike = |exact: bool| {
            let runs = self.paid.iter().filter(|p| p.scheme == solver.scheme && (!exact || p.shape == solver.shape));
            runs.max_by(|a, b| a.guess.total_cmp(&b.guess)).map(|p| p.cpu_s / p.guess)
        };
        guess(&setting.case) * alike(true).or(alike(false)).unwrap_or(1.0) * runs as f64
    }

    /// Takes a sum out of the budget until it is paid; refused where there is not so much left.
    pub fn reserve(&mut self, predicted: f64) -> bool {
        let enough = self.spent + self.under_way + predicted <= self.budget;
        if enough {
            self.under_way += predicted;
        }
        enough
    }

    /// What is left (CPU s).
    pub fn left(&self) -> f64 {
        (self.budget - self.spent).max(0.0)
    }

    /// Books what the runs of a setting took in all, and what one of them took.
    pub fn pay(&mut self, setting: &Setting, predicted: f64, total: f64, one: f64) {
        self.under_way -= predicted;
        self.spent += total;
        let (solver, guess) = (&setting.case.solver, guess(&setting.case));
        self.paid.push(Paid { scheme: solver.scheme, shape: solver.shape, guess, cpu_s: one });
    }
}
