//! Pieces of a body: groups of points that share no node.
//!
//! Two points act on one another only through a node of both. Where points come further apart than the shape functions
//! reach, the body parts there, whatever its law says: none of the laws here lets soil tear.

use std::collections::BTreeSet;

use crate::case::{Case, Kinematics, ShapeFunctions};

/// Pieces at the start and at the end, from the places of the points then (m). Points count as joined where their
/// patches of nodes meet, whether or not a weight in them is 0: a piece that is told is one. In small strain points keep
/// their nodes, so that nothing parts.
pub fn pieces(case: &Case, start: &[[f64; 2]], end: &[[f64; 2]]) -> [u64; 2] {
    let first = count(case, start);
    let last = if case.solver.kinematics == Kinematics::Small { first } else { count(case, end) };
    [first, last]
}

fn count(case: &Case, places: &[[f64; 2]]) -> u64 {
    let (shift, reach) = patch(case.solver.shape);
    let (h, origin) = (case.grid.cell, case.grid.origin);
    let patch_of = |x: &[f64; 2]| [0, 1].map(|a| ((x[a] - origin[a]) / h + shift).floor() as i64);
    groups(places.iter().map(patch_of).collect(), reach)
}

/// What is added to the place, in cells, before it is rounded down to the number of its patch; and how far apart two
/// patches may be and share a node: one less than they are long.
fn patch(shape: ShapeFunctions) -> (f64, i64) {
    match shape {
        ShapeFunctions::Linear => (0.0, 1),
        // around the nearest node
        ShapeFunctions::Gimp | ShapeFunctions::Bspline => (0.5, 2),
        ShapeFunctions::GimpWide => (0.0, 3),
    }
}

/// Groups of patches, of which each is within `reach` of another of its group along both axes.
fn groups(mut left: BTreeSet<[i64; 2]>, reach: i64) -> u64 {
    let mut found = 0;
    while let Some(first) = left.pop_first() {
        found += 1;
        let mut edge = vec![first];
        while let Some([x, y]) = edge.pop() {
            let near = (x.saturating_sub(reach)..=x.saturating_add(reach))
                .flat_map(|i| (y.saturating_sub(reach)..=y.saturating_add(reach)).map(move |j| [i, j]));
            edge.extend(near.filter(|patch| left.remove(patch)));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_hang_together_over_corners_and_part_over_a_gap() {
        let set = |places: &[[i64; 2]]| places.iter().copied().collect::<BTreeSet<_>>();
        assert_eq!(groups(set(&[]), 1), 0);
        assert_eq!(groups(set(&[[0, 0], [1, 1], [2, 0]]), 1), 1);
        assert_eq!(groups(set(&[[0, 0], [2, 0], [2, 1]]), 1), 2);
        assert_eq!(groups(set(&[[0, 0], [2, 0], [2, 1]]), 2), 1);
        assert_eq!(groups(set(&[[i64::MIN, 0], [i64::MAX, 0]]), 3), 2);
    }

    /// Shape functions that reach further hold a body together over wider gaps: cells 0 and 2, 3, 4 of length 1.
    #[test]
    fn how_wide_a_gap_is_depends_on_the_shape_functions() {
        let text = include_str!("../../validation/hard-cases/bar.toml");
        let parted_at = |shape: &str| {
            let (case, _) = crate::case::read("bar.toml", text, &[format!("solver.shape={shape}")]).unwrap();
            (1..6).find(|gap| pieces(&case, &[[0.25, 0.25]], &[[0.25, 0.25], [0.25 + f64::from(*gap), 0.25]])[1] == 2)
        };
        assert_eq!(["linear", "gimp", "bspline", "gimp_wide"].map(parted_at), [Some(2), Some(3), Some(3), Some(4)]);
    }
}
