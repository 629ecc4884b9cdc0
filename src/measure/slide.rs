//! Sliding distance, slide volume and run-out.

use std::collections::BTreeMap;

use crate::snapshot::Snapshot;

/// Reads the sliding distance r: the top points of the initial crest columns are taken in order
/// from the left wall; r = x_crest - x0 of the first whose horizontal displacement exceeds the
/// threshold, and 0 if there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct SlideProbe {
    /// x of the crest (m).
    pub crest: f64,
    /// Identity and initial x (m) of the top point of each column, from the left.
    columns: Vec<(u32, f64)>,
}

impl SlideProbe {
    /// Finds the columns behind the crest: points with equal initial x, within `h`/100. Only
    /// columns that reach to within one cell of the crest's height belong to the crest.
    pub fn new(reference: &[[f64; 2]], crest: [f64; 2], h: f64) -> Self {
        let mut top: BTreeMap<i64, (u32, [f64; 2])> = BTreeMap::new();
        for (id, &x) in reference.iter().enumerate().filter(|(_, x)| x[0] <= crest[0]) {
            let entry = top.entry((x[0] * 100.0 / h).round() as i64).or_insert((id as u32, x));
            if x[1] > entry.1[1] {
                *entry = (id as u32, x);
            }
        }
        let at_crest = top.into_values().filter(|(_, x)| (x[1] - crest[1]).abs() <= h);
        SlideProbe { crest: crest[0], columns: at_crest.map(|(id, x)| (id, x[0])).collect() }
    }

    /// Identity of the top point of the column nearest to the crest.
    pub fn crest_point(&self) -> Option<u32> {
        self.columns.last().map(|(id, _)| *id)
    }

    /// r (m) for a test of "has slid" on a point's identity.
    pub fn distance(&self, slid: impl Fn(u32) -> bool) -> f64 {
        self.columns.iter().find(|(id, _)| slid(*id)).map_or(0.0, |(_, x0)| self.crest - x0)
    }

    /// r (m) for a threshold on the horizontal displacement; `displacement` by identity (m).
    pub fn by_displacement(&self, displacement: &[[f64; 2]], threshold: f64) -> f64 {
        self.distance(|id| displacement.get(id as usize).is_some_and(|u| u[0] > threshold))
    }

    /// r (m) where a surface point counts as slid once its strength is the residual one.
    pub fn by_plastic_strain(&self, s: &Snapshot, residual_strain: f64) -> f64 {
        self.distance(|id| s.plastic_strain.get(id as usize).is_some_and(|&e| e > residual_strain))
    }
}

/// Volume (m3/m) of the points displaced by more than `threshold` (m).
pub fn slide_volume(s: &Snapshot, threshold: f64) -> f64 {
    let moved = |i: &usize| {
        let u = s.displacement(*i);
        u[0].hypot(u[1]) > threshold
    };
    (0..s.len()).filter(moved).map(|i| s.initial_volume[i] * s.jacobian[i]).fold(0.0, |a, v| a + v)
}

/// How far the front of the moving soil has come beyond its initial front (m), along +x. Soil
/// that moved by less than `threshold` (m), such as a foundation, has no part in it.
pub fn runout(s: &Snapshot, threshold: f64) -> f64 {
    let moved = |i: &usize| {
        let u = s.displacement(*i);
        u[0].hypot(u[1]) > threshold
    };
    let front =
        |points: &[[f64; 2]]| (0..s.len()).filter(moved).map(|i| points[i][0]).fold(f64::NEG_INFINITY, f64::max);
    let runout = front(&s.position) - front(&s.reference);
    if runout > 0.0 { runout } else { 0.0 }
}

/// Largest displacement of a point (m).
pub fn max_displacement(s: &Snapshot) -> f64 {
    (0..s.len()).map(|i| s.displacement(i)).map(|u| u[0].hypot(u[1])).max_by(f64::total_cmp).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten columns of two points, crest at x = 10.
    fn columns() -> Vec<[f64; 2]> {
        (0..10).flat_map(|i| [[i as f64 + 0.5, 0.25], [i as f64 + 0.5, 0.75]]).collect()
    }

    #[test]
    fn distance_is_measured_from_the_crest_to_the_first_column_that_moved() {
        let probe = SlideProbe::new(&columns(), [10.0, 1.0], 1.0);
        let mut u = vec![[0.0, 0.0]; 20];
        assert_eq!(probe.by_displacement(&u, 0.25), 0.0);
        u[2 * 6 + 1] = [0.3, -0.1]; // top point at x = 6.5
        u[2 * 8 + 1] = [2.0, -1.0];
        u[2 * 3] = [5.0, 0.0]; // a lower point does not count
        assert_eq!(probe.by_displacement(&u, 0.25), 3.5);
        assert_eq!(probe.by_displacement(&u, 0.5), 1.5);
    }
}
