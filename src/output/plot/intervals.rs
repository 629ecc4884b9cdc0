//! Spread and median of a result for several variants side by side.

use std::io;
use std::path::Path;

use super::axes::{self, Axes, Axis, AxisSpec, BELOW, Frame, Scale, left_margin};
use super::canvas::{self, Canvas};
use super::colour::{BLACK, PALETTE, Rgb};
use super::font;
use super::place::spread_out;
use super::text::{Align, LABEL, TICK, TITLE, TextStyle, fitted};

/// A plot with one interval per variant.
#[derive(Clone, Debug)]
pub struct IntervalPlot {
    /// Line at the top.
    pub title: Option<String>,
    /// What the variants differ in.
    pub x_label: String,
    pub y: AxisSpec,
    pub items: Vec<Interval>,
    /// Horizontal dashed lines: value in the unit of y, and label.
    pub markers: Vec<(f64, String)>,
    /// Size of the picture (pixels).
    pub width: u32,
    pub height: u32,
}

impl Default for IntervalPlot {
    fn default() -> Self {
        IntervalPlot {
            title: None,
            x_label: String::new(),
            y: AxisSpec::default(),
            items: Vec::new(),
            markers: Vec::new(),
            width: 1600,
            height: 900,
        }
    }
}

/// One variant, in the unit of y.
#[derive(Clone, Debug, Default)]
pub struct Interval {
    /// Name below the axis.
    pub label: String,
    pub low: f64,
    pub median: f64,
    pub high: f64,
    /// Individual results, drawn as dots.
    pub values: Vec<f64>,
}

/// Draws an interval plot into a PNG file.
///
/// # Errors
/// `InvalidInput` for a picture of impossible size; those of the file system.
pub fn intervals(path: &Path, plot: &IntervalPlot) -> io::Result<()> {
    canvas::save(path, &intervals_png(plot)?)
}

/// The same as a PNG file in memory.
///
/// # Errors
/// As for [`intervals`].
pub fn intervals_png(plot: &IntervalPlot) -> io::Result<Vec<u8>> {
    draw(plot)?.png()
}

pub(super) fn draw(plot: &IntervalPlot) -> io::Result<Canvas> {
    let mut canvas = Canvas::new(plot.width.max(400), plot.height.max(300))?;
    let items = plot.items.iter().flat_map(|i| [i.low, i.median, i.high].into_iter().chain(i.values.iter().copied()));
    let y_axis = plot.y.fit(items.chain(plot.markers.iter().map(|m| m.0)), 0.05);
    let x_axis = Axis::new(0.0, plot.items.len().max(1) as f64, Scale::Linear);
    let names = Names::new(plot, &canvas);
    let top = if plot.title.is_some() { 66 } else { 22 };
    let bottom = canvas.height() - BELOW - 8 - names.extra;
    let y = y_axis.ticks(((bottom - top) / 60).clamp(2, 10) as usize);
    let margin =
        plot.markers.iter().map(|m| font::width(&m.1, TICK)).fold(16.0, f64::max).min(0.3 * f64::from(canvas.width()));
    let frame = Frame { left: left_margin(&y) + 6, top, right: canvas.width() - margin as i32 - 24, bottom };
    let axes = Axes { x: &[], y: &y, x_axis, y_axis, x_label: "", y_label: &plot.y.label, x_numbers: false };
    axes.draw_grid(&mut canvas, frame);
    draw_markers(&mut canvas, frame, &y_axis, &plot.markers);
    for (k, item) in plot.items.iter().enumerate() {
        let x = frame.x(x_axis.fraction(k as f64 + 0.5));
        let half = (0.3 * frame.x(x_axis.fraction(1.0)) - 0.3 * f64::from(frame.left)).clamp(2.0, 60.0);
        draw_item(&mut canvas, frame, &y_axis, item, (x, half), PALETTE[k % PALETTE.len()]);
        names.draw(&mut canvas, &item.label, x, frame.bottom);
    }
    axes.draw(&mut canvas, frame);
    draw_titles(&mut canvas, plot, frame);
    Ok(canvas)
}

fn draw_titles(canvas: &mut Canvas, plot: &IntervalPlot, frame: Frame) {
    if let Some(title) = &plot.title {
        let title = fitted(title, TITLE, f64::from(canvas.width()) - 40.0);
        canvas.text(&title, (frame.x(0.5), 42.0), TextStyle::new(TITLE, Align::Centre));
    }
    let at = (frame.x(0.5), f64::from(canvas.height()) - 23.0);
    canvas.text(&fitted(&plot.x_label, LABEL, f64::from(frame.width())), at, TextStyle::new(LABEL, Align::Centre));
}

fn draw_markers(canvas: &mut Canvas, frame: Frame, y_axis: &Axis, markers: &[(f64, String)]) {
    let mut labels = Vec::new();
    for (value, label) in markers {
        let fraction = y_axis.fraction(*value);
        if (0.0..=1.0).contains(&fraction) {
            axes::horizontal(canvas, frame, frame.y(fraction), BLACK);
            labels.push((frame.y(fraction), label.as_str()));
        }
    }
    let x = f64::from(frame.right) + 12.0;
    let room = f64::from(canvas.width()) - x - 6.0;
    for (y, label) in spread_out(labels, TICK + 4.0) {
        canvas.text(&fitted(label, TICK, room), (x, y + 0.36 * TICK), TextStyle::new(TICK, Align::Left));
    }
}

/// A pale box from low to high, a bar at the median, and the dots.
fn draw_item(canvas: &mut Canvas, frame: Frame, y_axis: &Axis, item: &Interval, (x, half): (f64, f64), colour: Rgb) {
    let row = |v: f64| {
        let fraction = y_axis.fraction(v);
        fraction.is_finite().then(|| frame.y(fraction.clamp(0.0, 1.0)).round() as i32)
    };
    let (left, right) = ((x - half).round() as i32, (x + half).round() as i32);
    if let (Some(low), Some(high)) = (row(item.low), row(item.high)) {
        let (top, bottom) = (low.min(high), low.max(high).max(low.min(high) + 2));
        canvas.tint((left, top), (right, bottom), colour, 0.25);
        canvas.edge((left, top), (right, bottom), 2, colour);
    }
    if let Some(median) = row(item.median) {
        canvas.rect((left - 6, median - 2), (right + 6, median + 3), BLACK);
    }
    for (k, value) in item.values.iter().enumerate() {
        let fraction = y_axis.fraction(*value);
        if (0.0..=1.0).contains(&fraction) {
            canvas.disc((x + half * scatter(k), frame.y(fraction)), 5.0, colour);
        }
    }
}

/// A place of the k-th dot in -0.8..0.8 that keeps neighbours apart (golden section).
fn scatter(k: usize) -> f64 {
    1.6 * ((k as f64 + 0.5) * 0.618_033_988_75).fract() - 0.8
}

/// Names below the axis: level where they have room, turned where not.
struct Names {
    turned: bool,
    /// Pixels that turned names need beyond those of level ones.
    extra: i32,
    most: f64,
}

impl Names {
    fn new(plot: &IntervalPlot, canvas: &Canvas) -> Names {
        let slot = (f64::from(canvas.width()) - 220.0) / plot.items.len().max(1) as f64;
        let widest = plot.items.iter().map(|i| font::width(&i.label, TICK)).fold(0.0, f64::max);
        let turned = widest > slot - 10.0;
        let most = if turned { 0.35 * f64::from(canvas.height()) } else { slot };
        let extra = if turned { (widest.min(most) - TICK).max(0.0) as i32 } else { 0 };
        Names { turned, extra, most }
    }

    fn draw(&self, canvas: &mut Canvas, label: &str, x: f64, bottom: i32) {
        let label = fitted(label, TICK, self.most);
        let bottom = f64::from(bottom);
        if self.turned {
            let style = TextStyle::new(TICK, Align::Right).turned(90.0);
            canvas.text(&label, (x + 0.36 * TICK, bottom + 14.0), style);
        } else {
            canvas.text(&label, (x, bottom + 34.0), TextStyle::new(TICK, Align::Centre));
        }
    }
}
