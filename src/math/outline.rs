//! Outlines of plane regions: polygons and circles.

use serde::Serialize;

use super::{
    circle,
    polygon::{self, Point},
};

/// Outline of a region, in metres.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outline {
    /// Corners in order, either way round (m).
    Polygon(Vec<Point>),
    Circle {
        center: Point,
        radius: f64,
    },
}

impl Outline {
    /// Whether a point lies inside.
    pub fn contains(&self, point: Point) -> bool {
        match self {
            Outline::Polygon(corners) => polygon::contains(corners, point),
            Outline::Circle { center, radius } => distance(*center, point) < *radius,
        }
    }

    /// Whether a point lies inside or no farther than `near` (m) from the outline.
    pub fn reaches(&self, point: Point, near: f64) -> bool {
        match self {
            Outline::Polygon(corners) => self.contains(point) || polygon::distance_to_outline(corners, point) <= near,
            Outline::Circle { center, radius } => distance(*center, point) <= radius + near,
        }
    }

    /// Lower left and upper right corner of the smallest upright rectangle around the shape (m).
    pub fn bounds(&self) -> [Point; 2] {
        match self {
            Outline::Polygon(corners) => polygon::bounds(corners),
            Outline::Circle { center: [x, y], radius: r } => [[x - r, y - r], [x + r, y + r]],
        }
    }

    /// Area (m2).
    pub fn area(&self) -> f64 {
        match self {
            Outline::Polygon(corners) => polygon::area(corners),
            Outline::Circle { radius, .. } => std::f64::consts::PI * radius * radius,
        }
    }

    /// Area (m2) inside the upright rectangle from `min` to `max`; exact but for round-off, for
    /// circles too.
    pub fn area_in(&self, min: Point, max: Point) -> f64 {
        match self {
            Outline::Polygon(corners) => polygon::area(&polygon::clip_to_rect(corners, min, max)),
            Outline::Circle { center, radius } => {
                let rectangle = [min, [max[0], min[1]], max, [min[0], max[1]]];
                circle::overlap_with_polygon(*center, *radius, &rectangle)
            }
        }
    }

    /// Corners of a polygon, or of a polygon of 64 corners in a circle: to draw it.
    pub fn corners(&self) -> Vec<Point> {
        match self {
            Outline::Polygon(corners) => corners.clone(),
            Outline::Circle { center: [x, y], radius: r } => {
                let turn = std::f64::consts::TAU / 64.0;
                (0..64).map(|k| (f64::from(k) * turn).sin_cos()).map(|(s, c)| [x + r * c, y + r * s]).collect()
            }
        }
    }

    /// Length of the vertical line above `x` that runs through the region (m).
    pub fn height_above(&self, x: Point) -> f64 {
        let mut crossings = self.vertical_crossings(x[0]);
        crossings.sort_by(f64::total_cmp);
        crossings.chunks_exact(2).map(|pair| (pair[1] - pair[0].max(x[1])).max(0.0)).sum()
    }

    fn vertical_crossings(&self, x: f64) -> Vec<f64> {
        match self {
            Outline::Polygon(corners) => {
                let next = corners.iter().cycle().skip(1);
                let edges = corners.iter().zip(next).filter(|(a, b)| (a[0] > x) != (b[0] > x));
                edges.map(|(a, b)| a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0])).collect()
            }
            Outline::Circle { center, radius } => {
                let half = (radius * radius - (x - center[0]).powi(2)).max(0.0).sqrt();
                vec![center[1] - half, center[1] + half]
            }
        }
    }

    /// Area (m2) common to two shapes; exact but for round-off.
    pub fn overlap_area(&self, other: &Outline) -> f64 {
        use Outline::{Circle, Polygon};
        match (self, other) {
            (Polygon(a), Polygon(b)) => polygon::overlap_area(a, b),
            (Polygon(corners), Circle { center, radius }) | (Circle { center, radius }, Polygon(corners)) => {
                circle::overlap_with_polygon(*center, *radius, corners)
            }
            (Circle { center: a, radius: r }, Circle { center: b, radius: s }) => {
                circle::overlap_with_circle(distance(*a, *b), *r, *s)
            }
        }
    }
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn height_above_a_point() {
        let slope = Outline::Polygon(vec![[0.0, 0.0], [25.0, 0.0], [20.0, 5.0], [0.0, 5.0]]);
        assert!((slope.height_above([10.0, 2.0]) - 3.0).abs() < 1e-12);
        assert!((slope.height_above([22.0, 1.0]) - 2.0).abs() < 1e-12);
        let disc = Outline::Circle { center: [0.0, 0.0], radius: 2.0 };
        assert!((disc.height_above([0.0, 1.0]) - 1.0).abs() < 1e-12);
    }
}
