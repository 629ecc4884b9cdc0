//! Axes: from values to pixels, ticks, labels.

use super::canvas::Canvas;
use super::colour::{BLACK, GRID, Rgb};
use super::font;
use super::text::{Align, LABEL, TICK, TextStyle, fitted};
use super::ticks;

/// How an axis counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    #[default]
    Linear,
    /// Powers of ten; values that are not above zero are left out.
    Log,
}

/// An axis as the user of a plot describes it.
#[derive(Clone, Debug, Default)]
pub struct AxisSpec {
    /// Quantity and unit, such as `time (s)`.
    pub label: String,
    pub scale: Scale,
    /// Ends of the axis in its unit; from the data where `None`.
    pub range: Option<(f64, f64)>,
}

impl AxisSpec {
    /// A linear axis that takes its range from the data.
    pub fn linear(label: impl Into<String>) -> AxisSpec {
        AxisSpec { label: label.into(), ..AxisSpec::default() }
    }

    /// A logarithmic axis that takes its range from the data.
    pub fn log(label: impl Into<String>) -> AxisSpec {
        AxisSpec { label: label.into(), scale: Scale::Log, range: None }
    }

    /// The axis for these values, with a share `pad` of the range added at both ends. A linear
    /// axis starts at 0 if the values come near it and none is negative.
    pub(super) fn fit(&self, values: impl Iterator<Item = f64>, pad: f64) -> Axis {
        if let Some((lo, hi)) = self.range {
            return Axis::new(lo, hi, self.scale);
        }
        let usable = |v: &f64| v.is_finite() && (self.scale == Scale::Linear || *v > 0.0);
        let widen = |(lo, hi): (f64, f64), v: f64| (lo.min(v), hi.max(v));
        let (lo, hi) = values.filter(usable).fold((f64::INFINITY, f64::NEG_INFINITY), widen);
        if lo > hi {
            return Axis::new(f64::NAN, f64::NAN, self.scale);
        }
        if self.scale == Scale::Log {
            let axis = Axis::new(lo, hi, Scale::Log);
            let factor = (axis.hi / axis.lo).powf(pad).max(1.0);
            return Axis::new(axis.lo / factor, axis.hi * factor, Scale::Log);
        }
        let (lo, hi) = ticks::sane_range(lo, hi);
        let room = pad * (hi - lo);
        let start = if lo >= 0.0 && lo < 0.3 * hi { 0.0 } else { lo - room };
        Axis::new(start, hi + room, Scale::Linear)
    }
}

/// An axis with its ends.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    pub lo: f64,
    pub hi: f64,
    pub scale: Scale,
}

impl Axis {
    pub fn new(lo: f64, hi: f64, scale: Scale) -> Axis {
        let (lo, hi) = match scale {
            Scale::Linear => ticks::sane_range(lo, hi),
            Scale::Log => ticks::sane_log_range(lo, hi),
        };
        Axis { lo, hi, scale }
    }

    /// 0 at the low end, 1 at the high end; not finite for a value without a place.
    pub fn fraction(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.lo) / (self.hi - self.lo),
            Scale::Log => (value / self.lo).ln() / (self.hi / self.lo).ln(),
        }
    }

    /// Values and labels of the ticks, about `target` of them.
    pub fn ticks(&self, target: usize) -> Vec<(f64, String)> {
        match self.scale {
            Scale::Linear => {
                let (values, step) = ticks::linear(self.lo, self.hi, target);
                let labels = ticks::labels(&values, step);
                values.into_iter().zip(labels).collect()
            }
            Scale::Log => {
                let values = ticks::logarithmic(self.lo, self.hi, target);
                let labels = ticks::log_labels(&values);
                values.into_iter().zip(labels).collect()
            }
        }
    }

    fn minor(&self) -> Vec<f64> {
        match self.scale {
            Scale::Linear => Vec::new(),
            Scale::Log => ticks::logarithmic_minor(self.lo, self.hi),
        }
    }
}

/// The rectangle of a plot (pixels).
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub left: i32,
    pub top: i32,
    pub right: i32,
    pub bottom: i32,
}

impl Frame {
    pub fn x(&self, fraction: f64) -> f64 {
        f64::from(self.left) + fraction * f64::from(self.right - self.left)
    }

    pub fn y(&self, fraction: f64) -> f64 {
        f64::from(self.bottom) - fraction * f64::from(self.bottom - self.top)
    }

    pub fn width(&self) -> i32 {
        self.right - self.left
    }

    pub fn height(&self) -> i32 {
        self.bottom - self.top
    }
}

/// Pixels below the frame for numbers and a label.
pub const BELOW: i32 = 86;
const TICK_LENGTH: i32 = 8;

/// Both axes of a frame, ready to draw.
pub struct Axes<'a> {
    pub x: &'a [(f64, String)],
    pub y: &'a [(f64, String)],
    pub x_axis: Axis,
    pub y_axis: Axis,
    pub x_label: &'a str,
    pub y_label: &'a str,
    /// Whether numbers stand below the frame.
    pub x_numbers: bool,
}

impl Axes<'_> {
    /// Faint lines at the ticks.
    pub fn draw_grid(&self, canvas: &mut Canvas, frame: Frame) {
        for x in self.x_at(frame, self.x.iter().map(|t| t.0)) {
            canvas.rect((x, frame.top), (x + 1, frame.bottom), GRID);
        }
        for y in self.y_at(frame, self.y.iter().map(|t| t.0)) {
            canvas.rect((frame.left, y), (frame.right, y + 1), GRID);
        }
    }

    /// Edge, ticks, numbers and labels.
    pub fn draw(&self, canvas: &mut Canvas, frame: Frame) {
        canvas.edge((frame.left - 2, frame.top - 2), (frame.right + 2, frame.bottom + 2), 2, BLACK);
        self.draw_x(canvas, frame);
        self.draw_y(canvas, frame);
    }

    fn draw_x(&self, canvas: &mut Canvas, frame: Frame) {
        for x in self.x_at(frame, self.x_axis.minor().into_iter()) {
            canvas.rect((x, frame.bottom), (x + 1, frame.bottom + TICK_LENGTH - 2), BLACK);
        }
        for x in self.x_at(frame, self.x.iter().map(|t| t.0)) {
            canvas.rect((x - 1, frame.bottom), (x + 1, frame.bottom + TICK_LENGTH), BLACK);
        }
        if self.x_numbers {
            for (value, label) in self.x {
                let x = frame.x(self.x_axis.fraction(*value));
                canvas.text(label, (x, f64::from(frame.bottom) + 34.0), TextStyle::new(TICK, Align::Centre));
            }
            let middle = (frame.x(0.5), f64::from(frame.bottom) + 71.0);
            let label = fitted(self.x_label, LABEL, f64::from(frame.width()).max(300.0));
            canvas.text(&label, middle, TextStyle::new(LABEL, Align::Centre));
        }
    }

    fn draw_y(&self, canvas: &mut Canvas, frame: Frame) {
        for y in self.y_at(frame, self.y_axis.minor().into_iter()) {
            canvas.rect((frame.left - TICK_LENGTH + 2, y), (frame.left, y + 1), BLACK);
        }
        for y in self.y_at(frame, self.y.iter().map(|t| t.0)) {
            canvas.rect((frame.left - TICK_LENGTH, y - 1), (frame.left, y + 1), BLACK);
        }
        let edge = f64::from(frame.left - TICK_LENGTH - 7);
        for (value, label) in self.y {
            let y = frame.y(self.y_axis.fraction(*value)) + 0.36 * TICK;
            canvas.text(label, (edge, y), TextStyle::new(TICK, Align::Right));
        }
        let x = edge - widest(self.y) - 0.75 * LABEL;
        let label = fitted(self.y_label, LABEL, f64::from(frame.height()).max(110.0));
        canvas.text(&label, (x, frame.y(0.5)), TextStyle::new(LABEL, Align::Centre).turned(90.0));
    }

    fn x_at(&self, frame: Frame, values: impl Iterator<Item = f64>) -> Vec<i32> {
        values.map(|v| frame.x(self.x_axis.fraction(v)).round() as i32).collect()
    }

    fn y_at(&self, frame: Frame, values: impl Iterator<Item = f64>) -> Vec<i32> {
        values.map(|v| frame.y(self.y_axis.fraction(v)).round() as i32).collect()
    }
}

/// Pixels left of a frame for these ticks and a label.
pub fn left_margin(ticks: &[(f64, String)]) -> i32 {
    widest(ticks) as i32 + TICK_LENGTH + 7 + (1.8 * LABEL) as i32
}

fn widest(ticks: &[(f64, String)]) -> f64 {
    ticks.iter().map(|(_, label)| font::width(label, TICK)).fold(0.0, f64::max)
}

/// A 2 px line across the frame at pixel column `x`, dashed.
pub fn vertical(canvas: &mut Canvas, frame: Frame, x: f64, colour: Rgb) {
    let ends = [(x, f64::from(frame.top)), (x, f64::from(frame.bottom))];
    canvas.line(&ends, 2.0, colour, Some((12.0, 8.0)));
}

/// The same at pixel row `y`.
pub fn horizontal(canvas: &mut Canvas, frame: Frame, y: f64, colour: Rgb) {
    let ends = [(f64::from(frame.left), y), (f64::from(frame.right), y)];
    canvas.line(&ends, 2.0, colour, Some((12.0, 8.0)));
}
