//! Polygons in the plane: corners in order, either way round, the last one joined to the first.

/// A point of the plane, (x, y).
pub type Point = [f64; 2];

/// Area with sign: positive where the corners run counter-clockwise.
///
/// Shoelace formula about the first corner: `A = 1/2 sum (p_i - p_0) x (p_(i+1) - p_0)`.
pub fn signed_area(corners: &[Point]) -> f64 {
    let Some(&first) = corners.first() else { return 0.0 };
    edges(corners).map(|(p, q)| 0.5 * turn(first, p, q)).sum()
}

/// Area of a simple polygon, whichever way its corners run.
pub fn area(corners: &[Point]) -> f64 {
    signed_area(corners).abs()
}

/// Lower left and upper right corner of the smallest upright rectangle around the polygon.
pub fn bounds(corners: &[Point]) -> [Point; 2] {
    let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    corners
        .iter()
        .fold(start, |[low, high], p| [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]])
}

/// Whether a point lies inside, by the parity of the edges crossed on the way to +x.
///
/// A point on the outline belongs to exactly one of two polygons that share the edge there.
pub fn contains(corners: &[Point], point: Point) -> bool {
    edges(corners).filter(|&(p, q)| crosses_ray(p, q, point)).count() % 2 == 1
}

/// Distance from a point to the outline; 0 on the outline.
pub fn distance_to_outline(corners: &[Point], point: Point) -> f64 {
    edges(corners).map(|(p, q)| distance_to_edge(p, q, point)).fold(f64::INFINITY, f64::min)
}

/// The first corner that stands where the corner before it stands (the first follows the last).
pub fn repeated_corner(corners: &[Point]) -> Option<usize> {
    let n = corners.len();
    edges(corners).position(|(p, q)| p == q).map(|edge| (edge + 1) % n)
}

/// The first two edges that meet elsewhere than at a shared corner; edge i starts at corner i.
pub fn crossing(corners: &[Point]) -> Option<(usize, usize)> {
    let edges: Vec<_> = edges(corners).collect();
    let n = edges.len();
    (0..n).find_map(|i| (i + 1..n).find(|&j| edges_meet(&edges, i, j)).map(|j| (i, j)))
}

/// Whether the outline neither repeats a corner nor meets itself.
pub fn is_simple(corners: &[Point]) -> bool {
    corners.len() >= 3 && repeated_corner(corners).is_none() && crossing(corners).is_none()
}

/// The part of a polygon inside the upright rectangle from `min` to `max`, after Sutherland and
/// Hodgman (1974).
///
/// A concave polygon may fall into several parts; they come back as one outline joined by edges
/// that run to and fro along the rectangle, which leaves [`area`] exact.
pub fn clip_to_rect(corners: &[Point], min: Point, max: Point) -> Vec<Point> {
    let sides = [(0, 1.0, min[0]), (0, -1.0, -max[0]), (1, 1.0, min[1]), (1, -1.0, -max[1])];
    sides
        .iter()
        .fold(corners.to_vec(), |rest, &(axis, sign, limit)| clip_to_half_plane(&rest, |p| sign * p[axis] - limit))
}

/// Area common to two simple polygons.
///
/// A polygon is the signed sum of the strips between its edges and a level line below, so the
/// common area is the signed sum of the common areas of strips: exact but for round-off, for
/// concave polygons too.
pub fn overlap_area(a: &[Point], b: &[Point]) -> f64 {
    let level = bounds(a)[0][1].min(bounds(b)[0][1]);
    let strips: Vec<_> = edges(b).collect();
    let sum: f64 = edges(a).map(|one| strips.iter().map(|&other| common_strip(one, other, level)).sum::<f64>()).sum();
    sum.abs()
}

/// The edges, each from its corner to the next.
fn edges(corners: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// Twice the signed area of the triangle: positive where c lies left of the way from a to b.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn crosses_ray(p: Point, q: Point, point: Point) -> bool {
    let spans = (p[1] > point[1]) != (q[1] > point[1]);
    spans && point[0] < p[0] + (point[1] - p[1]) / (q[1] - p[1]) * (q[0] - p[0])
}

fn distance_to_edge(p: Point, q: Point, point: Point) -> f64 {
    let along = [q[0] - p[0], q[1] - p[1]];
    let to = [point[0] - p[0], point[1] - p[1]];
    let length2 = along[0] * along[0] + along[1] * along[1];
    let dot = to[0] * along[0] + to[1] * along[1];
    let share = if length2 > 0.0 { (dot / length2).clamp(0.0, 1.0) } else { 0.0 };
    (to[0] - share * along[0]).hypot(to[1] - share * along[1])
}

/// Whether edges i < j meet elsewhere than at the corner they share as neighbours.
fn edges_meet(edges: &[(Point, Point)], i: usize, j: usize) -> bool {
    let ((a, b), (c, d)) = (edges[i], edges[j]);
    if edges.len() == 3 {
        return false;
    }
    match (j == i + 1, i == 0 && j + 1 == edges.len()) {
        (true, _) => folds_back(a, b, d),
        (_, true) => folds_back(c, d, b),
        _ => segments_meet(a, b, c, d),
    }
}

/// Whether the way a, b, c turns straight back at b.
fn folds_back(a: Point, b: Point, c: Point) -> bool {
    let ahead = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]);
    turn(a, b, c) == 0.0 && ahead < 0.0
}

fn segments_meet(a: Point, b: Point, c: Point, d: Point) -> bool {
    let boxes_apart = (0..2).any(|k| a[k].max(b[k]) < c[k].min(d[k]) || c[k].max(d[k]) < a[k].min(b[k]));
    if boxes_apart {
        return false;
    }
    turn(a, b, c) * turn(a, b, d) <= 0.0 && turn(c, d, a) * turn(c, d, b) <= 0.0
}

/// The part of a polygon where `height`, linear in the plane, is not negative.
fn clip_to_half_plane(corners: &[Point], height: impl Fn(Point) -> f64) -> Vec<Point> {
    let mut kept = Vec::with_capacity(corners.len() + 4);
    for (p, q) in edges(corners) {
        let (from, to) = (height(p), height(q));
        if from >= 0.0 {
            kept.push(p);
        }
        if (from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0) {
            let share = from / (from - to);
            kept.push([p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])]);
        }
    }
    kept
}

/// Common area of the strips between two edges and a level line; positive where both edges run
/// the same way along x.
fn common_strip(one: (Point, Point), other: (Point, Point), level: f64) -> f64 {
    let left = one.0[0].min(one.1[0]).max(other.0[0].min(other.1[0]));
    let right = one.0[0].max(one.1[0]).min(other.0[0].max(other.1[0]));
    if right <= left {
        return 0.0;
    }
    let ends = [left, right].map(|x| (height_at(one, x) - level, height_at(other, x) - level));
    let same_way = (one.1[0] > one.0[0]) == (other.1[0] > other.0[0]);
    let area = (right - left) * mean_of_lower(ends);
    if same_way { area } else { -area }
}

/// Height of an edge above or below x, between its ends.
fn height_at((p, q): (Point, Point), x: f64) -> f64 {
    let share = (x - p[0]) / (q[0] - p[0]);
    p[1] + share * (q[1] - p[1])
}

/// Mean of the lower of two linear functions, each given by its values at both ends.
fn mean_of_lower([(a, b), (c, d)]: [(f64, f64); 2]) -> f64 {
    let (from, to) = (a - b, c - d);
    if from * to >= 0.0 {
        return 0.5 * (a.min(b) + c.min(d));
    }
    let share = from / (from - to);
    let crossing = a + share * (c - a);
    0.5 * (share * (a.min(b) + crossing) + (1.0 - share) * (crossing + c.min(d)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SLOPE: [Point; 4] = [[0.0, 0.0], [25.0, 0.0], [20.0, 5.0], [0.0, 5.0]];
    const ARROW: [Point; 4] = [[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]];

    fn rectangle(x: f64, y: f64, w: f64, h: f64) -> Vec<Point> {
        vec![[x, y], [x + w, y], [x + w, y + h], [x, y + h]]
    }

    #[test]
    fn area_does_not_depend_on_the_way_round() {
        let back: Vec<_> = SLOPE.iter().rev().copied().collect();
        assert_eq!(area(&SLOPE), 112.5);
        assert_eq!(signed_area(&back), -112.5);
    }

    #[test]
    fn an_inside_point_is_contained_and_an_outside_point_is_not() {
        assert!(contains(&ARROW, [0.5, 0.5]));
        assert!(!contains(&ARROW, [2.0, 1.5]));
        assert!(contains(&SLOPE, [22.4, 2.5]) && !contains(&SLOPE, [22.6, 2.5]));
    }

    #[test]
    fn simple_outlines_and_crossing_ones() {
        assert!(is_simple(&SLOPE) && is_simple(&ARROW));
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert_eq!(crossing(&bow), Some((0, 2)));
        let spike = [[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        assert!(!is_simple(&spike));
        assert_eq!(repeated_corner(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]), Some(0));
    }

    #[test]
    fn clipped_cells_of_a_concave_polygon_add_up_to_its_area() {
        let cells = (0..16).flat_map(|i| (0..16).map(move |j| (i as f64 * 0.3, j as f64 * 0.3)));
        let sum: f64 = cells.map(|(x, y)| area(&clip_to_rect(&ARROW, [x, y], [x + 0.3, y + 0.3]))).sum();
        assert!((sum - area(&ARROW)).abs() < 1e-12);
    }

    #[test]
    fn polygons_that_touch_do_not_overlap() {
        let beside = [[25.0, 0.0], [30.0, 0.0], [30.0, 5.0], [20.0, 5.0]];
        assert!(overlap_area(&SLOPE, &beside) < 1e-12);
        let notch = [[4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.0, 1.0]];
        assert!(overlap_area(&ARROW, &notch) < 1e-12);
    }

    #[test]
    fn distance_is_measured_to_the_nearest_edge() {
        assert_eq!(distance_to_outline(&SLOPE, [20.0, 5.0]), 0.0);
        assert!((distance_to_outline(&SLOPE, [10.0, 7.0]) - 2.0).abs() < 1e-14);
    }

    proptest! {
        #[test]
        fn overlap_of_rectangles_is_the_common_rectangle(
            x in -3.0..3.0, y in -3.0..3.0, w in 0.1..4.0, h in 0.1..4.0)
        {
            let common = |a: f64, b: f64, c: f64| ((a + b).min(c) - a.max(0.0)).max(0.0);
            let exact = common(x, w, 2.0) * common(y, h, 1.0);
            let found = overlap_area(&rectangle(0.0, 0.0, 2.0, 1.0), &rectangle(x, y, w, h));
            prop_assert!((found - exact).abs() < 1e-12);
        }

        #[test]
        fn overlap_with_a_rectangle_is_the_clipped_area(
            x in -1.0..4.0, y in -1.0..4.0, w in 0.1..4.0, h in 0.1..4.0)
        {
            let clipped = area(&clip_to_rect(&ARROW, [x, y], [x + w, y + h]));
            let found = overlap_area(&rectangle(x, y, w, h), &ARROW);
            prop_assert!((found - clipped).abs() < 1e-12);
        }
    }
}
