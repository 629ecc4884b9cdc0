//! The test for rest.

use std::collections::VecDeque;

/// Decides when a body is at rest: over the last `hold` seconds, counted from the end of loading
/// at the earliest, the *mean* nodal kinetic energy is below a fraction of its maximum and r has
/// stayed the same. The mean, because the elastic part goes on vibrating and any instant may be a
/// turning point; r within one cell, because a point that vibrates about the threshold moves r by
/// a column or two.
#[derive(Clone, Debug)]
pub struct Rest {
    ratio: f64,
    hold: f64,
    cell: f64,
    /// No rest before this time and a hold (s).
    start: f64,
    peak: f64,
    distance: f64,
    changed: f64,
    /// Time and energy of the last `hold` seconds.
    window: VecDeque<(f64, f64)>,
    sum: f64,
}

impl Rest {
    /// `ratio` of the largest kinetic energy, `hold` (s), cell size (m), end of loading (s).
    pub fn new(ratio: f64, hold: f64, cell: f64, start: f64) -> Self {
        Rest { ratio, hold, cell, start, peak: 0.0, distance: 0.0, changed: start, window: VecDeque::new(), sum: 0.0 }
    }

    /// Notes the nodal kinetic energy (kJ/m) and r (m) at a time (s). What lies before the end of
    /// an in-situ phase (`settling`) is forgotten.
    pub fn note(&mut self, time: f64, kinetic: f64, distance: f64, settling: bool) {
        if settling {
            return;
        }
        self.peak = self.peak.max(kinetic);
        if (distance - self.distance).abs() > self.cell * (1.0 + 1e-9) {
            self.distance = distance;
            self.changed = time;
        }
        self.window.push_back((time, kinetic));
        self.sum += kinetic;
        while self.window.front().is_some_and(|(t, _)| *t < time - self.hold) {
            self.sum -= self.window.pop_front().map_or(0.0, |(_, e)| e);
        }
    }

    /// Whether the body is at rest.
    pub fn reached(&self, time: f64) -> bool {
        let mean = self.sum / self.window.len().max(1) as f64;
        let held = time - self.changed.max(self.start) >= self.hold;
        held && !self.window.is_empty() && mean <= self.ratio * self.peak
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(energy: impl Fn(f64) -> f64, distance: impl Fn(f64) -> f64) -> Option<f64> {
        let mut rest = Rest::new(1e-3, 4.0, 0.25, 5.0);
        (0..4000).map(|i| 0.01 * f64::from(i)).find(|&t| {
            rest.note(t, energy(t), distance(t), false);
            rest.reached(t)
        })
    }

    #[test]
    fn a_vibration_is_no_rest_and_a_quiet_body_is() {
        assert_eq!(after(|t| (3.0 * t).cos().powi(2), |_| 0.0), None);
        let quiet = after(|t| if t < 10.0 { 100.0 } else { 0.01 }, |_| 0.0).unwrap();
        assert!((quiet - 14.0).abs() < 0.1, "{quiet}");
    }

    #[test]
    fn a_late_block_delays_rest_and_a_flickering_column_does_not() {
        let energy = |t: f64| if t < 6.0 { 100.0 } else { 1e-3 };
        let late = after(energy, |t| if t < 8.0 { 3.0 } else { 5.0 }).unwrap();
        assert!((late - 12.0).abs() < 0.1, "{late}");
        let flicker = after(energy, |t| 3.0 + 0.125 * f64::from((10.0 * t) as i32 % 2)).unwrap();
        assert!((flicker - 10.0).abs() < 0.1, "{flicker}");
    }
}
