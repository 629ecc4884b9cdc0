//! Probes: the value of a quantity at a place of the soil, from the points around it.
//!
//! A polynomial of second degree is fitted to the points by least squares and read at the place:
//! ```text
//! sum w_i (p(X_i) - q_i)^2 -> min,   value = p(x),   w = (1 - (d / R)^2)^2 for d < R
//! ```
//! X are places at the start, d = |X - x|, R = `REACH` sides of a point. So linear and quadratic fields are read
//! exactly whatever the layout of the points, and smooth ones with an error of third order in their distance, less
//! than that of the method. The weights fall smoothly to 0 at R: the value does not jump where a point comes in.
//! Where the points do not tell a curvature (two across a bar) a linear function is fitted, with an error of second
//! order; where they tell no slope either the value is that of the nearest point.

use serde::Serialize;

use crate::{
    case::{Probe, ProbeQuantity},
    snapshot::Snapshot,
};

/// Radius R in sides of a point, the root of its volume: some 38 points inside the soil, and 8 or more at a corner.
const REACH: f64 = 3.5;

/// Points for a fit of second degree, which has 6 unknowns, and of first degree, which has 3.
const FOR_QUADRATIC: usize = 8;
const FOR_LINEAR: usize = 3;

/// A term of the polynomial counts as told by the points where what the terms taken before it leave of its square is
/// above this share: a strip a thousandth as wide as long tells nothing of the slope across it.
const TOLD: f64 = 1e-6;

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
    let sample = |i: usize| {
        let weight = (1.0 - (away(i) / radius).powi(2)).powi(2);
        Sample { weight, offset: offset(i).map(|x| x / radius), value: of(i) }
    };
    let samples: Vec<Sample> = near.map(sample).collect();
    let quadratic = || fit(&samples, FOR_QUADRATIC, |[x, y]| [1.0, x, y, x * x, x * y, y * y]);
    let linear = || fit(&samples, FOR_LINEAR, |[x, y]| [1.0, x, y]);
    if let Some(value) = quadratic().or_else(linear) {
        return (value, samples.len() as u64);
    }
    let nearest = (0..s.len()).min_by(|&a, &b| away(a).total_cmp(&away(b)));
    (nearest.map_or(f64::NAN, of), 1)
}

/// Side of a point (m): the root of the median volume, as cut cells have smaller points.
fn side(s: &Snapshot) -> f64 {
    let mut volumes = s.initial_volume.clone();
    let middle = volumes.len() / 2;
    if volumes.is_empty() { 0.0 } else { volumes.select_nth_unstable_by(middle, f64::total_cmp).1.sqrt() }
}

struct Sample {
    weight: f64,
    /// From the place, over the radius.
    offset: [f64; 2],
    value: f64,
}

/// The least-squares sum of `terms`, of which the first is 1 and the others vanish at the place, read there. `None`
/// for fewer than `least` points, and where they do not tell all terms.
fn fit<const N: usize>(samples: &[Sample], least: usize, terms: impl Fn([f64; 2]) -> [f64; N]) -> Option<f64> {
    let (mut matrix, mut right) = ([[0.0; N]; N], [0.0; N]);
    for sample in samples {
        let t = terms(sample.offset);
        for i in 0..N {
            right[i] += sample.weight * t[i] * sample.value;
            (0..N).for_each(|j| matrix[i][j] += sample.weight * t[i] * t[j]);
        }
    }
    if samples.len() < least { None } else { first_unknown(matrix, right) }
}

/// The first unknown of a positive definite system: the last one to be eliminated, so the terms are taken from the
/// last to the first. `None` where a pivot is below [`TOLD`] of its diagonal.
fn first_unknown<const N: usize>(mut matrix: [[f64; N]; N], mut right: [f64; N]) -> Option<f64> {
    let diagonal: [f64; N] = std::array::from_fn(|k| matrix[k][k]);
    for k in (0..N).rev() {
        let pivot = matrix[k][k];
        // also where it is no number
        if !matches!(pivot.partial_cmp(&(TOLD * diagonal[k])), Some(std::cmp::Ordering::Greater)) {
            return None;
        }
        for i in 0..k {
            let factor = matrix[i][k] / pivot;
            (0..k).for_each(|j| matrix[i][j] -= factor * matrix[k][j]);
            right[i] -= factor * right[k];
        }
    }
    Some(right[0] / matrix[0][0])
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

    /// Up to rounding: some hundred operations on numbers of order 1 to 10, and at a corner, beyond all points, the
    /// least pivot is a hundredth of its diagonal.
    #[test]
    fn fields_of_second_degree_are_read_exactly_from_any_layout() {
        let field = |[x, y]: [f64; 2]| 3.0 - 2.0 * x + 5.0 * y + x * x - 4.0 * x * y + 2.0 * y * y;
        for (s, place) in [false, true].iter().flat_map(|u| PLACES.map(|place| (square(7, *u), place))) {
            let (value, points) = at(&s, place, |i| field(s.reference[i]));
            assert!((value - field(place)).abs() < 1e-12 && points >= 8, "{place:?}: {value} of {points}");
        }
    }

    /// What is left out of the fit is of third order, of fourth where the points lie evenly around the place. The
    /// slope over two halvings feels the next term, some h of the error each: 0.1 at 40 to 160 points a side.
    #[test]
    fn smooth_fields_are_read_with_third_order() {
        let field = |[x, y]: [f64; 2]| (2.0 * x).sin() * (1.5 * y).exp();
        for place in PLACES {
            let error = |n: usize| {
                let s = square(n, false);
                (at(&s, place, |i| field(s.reference[i])).0 - field(place)).abs()
            };
            let order = (error(40) / error(160)).ln() / 4f64.ln();
            assert!(order > 2.9, "{place:?}: {order}");
        }
    }

    /// Two points across a bar: no curvature across it, linear fields are exact.
    #[test]
    fn a_strip_is_read_with_a_linear_fit() {
        let mut s = square(20, false);
        (s.reference, s.position) = (s.reference[..40].to_vec(), s.position[..40].to_vec());
        s.initial_volume.truncate(40);
        for x in [0.5, 1.0] {
            let (value, points) = at(&s, [x, 0.0], |i| 1.0 + s.reference[i][0] + 7.0 * s.reference[i][1]);
            assert!((value - 1.0 - x).abs() < 1e-12 && points >= 3, "{value} of {points}");
        }
    }

    #[test]
    fn few_points_or_a_line_of_them_give_the_nearest() {
        let mut s = square(5, false);
        s.reference.iter_mut().for_each(|x| x[1] = 0.5);
        assert_eq!(at(&s, [0.33, 0.9], |i| s.reference[i][0]), (s.reference[1][0], 1));
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
