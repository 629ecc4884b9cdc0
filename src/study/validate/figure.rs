//! Curves that say more than a number.

use std::io;

use serde::Serialize;

use crate::output::plot::{self, AxisSpec, Rgb, SeriesPlot, Style};

/// A picture of a problem: what is drawn, and in `validate.json` the numbers behind it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    pub title: String,
    /// What a reader should see in it.
    pub caption: String,
    pub x: Axis,
    pub y: Axis,
    pub lines: Vec<Line>,
}

/// An axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    pub logarithmic: bool,
}

/// A named curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    pub name: String,
    pub kind: Kind,
    pub points: Vec<(f64, f64)>,
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// What the program says, at many points.
    Line,
    /// What it says at a few, joined.
    Marked,
    /// What it says at points that are not joined.
    Points,
    /// The exact answer, or a guide to the eye.
    Exact,
}

/// Exact answers, and guides to the eye.
const GREY: Rgb = Rgb(90, 90, 90);

/// Largest number of points of a curve: a picture has 1600 pixels.
const MOST: usize = 800;

impl Figure {
    /// An empty figure over linear axes.
    pub fn new(title: &str, caption: &str, x: &str, y: &str) -> Self {
        let axis = |label: &str| Axis { label: label.to_owned(), logarithmic: false };
        Figure { title: title.into(), caption: caption.into(), x: axis(x), y: axis(y), lines: Vec::new() }
    }

    /// Errors over sizes, on logarithmic axes.
    pub fn convergence(title: &str, caption: &str, x: &str, y: &str) -> Self {
        let mut figure = Figure::new(title, caption, x, y);
        (figure.x.logarithmic, figure.y.logarithmic) = (true, true);
        figure
    }

    /// With one more curve; thinned to what a picture can show.
    pub fn with(mut self, name: impl Into<String>, kind: Kind, points: Vec<(f64, f64)>) -> Self {
        let stride = points.len().div_ceil(MOST).max(1);
        let points = points.into_iter().step_by(stride).collect();
        self.lines.push(Line { name: name.into(), kind, points });
        self
    }

    /// With the slope of an order, drawn below all errors that are there: y = c x^order.
    pub fn with_slope(self, order: i32) -> Self {
        let lines = || self.lines.iter().filter(|l| l.kind != Kind::Exact);
        let all = || lines().flat_map(|l| &l.points).filter(|p| p.0 > 0.0 && p.1 > 0.0);
        let (low, high) = all().fold((f64::INFINITY, 0.0_f64), |(a, b), p| (a.min(p.0), b.max(p.0)));
        let factor = all().map(|p| p.1 / p.0.powi(order)).fold(f64::INFINITY, f64::min);
        if !(factor.is_finite() && low < high) {
            return self;
        }
        let guide = [low, high].map(|x| (x, 0.6 * factor * x.powi(order))).to_vec();
        self.with(format!("slope {order}"), Kind::Exact, guide)
    }

    /// The picture as a PNG file.
    ///
    /// # Errors
    /// As [`plot::series_png`].
    pub fn png(&self) -> io::Result<Vec<u8>> {
        let axis = |a: &Axis| if a.logarithmic { AxisSpec::log(&a.label) } else { AxisSpec::linear(&a.label) };
        plot::series_png(&SeriesPlot {
            title: Some(self.title.clone()),
            x: axis(&self.x),
            y: axis(&self.y),
            curves: self.lines.iter().map(Line::curve).collect(),
            width: 1400,
            height: 800,
            ..SeriesPlot::default()
        })
    }
}

impl Line {
    fn curve(&self) -> plot::Curve {
        let style = match self.kind {
            Kind::Line | Kind::Exact => Style::Line,
            Kind::Marked => Style::LinePoints,
            Kind::Points => Style::Points,
        };
        let dashed = self.kind == Kind::Exact;
        let colour = dashed.then_some(GREY);
        plot::Curve { dashed, colour, ..plot::Curve::new(&self.name, style, self.points.clone()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_lies_below_all_errors_and_has_its_order() {
        let figure = Figure::convergence("t", "c", "h", "e")
            .with("a", Kind::Marked, vec![(1.0, 2.0), (0.5, 0.1), (0.25, f64::NAN)])
            .with_slope(2);
        let [(low, a), (high, b)] = figure.lines[1].points[..] else { panic!("{figure:?}") };
        assert!((low, high) == (0.5, 1.0) && (b / a - 4.0).abs() < 1e-12 && a < 0.1 && b < 2.0);
        assert!(figure.png().unwrap().starts_with(b"\x89PNG"));
    }

    #[test]
    fn a_long_curve_is_thinned_and_no_error_has_no_slope() {
        let figure = Figure::new("t", "c", "x", "y").with("a", Kind::Line, vec![(1.0, 0.0); 5000]).with_slope(1);
        assert_eq!((figure.lines.len(), figure.lines[0].points.len()), (1, 715));
    }
}
