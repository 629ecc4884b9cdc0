//! The initial failure: the part of the soil that has moved since the onset of failure.
//!
//! What moved is told from the displacement since the onset alone; before it the soil settles, which is no
//! failure. The same classes are read in a run of finite and of small strain, so that the first slide of RMPM
//! and that of RFEM can be compared.

use serde::Serialize;

use super::{slide::SlideProbe, split::split};
use crate::snapshot::Snapshot;

/// What has moved by more than a limit, since the onset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Class {
    /// Displacement since the onset (m) above which a point belongs to the slide.
    pub split_m: f64,
    /// r of these points at the surface (m).
    pub sliding_distance_m: f64,
    /// Their volume (m3/m).
    pub volume_m3_per_m: f64,
}

/// The soil when the largest displacement since the onset reached a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct InitialFailure {
    pub level_m: f64,
    /// When (s), and how far the fastest point was by then (m): the first look at or beyond the level.
    pub time_s: f64,
    pub displacement_m: f64,
    /// By the two clusters of the displacements.
    #[serde(flatten)]
    pub by_clusters: Class,
    /// By half the largest displacement: a block that moves as one lies at the largest, what stands at 0,
    /// and half of it keeps both at the same distance.
    pub by_threshold: Class,
}

/// Classifies the points of `s` by their displacement since the onset, `moved` (m, by identity).
pub fn initial_failure(s: &Snapshot, probe: &SlideProbe, moved: &[[f64; 2]], level: f64) -> InitialFailure {
    let lengths: Vec<f64> = moved.iter().map(|u| u[0].hypot(u[1])).collect();
    let largest = lengths.iter().copied().fold(0.0, f64::max);
    InitialFailure {
        level_m: level,
        time_s: s.time,
        displacement_m: largest,
        // soil that moves as one has no two clusters: all of it moves
        by_clusters: class(s, probe, &lengths, split(&lengths).unwrap_or(0.0)),
        by_threshold: class(s, probe, &lengths, 0.5 * largest),
    }
}

fn class(s: &Snapshot, probe: &SlideProbe, lengths: &[f64], limit: f64) -> Class {
    let slid = |i: usize| lengths.get(i).is_some_and(|l| *l > limit);
    let volumes = s.initial_volume.iter().zip(&s.jacobian).enumerate().filter(|(i, _)| slid(*i));
    Class {
        split_m: limit,
        sliding_distance_m: probe.distance(|id| slid(id as usize)),
        volume_m3_per_m: volumes.map(|(_, (v, j))| v * j).fold(0.0, |a, v| a + v),
    }
}

/// Largest displacement (m) from `from` to `to`, both by identity; NaN where one is not a number.
pub fn largest(from: &[[f64; 2]], to: &[[f64; 2]]) -> f64 {
    let square = |(a, b): (&[f64; 2], &[f64; 2])| (b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2);
    // `f64::max` would pass over a NaN
    from.iter().zip(to).map(square).fold(0.0, |a: f64, v| if v > a || v.is_nan() { v } else { a }).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten columns of two points, crest at x = 10; those beyond x = 7 move by `slide`, all others lean by a
    /// tenth of it.
    #[test]
    fn a_block_is_what_moves_and_not_what_leans() {
        let reference: Vec<[f64; 2]> =
            (0..10).flat_map(|i| [[f64::from(i) + 0.5, 0.25], [f64::from(i) + 0.5, 0.75]]).collect();
        let probe = SlideProbe::new(&reference, [10.0, 1.0], 1.0);
        let n = reference.len();
        let (initial_volume, jacobian) = (vec![0.5; n], vec![1.02; n]);
        let s = Snapshot { initial_volume, jacobian, reference, position: vec![[0.0; 2]; n], ..Snapshot::default() };
        let slide = |x: &[f64; 2]| if x[0] > 7.0 { [0.4, -0.3] } else { [0.04, 0.03] };
        let moved: Vec<[f64; 2]> = s.reference.iter().map(slide).collect();
        let found = initial_failure(&s, &probe, &moved, 0.5);
        assert!((found.displacement_m - 0.5).abs() < 1e-15);
        for class in [found.by_clusters, found.by_threshold] {
            assert_eq!(class.sliding_distance_m, 2.5);
            assert!((class.volume_m3_per_m - 6.0 * 0.5 * 1.02).abs() < 1e-12);
            assert!(class.split_m > 0.05 && class.split_m < 0.5);
        }
    }

    #[test]
    fn a_displacement_that_is_no_number_is_seen() {
        assert_eq!(largest(&[[0.0; 2]; 2], &[[3.0, 4.0], [1.0, 0.0]]), 5.0);
        assert!(largest(&[[0.0; 2]; 3], &[[f64::NAN, 0.0], [1.0, 0.0], [2.0, 0.0]]).is_nan());
    }
}
