//! The mechanism of a slope that fails: where it moves, and which way.

use std::{io, path::Path};

use super::{load, nearest, options};
use crate::{
    case::Case,
    output::plot::{self, FieldKind},
    snapshot::Snapshot,
};

/// Largest displacement that is drawn, in cells. At failure the displacement has a shape and no size.
const CELLS: f64 = 4.0;

/// Draws `pictures/mechanism.png` from what has moved between the frame at the onset, or without one the last but
/// one, and the last frame.
pub fn draw(folder: &Path, case: &Case, frames: &[(f64, String)], began: Option<f64>) -> io::Result<()> {
    let last = frames.len().saturating_sub(1);
    let first = began.and_then(|t| nearest(frames, t)).filter(|k| *k < last).or(last.checked_sub(1));
    let Some(first) = first else { return Ok(()) };
    let snapshots = load(folder, frames, &[first, last])?;
    let [from, to] = snapshots.as_slice() else { return Ok(()) };
    let most = CELLS * case.grid.cell;
    let Some(shape) = shape(from, to, most) else { return Ok(()) };
    let caption = format!("what moves from {:.2} to {:.2} s, drawn so that the most is {most} m", from.time, to.time);
    let o = plot::FieldOptions { captions: vec![caption], ..options(case, FieldKind::Displacement) };
    plot::field(&folder.join("pictures").join("mechanism.png"), &[&shape], &o)
}

/// The points as they started, displaced by their way from one snapshot to the other, scaled to at most `most` (m).
/// `None` where nothing moves, or not by a number.
fn shape(from: &Snapshot, to: &Snapshot, most: f64) -> Option<Snapshot> {
    let ways: Vec<[f64; 2]> = from.position.iter().zip(&to.position).map(|(a, b)| [b[0] - a[0], b[1] - a[1]]).collect();
    let largest = crate::measure::onset::largest(&from.position, &to.position);
    let scale = Some(most / largest).filter(|s| s.is_finite())?;
    let position = to.reference.iter().zip(&ways).map(|(x, u)| [x[0] + scale * u[0], x[1] + scale * u[1]]).collect();
    Some(Snapshot { position, jacobian: vec![1.0; to.len()], ..to.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_settlement_before_is_no_part_of_the_mechanism() {
        let at = |by: [f64; 2]| Snapshot {
            reference: vec![[0.0, 0.0], [1.0, 0.0]],
            position: vec![[0.0, -0.3], [1.0 + by[0], -0.3 + by[1]]],
            initial_volume: vec![1.0; 2],
            ..Snapshot::default()
        };
        let shape = shape(&at([0.0, 0.0]), &at([3.0, -4.0]), 1.0).expect("it moves");
        assert_eq!(shape.displacement(0), [0.0, 0.0]);
        let u = shape.displacement(1);
        assert!((u[0] - 0.6).abs() < 1e-12 && (u[1] + 0.8).abs() < 1e-12, "{u:?}");
        assert!(super::shape(&at([0.0, 0.0]), &at([0.0, 0.0]), 1.0).is_none());
    }
}
