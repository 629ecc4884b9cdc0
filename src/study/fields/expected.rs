//! What the factors of a field should come to: their exact mean, spread and standard errors.

use serde::Serialize;

use crate::field::{
    marginal::{Low, Marginal},
    model::Model,
    table::Table,
};

/// Exact figures of the factor on the mean in a cell. Where fields with low values are drawn again, those of a field
/// before that.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Expected {
    pub mean_factor: f64,
    pub sd_factor: f64,
    /// Probability that a cell is raised to the floor, or that its field is drawn again for it.
    pub low_share: f64,
}

/// Half the range and step of the rule over a normal density: 1e-7 at the kink of a floor, rounding elsewhere.
const RANGE: i32 = 9000;
const STEP: f64 = 1e-3;

impl Expected {
    /// Of a marginal whose normal has this variance in a cell.
    pub fn of(marginal: &Marginal, variance: f64) -> Self {
        let (floor, raised) = match marginal.low() {
            Low::Floor(floor) => (floor, true),
            Low::Resample(floor) => (floor, false),
            Low::Keep => (f64::NEG_INFINITY, false),
        };
        let [mut total, mut first, mut second, mut low] = [0.0; 4];
        for k in -RANGE..RANGE {
            let z = STEP * (f64::from(k) + 0.5);
            let weight = (-0.5 * z * z).exp();
            let bare = marginal.factor(variance.sqrt() * z);
            let factor = if raised { bare.max(floor) } else { bare };
            total += weight;
            first += weight * factor;
            second += weight * factor * factor;
            low += if bare < floor { weight } else { 0.0 };
        }
        let mean = first / total;
        let sd = (second / total - mean * mean).max(0.0).sqrt();
        Expected { mean_factor: mean, sd_factor: sd, low_share: low / total }
    }
}

/// Standard errors of the mean over all cells of `fields` realisations, and of the mean square about the exact mean.
///
/// With G the covariance of the factors of two cells, n cells and N fields: sum G / (n^2 N), and for normal factors
/// 2 sum G^2 / (n^2 N), squared both; sums over all pairs of cells, by lag.
pub fn standard_errors(model: &Model, target: &Table, expected: &Expected, fields: usize) -> [f64; 2] {
    let variation = model.marginal.variation();
    let factors = |c: f64| match model.marginal {
        Marginal::Normal { .. } => variation * variation * c,
        // exp(s Z - s^2 / 2) has the covariance m^2 (exp(s^2 C) - 1)
        Marginal::Lognormal { .. } => expected.mean_factor.powi(2) * (c * variation.powi(2).ln_1p()).exp_m1(),
    };
    let cells = model.lattice.cells;
    let pairs = |lag: usize, n: usize| (if lag == 0 { n } else { 2 * (n - lag) }) as f64;
    let [mut first, mut second] = [0.0; 2];
    for (i, j) in (0..target.lags()[1]).flat_map(|j| (0..target.lags()[0]).map(move |i| (i, j))) {
        let (count, g) = (pairs(i, cells[0]) * pairs(j, cells[1]), factors(target.at(i, j)));
        first += count * g;
        second += count * 2.0 * g * g;
    }
    let n = cells[0] as f64 * cells[1] as f64;
    [first, second].map(|sum| sum.sqrt() / (n * (fields.max(1) as f64).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{
        correlation::{Correlation, Family},
        table::Lattice,
    };

    /// Closed forms: mean 1 and V sigma; exp(-s^2 (1 - v) / 2) and the mean times sqrt(exp(s^2 v) - 1).
    #[test]
    fn closed_forms_of_both_marginals() {
        let normal = Expected::of(&Marginal::Normal { variation: 0.3, low: Low::Keep }, 0.64);
        assert!((normal.mean_factor - 1.0).abs() < 1e-12 && (normal.sd_factor - 0.24).abs() < 1e-9, "{normal:?}");
        let log = Expected::of(&Marginal::Lognormal { variation: 0.5 }, 0.64);
        let square = 1.25_f64.ln();
        let mean = (-0.5 * square * 0.36).exp();
        assert!((log.mean_factor - mean).abs() < 1e-9, "{log:?}");
        assert!((log.sd_factor - mean * (0.64 * square).exp_m1().sqrt()).abs() < 1e-9, "{log:?}");
    }

    /// E max(f, a) = a + sd (phi(t) + t Phi(t)), t = (1 - a) / sd; at a = 1, t = 0: 1 + sd / sqrt(2 pi).
    #[test]
    fn a_floor_at_the_mean() {
        let raised = Expected::of(&Marginal::Normal { variation: 0.5, low: Low::Floor(1.0) }, 1.0);
        assert!((raised.mean_factor - 1.0 - 0.5 / std::f64::consts::TAU.sqrt()).abs() < 1e-6, "{raised:?}");
        assert!((raised.low_share - 0.5).abs() < 1e-12);
    }

    /// Cells without correlation: V / sqrt(n N) and V^2 sqrt(2 / (n N)); cells that are all alike: n counts as 1.
    #[test]
    fn errors_of_independent_and_of_equal_cells() {
        let marginal = Marginal::Normal { variation: 0.2, low: Low::Keep };
        let lattice = Lattice { cell: [1.0, 1.0], cells: [10, 4] };
        let model = Model { name: "f".into(), origin: [0.0; 2], lattice, marginal, generator: None };
        let error = |theta: f64| {
            let table =
                Table::new(&Correlation { family: Family::MarkovSeparable, theta: [theta; 2] }, [1.0; 2], [10, 4]);
            let scale = table.at(0, 0);
            let [a, b] = standard_errors(&model, &table, &Expected::of(&marginal, scale), 9);
            [a / (0.2 * scale.sqrt()), b / (0.04 * scale)]
        };
        // theta of a millionth of a cell leaves a correlation of 1e-7 beside 1
        let [a, b] = error(1e-6);
        assert!((a * 360_f64.sqrt() - 1.0).abs() < 1e-5 && (b * 180_f64.sqrt() - 1.0).abs() < 1e-5, "{a} {b}");
        let [a, b] = error(f64::INFINITY);
        assert!((a * 3.0 - 1.0).abs() < 1e-12 && (b * 4.5_f64.sqrt() - 1.0).abs() < 1e-12, "{a} {b}");
    }
}
