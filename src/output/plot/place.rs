//! The parts of a line plot on its frame.

use super::axes::{self, Axis, Frame};
use super::canvas::Canvas;
use super::clip;
use super::colour::{BLACK, PALETTE, Rgb, WHITE};
use super::font;
use super::series::{Band, Bar, Curve, Marker, Style};
use super::text::{Align, TICK, TextStyle, fitted};

/// From values to pixels of the plot's frame.
pub struct Place {
    pub frame: Frame,
    pub x: Axis,
    pub y: Axis,
}

impl Place {
    fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.frame.x(self.x.fraction(x)), self.frame.y(self.y.fraction(y)))
    }

    fn holds(&self, (x, y): (f64, f64)) -> bool {
        let inside = |v: f64, lo: i32, hi: i32| v >= f64::from(lo) - 0.5 && v <= f64::from(hi) + 0.5;
        inside(x, self.frame.left, self.frame.right) && inside(y, self.frame.top, self.frame.bottom)
    }

    fn clipped(&self, line: &[(f64, f64)]) -> Vec<clip::Line> {
        let lo = (f64::from(self.frame.left), f64::from(self.frame.top));
        clip::polyline(line, lo, (f64::from(self.frame.right), f64::from(self.frame.bottom)))
    }

    fn column(&self, x: f64) -> i32 {
        self.frame.x(self.x.fraction(x).clamp(0.0, 1.0)).round() as i32
    }

    /// A shaded range of x.
    pub fn band(&self, canvas: &mut Canvas, band: &Band, colour: Rgb) {
        let (from, to) = (self.column(band.from.min(band.to)), self.column(band.from.max(band.to)));
        if from < to {
            canvas.tint((from, self.frame.top), (to, self.frame.bottom), colour, 0.25);
        }
    }

    /// A bar of a histogram.
    pub fn bar(&self, canvas: &mut Canvas, bar: &Bar) {
        let row = |v: f64| self.frame.y(self.y.fraction(v).clamp(0.0, 1.0)).round() as i32;
        // On a logarithmic axis zero lies below the frame.
        let zero = if self.y.fraction(0.0).is_finite() { row(0.0) } else { self.frame.bottom };
        let (from, to) = (self.column(bar.from), self.column(bar.to));
        let (top, bottom) = (row(bar.height).min(zero), row(bar.height).max(zero));
        if from < to && top < bottom {
            canvas.rect((from, top), (to, bottom), Rgb(168, 198, 226));
            canvas.edge((from, top), (to, bottom), 1, PALETTE[0]);
        }
    }

    /// Marker lines, the labels of horizontal ones in the right margin.
    pub fn markers(&self, canvas: &mut Canvas, markers: &[Marker]) {
        let mut labels = Vec::new();
        for marker in markers {
            if marker.vertical {
                self.vertical(canvas, marker);
                continue;
            }
            let y = self.frame.y(self.y.fraction(marker.value));
            if self.holds((self.frame.x(0.0), y)) {
                axes::horizontal(canvas, self.frame, y, BLACK);
                labels.push((y, marker.label.as_str()));
            }
        }
        let x = f64::from(self.frame.right) + 12.0;
        let room = f64::from(canvas.width()) - x - 6.0;
        for (y, label) in spread_out(labels, TICK + 4.0) {
            canvas.text(&fitted(label, TICK, room), (x, y + 0.36 * TICK), TextStyle::new(TICK, Align::Left));
        }
    }

    fn vertical(&self, canvas: &mut Canvas, marker: &Marker) {
        let x = self.frame.x(self.x.fraction(marker.value));
        if self.holds((x, self.frame.y(0.0))) {
            axes::vertical(canvas, self.frame, x, BLACK);
            let end = (x - 8.0, f64::from(self.frame.top) + 12.0);
            let length = font::width(&marker.label, TICK);
            let patch = ((end.0 - 0.85 * TICK) as i32, (end.1 - 6.0) as i32);
            canvas.tint(patch, ((end.0 + 5.0) as i32, (end.1 + length + 6.0) as i32), WHITE, 0.85);
            canvas.text(&marker.label, end, TextStyle::new(TICK, Align::Right).turned(90.0));
        }
    }

    /// A curve with its points and spread.
    pub fn curve(&self, canvas: &mut Canvas, curve: &Curve, colour: Rgb) {
        let points: Vec<_> = curve.points.iter().map(|p| self.at(*p)).collect();
        for (point, (low, high)) in curve.points.iter().zip(&curve.spread) {
            self.error_bar(canvas, (*point, *low, *high), colour);
        }
        if curve.style != Style::Points {
            let line = if curve.style == Style::Step { staircase(&points) } else { points.clone() };
            let width = if curve.thin { 1.5 } else { 3.0 };
            let dash = curve.dashed.then_some((14.0, 9.0));
            self.clipped(&clip::thin(line)).iter().for_each(|part| canvas.line(part, width, colour, dash));
        }
        if matches!(curve.style, Style::Points | Style::LinePoints) || points.len() == 1 {
            points.iter().filter(|p| self.holds(**p)).for_each(|p| canvas.disc(*p, 6.0, colour));
        }
    }

    fn error_bar(&self, canvas: &mut Canvas, ((x, _), low, high): ((f64, f64), f64, f64), colour: Rgb) {
        let (a, b) = (self.at((x, low)), self.at((x, high)));
        let wing = |p: (f64, f64)| [(p.0 - 9.0, p.1), (p.0 + 9.0, p.1)];
        for line in [[a, b], wing(a), wing(b)] {
            self.clipped(&line).iter().for_each(|part| canvas.line(part, 2.0, colour, None));
        }
    }
}

/// Each value holds until the next point.
fn staircase(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let corners = points.windows(2).flat_map(|w| [w[0], (w[1].0, w[0].1)]);
    corners.chain(points.last().copied()).collect()
}

/// Labels from the top down, moved apart to a distance of at least `least` pixels.
pub fn spread_out(mut labels: Vec<(f64, &str)>, least: f64) -> Vec<(f64, &str)> {
    labels.sort_by(|a, b| a.0.total_cmp(&b.0));
    for k in 1..labels.len() {
        labels[k].0 = labels[k].0.max(labels[k - 1].0 + least);
    }
    labels
}
