//! Exact common areas of circles with polygons and with circles.

use super::polygon::Point;

/// Area common to a simple polygon and a circle, exact.
///
/// The signed sum over the edges of the area that the circle shares with the triangle between
/// the edge and the centre: triangles where the edge lies inside, sectors where it lies outside.
pub fn overlap_with_polygon(center: Point, radius: f64, corners: &[Point]) -> f64 {
    let shift = |p: &Point| [p[0] - center[0], p[1] - center[1]];
    let next = corners.iter().cycle().skip(1);
    let parts = corners.iter().zip(next).map(|(p, q)| edge_share(shift(p), shift(q), radius));
    parts.sum::<f64>().abs()
}

/// Area common to two circles whose centres are `distance` apart: nothing, a lens, or the
/// smaller one.
pub fn overlap_with_circle(distance: f64, r: f64, s: f64) -> f64 {
    if distance >= r + s {
        return 0.0;
    }
    if distance <= (r - s).abs() {
        return std::f64::consts::PI * r.min(s).powi(2);
    }
    let chord_at = (distance * distance + r * r - s * s) / (2.0 * distance);
    segment(r, chord_at) + segment(s, distance - chord_at)
}

/// Area of a circle beyond a chord at the signed distance `at` from the centre.
fn segment(radius: f64, at: f64) -> f64 {
    let half_angle = (at / radius).clamp(-1.0, 1.0).acos();
    radius * radius * half_angle - at * (radius * radius - at * at).max(0.0).sqrt()
}

/// Signed area that the circle about the origin shares with the triangle (0, p, q).
fn edge_share(p: Point, q: Point, radius: f64) -> f64 {
    let d = [q[0] - p[0], q[1] - p[1]];
    let (a, b) = (dot(d, d), dot(p, d));
    let discriminant = b * b - a * (dot(p, p) - radius * radius);
    if a == 0.0 || discriminant <= 0.0 {
        return sector(p, q, radius);
    }
    let root = discriminant.sqrt();
    let (enter, leave) = (((-b - root) / a).clamp(0.0, 1.0), ((-b + root) / a).clamp(0.0, 1.0));
    let at = |t: f64| [p[0] + t * d[0], p[1] + t * d[1]];
    let (u, v) = (at(enter), at(leave));
    sector(p, u, radius) + 0.5 * cross(u, v) + sector(v, q, radius)
}

/// Signed area of the sector between the directions of p and q.
fn sector(p: Point, q: Point, radius: f64) -> f64 {
    0.5 * radius * radius * cross(p, q).atan2(dot(p, q))
}

fn dot(p: Point, q: Point) -> f64 {
    p[0] * q[0] + p[1] * q[1]
}

fn cross(p: Point, q: Point) -> f64 {
    p[0] * q[1] - p[1] * q[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const SQUARE: [Point; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

    #[test]
    fn a_square_holds_a_quarter_of_a_circle_at_its_corner() {
        assert!((overlap_with_polygon([0.0, 0.0], 0.8, &SQUARE) - PI * 0.16).abs() < 1e-14);
    }

    #[test]
    fn whole_circle_inside_and_whole_square_inside() {
        assert!((overlap_with_polygon([0.5, 0.5], 0.3, &SQUARE) - PI * 0.09).abs() < 1e-14);
        assert!((overlap_with_polygon([0.5, 0.5], 3.0, &SQUARE) - 1.0).abs() < 1e-14);
        assert!(overlap_with_polygon([3.0, 0.5], 1.0, &SQUARE) < 1e-14);
    }

    #[test]
    fn a_chord_through_the_centre_halves_the_circle() {
        assert!((overlap_with_polygon([0.0, 0.5], 0.4, &SQUARE) - PI * 0.08).abs() < 1e-14);
    }

    #[test]
    fn cells_of_a_circle_add_up_to_its_area() {
        let sum: f64 = (0..100)
            .map(|k| [(k % 10) as f64 * 0.25 - 1.2, (k / 10) as f64 * 0.25 - 1.3])
            .map(|[x, y]| SQUARE.map(|p| [x + 0.25 * p[0], y + 0.25 * p[1]]))
            .map(|cell| overlap_with_polygon([0.0, 0.0], 1.0, &cell))
            .sum();
        assert!((sum - PI).abs() < 1e-13);
    }

    #[test]
    fn circles_apart_touching_crossing_and_nested() {
        assert_eq!(overlap_with_circle(2.0, 1.0, 1.0), 0.0);
        assert_eq!(overlap_with_circle(0.5, 2.0, 1.0), PI);
        let lens = 2.0 * PI / 3.0 - 3f64.sqrt() / 2.0;
        assert!((overlap_with_circle(1.0, 1.0, 1.0) - lens).abs() < 1e-14);
    }
}
