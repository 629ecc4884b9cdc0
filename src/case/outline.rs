//! Outlines of regions: what they hold, how far they reach, what may be wrong with them.

use crate::math::polygon::{self, Point};

use super::RegionShape;
use super::limits::figure;
use super::log::Problem;

/// Most corners of a polygon.
const MOST_CORNERS: usize = 1000;

/// How far the soil reaches, and its crest.
pub(super) struct Extent {
    /// Leftmost x and lowest y (m).
    pub low: Point,
    /// Rightmost x and highest y (m).
    pub high: Point,
    /// The rightmost of the highest corners; `None` without a polygon.
    pub crest: Option<Point>,
}

impl Extent {
    /// The extent of several shapes; `None` without any.
    pub fn of(shapes: &[&RegionShape]) -> Option<Self> {
        let boxes = shapes.iter().map(|shape| shape.bounds());
        let [low, high] =
            boxes.reduce(|[a, b], [c, d]| [[a[0].min(c[0]), a[1].min(c[1])], [b[0].max(d[0]), b[1].max(d[1])]])?;
        Some(Self { low, high, crest: crest(shapes) })
    }

    /// The longer side of the rectangle around the soil (m).
    pub fn size(&self) -> f64 {
        (self.high[0] - self.low[0]).max(self.high[1] - self.low[1])
    }
}

/// The right end of the highest part of the outline.
fn crest(shapes: &[&RegionShape]) -> Option<Point> {
    let corners = shapes.iter().flat_map(|shape| match shape {
        RegionShape::Polygon(corners) => corners.as_slice(),
        RegionShape::Circle { .. } => &[],
    });
    corners.copied().max_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])))
}

/// What keeps corners from being the outline of a region.
pub(super) fn problem(corners: &[Point]) -> Option<Problem> {
    let n = corners.len();
    if !(3..=MOST_CORNERS).contains(&n) {
        let message = format!("this polygon has {n} corners");
        return Some(Problem::new(message, format!("must have from 3 to {MOST_CORNERS}")));
    }
    repeated(corners).or_else(|| crossing(corners)).or_else(|| flat(corners))
}

fn repeated(corners: &[Point]) -> Option<Problem> {
    let corner = polygon::repeated_corner(corners)?;
    let at = corners.get(corner).copied().map(place).unwrap_or_default();
    let message = format!("this polygon repeats the corner {at}");
    let problem = Problem::new(message, "each corner stands once");
    Some(problem.help("the last corner is joined to the first: do not write the first twice"))
}

fn crossing(corners: &[Point]) -> Option<Problem> {
    let (i, j) = polygon::crossing(corners)?;
    let edge = |k: usize| {
        let ends = [k, (k + 1) % corners.len()].map(|end| corners.get(end).copied());
        let [from, to] = ends.map(|end| end.map(place).unwrap_or_default());
        format!("{from}-{to}")
    };
    let message = format!("this polygon meets itself: edge {} and edge {}", edge(i), edge(j));
    let help = "give the corners in order along the outline";
    Some(Problem::new(message, "the edges of an outline do not meet").help(help))
}

fn flat(corners: &[Point]) -> Option<Problem> {
    let [low, high] = polygon::bounds(corners);
    let size = (high[0] - low[0]).max(high[1] - low[1]);
    let flat = polygon::area(corners) <= 1e-9 * size * size;
    flat.then(|| Problem::new("this polygon has no area", "its corners lie on a line"))
}

/// A point as people write it.
pub(super) fn place([x, y]: Point) -> String {
    format!("({}, {})", figure(x), figure(y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slope() -> RegionShape {
        RegionShape::Polygon(vec![[0.0, 0.0], [25.0, 0.0], [20.0, 5.0], [0.0, 5.0]])
    }

    #[test]
    fn the_crest_is_the_right_end_of_the_top() {
        let extent = Extent::of(&[&slope()]).expect("one shape");
        assert_eq!(extent.crest, Some([20.0, 5.0]));
        assert_eq!(extent.size(), 25.0);
    }

    #[test]
    fn areas_in_cells_add_up() {
        let disc = RegionShape::Circle { center: [0.5, 0.5], radius: 0.5 };
        let half = disc.area_in([0.0, 0.0], [0.5, 1.0]);
        assert!((2.0 * half - disc.area()).abs() < 1e-14);
        assert_eq!(slope().area_in([20.0, 0.0], [30.0, 10.0]), 12.5);
    }

    #[test]
    fn a_disc_on_a_slope_touches_without_overlap() {
        let disc = RegionShape::Circle { center: [10.0, 6.0], radius: 1.0 };
        assert!(slope().overlap_area(&disc) < 1e-12);
        assert!(slope().reaches([20.0, 5.0], 1e-6) && !slope().reaches([20.0, 5.1], 1e-6));
    }
}
