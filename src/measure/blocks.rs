//! Blocks of a retrogressive slide: the plateaus of r(t).

use serde::Serialize;

/// A stretch of time over which r stays the same.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Plateau {
    /// Start (s).
    pub from_s: f64,
    /// r (m).
    pub sliding_distance_m: f64,
}

/// Plateaus of r(t) that last at least `hold` (s) and lie at least `length` (m) above the one
/// before. The last value of r counts however long it lasted; r = 0 is no plateau. A
/// plateau starts when r first comes within half a `length` of it; columns that let go later, by
/// less than a `length`, belong to it, and r of the block is the last of them.
pub fn plateaus(time: &[f64], r: &[f64], hold: f64, length: f64) -> Vec<Plateau> {
    let mut found: Vec<Plateau> = Vec::new();
    let mut start = 0;
    for i in 1..=r.len() {
        if i < r.len() && r[i] == r[start] {
            continue;
        }
        let until = if i < r.len() { time[i] } else { f64::INFINITY };
        if r[start] > 0.0 && until - time[start] >= hold {
            let near = r.iter().position(|v| *v > (r[start] - 0.5 * length).max(0.0)).unwrap_or(start);
            push(&mut found, time[near], r[start], length);
        }
        start = i;
    }
    found
}

fn push(found: &mut Vec<Plateau>, from_s: f64, sliding_distance_m: f64, length: f64) {
    let before = found.last().map_or(0.0, |p| p.sliding_distance_m);
    match found.last_mut() {
        Some(last) if sliding_distance_m - before < length => last.sliding_distance_m = sliding_distance_m,
        _ if sliding_distance_m - before >= length => found.push(Plateau { from_s, sliding_distance_m }),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_blocks() {
        let time: Vec<f64> = (0..100).map(|i| 0.1 * i as f64).collect();
        let r: Vec<f64> = time
            .iter()
            .map(|&t| match t {
                t if t < 2.0 => 0.0,
                t if t < 2.1 => 1.0, // on the way, too short
                t if t < 4.0 => 2.9,
                t if t < 5.0 => 3.1, // a straggler of the first block
                t if t < 7.0 => 5.5,
                _ => 8.8,
            })
            .collect();
        let p = plateaus(&time, &r, 0.5, 1.0);
        let lengths: Vec<f64> = p.iter().map(|p| p.sliding_distance_m).collect();
        assert_eq!(lengths, vec![3.1, 5.5, 8.8]);
    }

    #[test]
    fn no_slide_no_block() {
        assert!(plateaus(&[0.0, 1.0], &[0.0, 0.0], 0.5, 1.0).is_empty());
    }
}
