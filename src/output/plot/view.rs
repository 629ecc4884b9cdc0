//! The part of the plane that a picture shows.

use crate::snapshot::Snapshot;

/// A rectangle (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    pub min: [f64; 2],
    pub max: [f64; 2],
}

/// Coordinates beyond this (m) are not looked at.
const FAR: f64 = 1e9;

impl View {
    /// All points of all snapshots with their size, and these further positions, with a margin of
    /// 2 % of the longer side. The unit square if there is nothing.
    pub fn around(snapshots: &[&Snapshot], further: &[[f64; 2]]) -> View {
        let mut view = View { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };
        for snapshot in snapshots {
            (0..snapshot.len()).for_each(|i| view.include(snapshot.position[i], 0.5 * side(snapshot, i)));
        }
        further.iter().for_each(|x| view.include(*x, 0.0));
        if view.min[0] > view.max[0] {
            return View { min: [0.0; 2], max: [1.0; 2] };
        }
        let margin = 0.02 * view.width().max(view.height());
        view.grown(if margin > 0.0 { margin } else { 0.5 })
    }

    fn include(&mut self, x: [f64; 2], half: f64) {
        if x.iter().all(|c| c.abs() < FAR) {
            for (k, c) in x.iter().enumerate() {
                self.min[k] = self.min[k].min(c - half);
                self.max[k] = self.max[k].max(c + half);
            }
        }
    }

    /// The same rectangle if it can be drawn: finite and not empty.
    pub fn checked(self) -> Option<View> {
        let good = |k: usize| self.min[k] < self.max[k] && self.min[k].abs() < FAR && self.max[k].abs() < FAR;
        (good(0) && good(1)).then_some(self)
    }

    pub fn width(&self) -> f64 {
        self.max[0] - self.min[0]
    }

    pub fn height(&self) -> f64 {
        self.max[1] - self.min[1]
    }

    fn grown(self, by: f64) -> View {
        View { min: self.min.map(|c| c - by), max: self.max.map(|c| c + by) }
    }

    /// Widened around its middle to these sides (m).
    pub fn widened(self, width: f64, height: f64) -> View {
        let by = [0.5 * (width - self.width()), 0.5 * (height - self.height())];
        View { min: [self.min[0] - by[0], self.min[1] - by[1]], max: [self.max[0] + by[0], self.max[1] + by[1]] }
    }
}

/// Side of the square that a point fills now (m); 0 if its volume is no positive number.
pub fn side(s: &Snapshot, i: usize) -> f64 {
    let volume = s.initial_volume.get(i).copied().unwrap_or(0.0);
    let side = (volume * s.jacobian.get(i).copied().unwrap_or(1.0)).sqrt();
    if side.is_finite() && side < FAR { side } else { 0.0 }
}
