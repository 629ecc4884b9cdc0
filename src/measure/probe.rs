//! Probes: the value of a quantity at a place of the soil, from the points around it.
//!
//! A linear function is fitted to the points by least squares and read at the place, so that a linear field is
//! read exactly whatever the layout of the points, and a smooth one with an error of second order in their distance:
//! ```text
//! sum w_i (a + g . (X_i - x) - q_i)^2 -> min,   value = a,   w = (1 - (d / R)^2)^2 for d < R
//! ```
//! X are places at the start, d = |X - x|, R = [`REACH`] sides of a point. The weights fall smoothly to 0 at R, so that
//! the value does not jump when a point comes in as the layout changes.

use serde::Serialize;

use crate::{
    case::{Probe, ProbeQuantity},
    snapshot::Snapshot,
};

/// Radius R in sides of a point, the root of its volume: some twenty points inside the soil, ten at an edge and
/// five at a corner, where three are the least.
const REACH: f64 = 2.5;

/// Points lie on a line where the smaller principal moment of their places is below this share of the larger one:
/// the gradient across a strip a thousandth as wide as long would be noise.
const FLAT: f64 = 1e-6;

/// What a probe read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reading {
    pub name: String,
    pub quantity: ProbeQuantity,
    /// In the unit of the quantity; `None` where the body has no finite value there.
    pub value: Option<f64>,
    pub exact: Option<f64>,
    /// value - exact.
    pub error: Option<f64>,
    /// Points that the value comes from; 1: that of the nearest point, as the others are too few or on a line.
    pub points: u64,
}

impl Reading {
    /// Reads a probe in a snapshot.
    pub fn of(probe: &Probe, s: &Snapshot) -> Self {
        let (value, points) = at(s, probe.at, |i| quantity(s, i, probe.quantity));
        let value = value.is_finite().then_some(value);
        let error = value.zip(probe.exact).map(|(value, exact)| value - exact);
        let (name, quantity) = (probe.name.clone(), probe.quantity);
        Reading { name, quantity, value, exact: probe.exact, error, points }
    }
}

fn quantity(s: &Snapshot, i: usize, quantity: ProbeQuantity) -> f64 {
    match quantity {
        ProbeQuantity::DisplacementX => s.displacement(i)[0],
        ProbeQuantity::DisplacementY => s.displacement(i)[1],
        ProbeQuantity::VelocityX => s.velocity[i][0],
        ProbeQuantity::VelocityY => s.velocity[i][1],
        ProbeQuantity::StressXx => s.stress[i].xx,
        ProbeQuantity::StressYy => s.stress[i].yy,
        ProbeQuantity::StressXy => s.stress[i].xy,
        ProbeQuantity::StressZz => s.stress[i].zz,
        ProbeQuantity::PlasticStrain => s.plastic_strain[i],
    }
}

/// The value at `place` (m, at the start) of what `of` gives for a point, and the points it comes from; NaN where
/// there is no point.
pub fn at(s: &Snapshot, place: [f64; 2], of: impl Fn(usize) -> f64) -> (f64, u64) {
    let radius = REACH * side(s);
    let offset = |i: usize| [s.reference[i][0] - place[0], s.reference[i][1] - place[1]];
    let away = |i: usize| offset(i)[0].hypot(offset(i)[1]);
    let near = (0..s.len()).filter(|&i| away(i) < radius);
    let samples: Vec<Sample> = near
        .map(|i| {
            let share = away(i) / radius;
            Sample { weight: (1.0 - share * share).powi(2), offset: offset(i), value: of(i) }
        })
        .collect();
    let nearest = (0..s.len()).min_by(|&a, &b| away(a).total_cmp(&away(b)));
    match linear_fit(&samples) {
        Some(value) => (value, samples.len() as u64),
        None => (nearest.map_or(f64::NAN, of), 1),
    }
}

/// Side of a point (m): the root of the median volume, as cut cells have smaller points.
fn side(s: &Snapshot) -> f64 {
    let mut volumes = s.initial_volume.clone();
    let middle = volumes.len() / 2;
    if volumes.is_empty() { 0.0 } else { volumes.select_nth_unstable_by(middle, f64::total_cmp).1.sqrt() }
}

struct Sample {
    weight: f64,
    /// From the place (m).
    offset: [f64; 2],
    value: f64,
}

/// The fitted linear function at offset 0; `None` where the points do not tell its gradient.
fn linear_fit(samples: &[Sample]) -> Option<f64> {
    let weight: f64 = samples.iter().map(|p| p.weight).sum();
    let mean = |f: &dyn Fn(&Sample) -> f64| samples.iter().map(|p| p.weight * f(p)).sum::<f64>() / weight;
    let (x, y, q) = (mean(&|p| p.offset[0]), mean(&|p| p.offset[1]), mean(&|p| p.value));
    let moment = |f: &dyn Fn(f64, f64, f64) -> f64| mean(&|p| f(p.offset[0] - x, p.offset[1] - y, p.value - q));
    let (xx, xy, yy) = (moment(&|x, _, _| x * x), moment(&|x, y, _| x * y), moment(&|_, y, _| y * y));
    let (xq, yq) = (moment(&|x, _, q| x * q), moment(&|_, y, q| y * q));
    let determinant = xx * yy - xy * xy;
    // also false for no samples, whose moments are NaN
    let spread = samples.len() >= 3 && determinant > FLAT * (xx + yy).powi(2);
    spread.then(|| {
        let gradient = [(yy * xq - xy * yq) / determinant, (xx * yq - xy * xq) / determinant];
        q - gradient[0] * x - gradient[1] * y
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a unit square, `n` a side, each moved by up to 0.3 of their distance if `uneven`.
    fn square(n: usize, uneven: bool) -> Snapshot {
        let h = 1.0 / n as f64;
        let shift = |k: usize, salt: f64| if uneven { 0.3 * (12.9898 * (k as f64 + salt)).sin() } else { 0.0 };
        let place = |k: usize| [((k % n) as f64 + 0.5 + shift(k, 0.1)) * h, ((k / n) as f64 + 0.5 + shift(k, 0.7)) * h];
        let reference: Vec<_> = (0..n * n).map(place).collect();
        Snapshot { position: reference.clone(), initial_volume: vec![h * h; n * n], reference, ..Snapshot::default() }
    }

    const PLACES: [[f64; 2]; 4] = [[0.5, 0.5], [0.31, 0.77], [1.0, 0.4], [1.0, 1.0]];

    /// Up to rounding: some hundred operations on numbers of order 1 to 10.
    #[test]
    fn linear_fields_are_read_exactly_from_any_layout() {
        for (s, place) in [false, true].iter().flat_map(|u| PLACES.map(|place| (square(7, *u), place))) {
            let (value, points) = at(&s, place, |i| 3.0 - 2.0 * s.reference[i][0] + 5.0 * s.reference[i][1]);
            assert!((value - (3.0 - 2.0 * place[0] + 5.0 * place[1])).abs() < 1e-12 && points >= 3, "{place:?}");
        }
    }

    /// What is left out of the fit is of second order. The fitted slope between two halvings feels the next term,
    /// a fraction h of the error: 0.15 at 20 to 80 points a side.
    #[test]
    fn smooth_fields_are_read_with_second_order() {
        let field = |[x, y]: [f64; 2]| (2.0 * x).sin() * (1.5 * y).exp();
        for place in PLACES {
            let error = |n: usize| {
                let s = square(n, false);
                (at(&s, place, |i| field(s.reference[i])).0 - field(place)).abs()
            };
            let order = (error(20) / error(80)).ln() / 4f64.ln();
            assert!((order - 2.0).abs() < 0.15, "{place:?}: {order}");
        }
    }

    #[test]
    fn few_points_or_a_line_of_them_give_the_nearest() {
        let mut s = square(5, false);
        s.reference.iter_mut().for_each(|x| x[1] = 0.5);
        assert_eq!(at(&s, [0.33, 0.9], |i| s.reference[i][0]), (0.3, 1));
        assert_eq!(at(&square(1, false), [0.2, 0.2], |i| i as f64), (0.0, 1));
        assert!(at(&Snapshot::default(), [0.0, 0.0], |_| 1.0).0.is_nan());
    }

    #[test]
    fn a_value_that_is_no_number_is_none() {
        let mut s = square(5, false);
        s.position[12] = [f64::NAN, 0.0];
        let probe = Probe {
            name: "tip".into(),
            at: [0.5, 0.5],
            quantity: ProbeQuantity::DisplacementX,
            exact: Some(1.0),
            source: Some("none".into()),
        };
        let reading = Reading::of(&probe, &s);
        assert_eq!((reading.value, reading.error, reading.exact), (None, None, Some(1.0)));
    }
}
