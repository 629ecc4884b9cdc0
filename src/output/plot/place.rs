//! The parts of a line plot on its frame.

use super::axes::{self, Axis, Frame};
use super::canvas::Canvas;
use super::clip;
use super::colour::{BLACK, Rgb};
use super::font;
use super::series::{Area, Band, Bar, Bars, Curve, Fill, Marker, Style};
use super::text::{Align, TICK, TextStyle, fitted};

/// Pixels above the frame for the labels of vertical markers.
pub const ABOVE: i32 = 48;

/// Between labels that stand side by side (pixels).
const SPACE: f64 = 18.0;
/// Size of what stands on a bar (pixels per em).
const SMALL: f64 = 20.0;

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

    /// The pale area between two curves, column by column, so that it ends at the frame.
    pub fn area(&self, canvas: &mut Canvas, area: &Area, colour: Rgb) {
        let edge = |y: f64| self.frame.y(self.y.fraction(y).clamp(-1.0, 2.0));
        let places =
            area.points.iter().map(|(x, low, high)| (self.frame.x(self.x.fraction(*x)), edge(*low), edge(*high)));
        let places: Vec<_> = places.collect();
        let (first, last) = (f64::from(self.frame.left), f64::from(self.frame.right));
        for pair in places.windows(2) {
            let ((x0, low0, high0), (x1, low1, high1)) = (pair[0], pair[1]);
            if !(x0 < x1 && [low0, high0, low1, high1].iter().all(|y| y.is_finite())) {
                continue;
            }
            for column in x0.clamp(first, last).round() as i32..x1.clamp(first, last).round() as i32 {
                let share = ((f64::from(column) + 0.5 - x0) / (x1 - x0)).clamp(0.0, 1.0);
                let share = if area.style == Style::Step { 0.0 } else { share };
                let (low, high) = (low0 + share * (low1 - low0), high0 + share * (high1 - high0));
                self.strip(canvas, column, (low.min(high), low.max(high)), colour);
            }
        }
    }

    fn strip(&self, canvas: &mut Canvas, column: i32, (top, bottom): (f64, f64), colour: Rgb) {
        let (top, bottom) = ((top.round() as i32).max(self.frame.top), (bottom.round() as i32).min(self.frame.bottom));
        if top < bottom {
            canvas.tint((column, top), (column + 1, bottom), colour, 0.25);
        }
    }

    /// The bars of a histogram.
    pub fn bars(&self, canvas: &mut Canvas, bars: &Bars, colour: Rgb) {
        for (from, to) in bars.bars.iter().filter_map(|bar| self.corners(bar)) {
            match bars.fill {
                Fill::Solid => canvas.rect(from, to, colour.paler(0.6)),
                Fill::Clear => canvas.tint(from, to, colour, 0.35),
                Fill::Hatched => canvas.hatch(from, to, colour),
            }
            canvas.edge(from, to, 1, colour);
        }
    }

    /// Upper left and lower right corner of a bar, if there is anything to see.
    fn corners(&self, bar: &Bar) -> Option<((i32, i32), (i32, i32))> {
        let row = |v: f64| self.frame.y(self.y.fraction(v).clamp(0.0, 1.0)).round() as i32;
        // On a logarithmic axis zero lies below the frame.
        let zero = if self.y.fraction(0.0).is_finite() { row(0.0) } else { self.frame.bottom };
        let (from, to) = (self.column(bar.from), self.column(bar.to));
        let (top, bottom) = (row(bar.height).min(zero), row(bar.height).max(zero));
        (from < to && top < bottom).then_some(((from, top), (to, bottom)))
    }

    /// What stands at the foot of the bars, or above those that are too low; where there is room for it.
    pub fn bar_labels(&self, canvas: &mut Canvas, bars: &Bars) {
        for bar in bars.bars.iter().filter(|bar| !bar.label.is_empty()) {
            if let Some(((left, top), (right, bottom))) = self.corners(bar)
                && font::width(&bar.label, SMALL) <= f64::from(right - left)
            {
                let foot = if f64::from(bottom - top) > 1.6 * SMALL { bottom } else { top };
                let at = (0.5 * f64::from(left + right), f64::from(foot) - 9.0);
                canvas.text_on_patch(&bar.label, at, TextStyle::new(SMALL, Align::Centre));
            }
        }
    }

    /// Marker lines, the labels of horizontal ones in the right margin, of vertical ones above the frame.
    pub fn markers(&self, canvas: &mut Canvas, markers: &[Marker]) {
        let (mut right, mut above) = (Vec::new(), Vec::new());
        for marker in markers {
            let at = match marker.vertical {
                true => (self.frame.x(self.x.fraction(marker.value)), self.frame.y(0.0)),
                false => (self.frame.x(0.0), self.frame.y(self.y.fraction(marker.value))),
            };
            match (self.holds(at), marker.vertical) {
                (true, true) => above.push((at.0, marker.label.as_str())),
                (true, false) => right.push((at.1, marker.label.as_str())),
                (false, _) => {}
            }
        }
        right.iter().for_each(|(y, _)| axes::horizontal(canvas, self.frame, *y, BLACK));
        above.iter().for_each(|(x, _)| axes::vertical(canvas, self.frame, *x, BLACK));
        self.labels_right(canvas, right);
        self.labels_above(canvas, above);
    }

    fn labels_right(&self, canvas: &mut Canvas, labels: Vec<(f64, &str)>) {
        let x = f64::from(self.frame.right) + 12.0;
        let room = f64::from(canvas.width()) - x - 6.0;
        for (y, label) in spread_out(labels, TICK + 4.0) {
            canvas.text(&fitted(label, TICK, room), (x, y + 0.36 * TICK), TextStyle::new(TICK, Align::Left));
        }
    }

    /// Labels side by side, each joined to its line.
    fn labels_above(&self, canvas: &mut Canvas, labels: Vec<(f64, &str)>) {
        let most = (f64::from(canvas.width()) - 20.0) / labels.len().max(1) as f64 - SPACE;
        let cut: Vec<(f64, String)> = labels.into_iter().map(|(x, label)| (x, fitted(label, TICK, most))).collect();
        let widths: Vec<(f64, f64)> = cut.iter().map(|(x, label)| (*x, font::width(label, TICK) + SPACE)).collect();
        let top = f64::from(self.frame.top);
        let middles = side_by_side(&widths, (10.0, f64::from(canvas.width()) - 10.0));
        for (((x, label), (_, width)), middle) in cut.iter().zip(&widths).zip(middles) {
            // To the nearest place below the label.
            let reach = 0.5 * width - SPACE;
            let foot = if reach > 0.0 { x.clamp(middle - reach, middle + reach) } else { middle };
            canvas.line(&[(*x, top), (foot, top - 14.0)], 1.5, BLACK, None);
            canvas.text(label, (middle, top - 20.0), TextStyle::new(TICK, Align::Centre));
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
            let radius = |k: usize| curve.radii.get(k).copied().filter(|r| *r > 0.0 && r.is_finite()).unwrap_or(6.0);
            let dots = points.iter().enumerate().filter(|(_, p)| self.holds(**p));
            dots.for_each(|(k, p)| canvas.disc(*p, radius(k), colour));
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

/// Middles of labels that stand on one line between `lo` and `hi`, in the order of the places they
/// belong to and as near to them as their widths allow: (place, width) of each (pixels). They fit if their widths do.
pub fn side_by_side(labels: &[(f64, f64)], (lo, hi): (f64, f64)) -> Vec<f64> {
    let mut order: Vec<usize> = (0..labels.len()).collect();
    order.sort_by(|a, b| labels[*a].0.total_cmp(&labels[*b].0));
    let mut middles = vec![0.0; labels.len()];
    let mut end = lo;
    for k in &order {
        let (place, width) = labels[*k];
        middles[*k] = place.max(end + 0.5 * width);
        end = middles[*k] + 0.5 * width;
    }
    // What was pushed too far comes back from the other end.
    let mut start = hi;
    for k in order.iter().rev() {
        let width = labels[*k].1;
        middles[*k] = f64::min(middles[*k], start - 0.5 * width);
        start = middles[*k] - 0.5 * width;
    }
    middles
}
