//! Line plots: curves, staircases, points with spread, bars, marker lines and bands.

use std::io;
use std::path::Path;

use super::axes::{Axes, Axis, AxisSpec, BELOW, Frame, left_margin};
use super::canvas::{self, Canvas};
use super::colour::{PALETTE, Rgb};
use super::font;
use super::legend::{Entry, Rows, Symbol};
use super::place::Place;
use super::text::{Align, TICK, TITLE, TextStyle, fitted};

/// A plot of curves over one pair of axes.
#[derive(Clone, Debug)]
pub struct SeriesPlot {
    /// Line at the top.
    pub title: Option<String>,
    pub x: AxisSpec,
    pub y: AxisSpec,
    pub curves: Vec<Curve>,
    pub bars: Vec<Bar>,
    pub markers: Vec<Marker>,
    pub bands: Vec<Band>,
    /// Size of the picture (pixels).
    pub width: u32,
    pub height: u32,
}

impl Default for SeriesPlot {
    fn default() -> Self {
        SeriesPlot {
            title: None,
            x: AxisSpec::default(),
            y: AxisSpec::default(),
            curves: Vec::new(),
            bars: Vec::new(),
            markers: Vec::new(),
            bands: Vec::new(),
            width: 1600,
            height: 900,
        }
    }
}

/// How a curve joins its points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    #[default]
    Line,
    /// Staircase: each value holds until the next point.
    Step,
    Points,
    LinePoints,
}

/// A named curve. A point that is not finite interrupts it.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    /// Name in the legend; none where empty.
    pub name: String,
    /// Points (x, y) in the units of the axes.
    pub points: Vec<(f64, f64)>,
    /// Lowest and highest y at each point; empty where there is no spread.
    pub spread: Vec<(f64, f64)>,
    pub style: Style,
    pub dashed: bool,
    /// A thin line, for one of many.
    pub thin: bool,
    /// The next one of [`PALETTE`] where `None`.
    pub colour: Option<Rgb>,
}

impl Curve {
    /// A curve in a style.
    pub fn new(name: impl Into<String>, style: Style, points: Vec<(f64, f64)>) -> Curve {
        Curve { name: name.into(), points, style, ..Curve::default() }
    }
}

/// A bar of a histogram, from 0 up (or down) to `height`.
#[derive(Clone, Copy, Debug)]
pub struct Bar {
    pub from: f64,
    pub to: f64,
    pub height: f64,
}

/// A dashed line across the plot with a label in the margin.
#[derive(Clone, Debug)]
pub struct Marker {
    /// y of the line, or x of a vertical one.
    pub value: f64,
    pub label: String,
    pub vertical: bool,
}

/// A shaded range of x, named in the legend.
#[derive(Clone, Debug)]
pub struct Band {
    pub from: f64,
    pub to: f64,
    pub label: String,
}

/// Draws a line plot into a PNG file.
///
/// # Errors
/// `InvalidInput` for a picture of impossible size; those of the file system.
pub fn series(path: &Path, plot: &SeriesPlot) -> io::Result<()> {
    canvas::save(path, &series_png(plot)?)
}

/// The same as a PNG file in memory.
///
/// # Errors
/// As for [`series`].
pub fn series_png(plot: &SeriesPlot) -> io::Result<Vec<u8>> {
    draw(plot)?.png()
}

pub(super) fn draw(plot: &SeriesPlot) -> io::Result<Canvas> {
    let mut canvas = Canvas::new(plot.width.max(400), plot.height.max(300))?;
    let (x_axis, y_axis) = (x_axis(plot), y_axis(plot));
    let rows = Rows::new(legend(plot), f64::from(canvas.width()) - 160.0);
    let top = if plot.title.is_some() { 58 } else { 14 } + rows.height() + 8;
    let y = y_axis.ticks(((canvas.height() - top - BELOW) / 70).clamp(2, 10) as usize);
    let labelled = plot.markers.iter().filter(|m| !m.vertical);
    let margin =
        labelled.map(|m| font::width(&m.label, TICK)).fold(16.0, f64::max).min(0.3 * f64::from(canvas.width()));
    let frame = Frame {
        left: left_margin(&y) + 6,
        top,
        right: canvas.width() - margin as i32 - 24,
        bottom: canvas.height() - BELOW - 8,
    };
    let x = x_axis.ticks((frame.width() / 130).max(2) as usize);
    if let Some(title) = &plot.title {
        let title = fitted(title, TITLE, f64::from(canvas.width()) - 40.0);
        canvas.text(&title, (frame.x(0.5), 42.0), TextStyle::new(TITLE, Align::Centre));
    }
    rows.draw(&mut canvas, frame.x(0.5), top - 8 - rows.height());
    let axes = Axes { x: &x, y: &y, x_axis, y_axis, x_label: &plot.x.label, y_label: &plot.y.label, x_numbers: true };
    let place = Place { frame, x: x_axis, y: y_axis };
    plot.bands.iter().zip(0..).for_each(|(band, k)| place.band(&mut canvas, band, band_colour(k)));
    axes.draw_grid(&mut canvas, frame);
    plot.bars.iter().for_each(|bar| place.bar(&mut canvas, bar));
    place.markers(&mut canvas, &plot.markers);
    plot.curves.iter().zip(0..).for_each(|(curve, k)| place.curve(&mut canvas, curve, colour(curve, k)));
    axes.draw(&mut canvas, frame);
    Ok(canvas)
}

fn x_axis(plot: &SeriesPlot) -> Axis {
    let scattered = plot.curves.iter().any(|c| matches!(c.style, Style::Points | Style::LinePoints));
    let points = plot.curves.iter().flat_map(|c| c.points.iter().map(|p| p.0));
    let bars = plot.bars.iter().flat_map(|b| [b.from, b.to]);
    let markers = plot.markers.iter().filter(|m| m.vertical).map(|m| m.value);
    plot.x.fit(points.chain(bars).chain(markers), if scattered { 0.04 } else { 0.0 })
}

fn y_axis(plot: &SeriesPlot) -> Axis {
    let points = plot.curves.iter().flat_map(|c| c.points.iter().map(|p| p.1));
    let spread = plot.curves.iter().flat_map(|c| c.spread.iter().flat_map(|s| [s.0, s.1]));
    let bars = plot.bars.iter().flat_map(|b| [0.0, b.height]);
    let markers = plot.markers.iter().filter(|m| !m.vertical).map(|m| m.value);
    plot.y.fit(points.chain(spread).chain(bars).chain(markers), 0.05)
}

fn legend(plot: &SeriesPlot) -> Vec<Entry> {
    let curves = plot.curves.iter().enumerate().map(|(k, curve)| {
        let symbol = match curve.style {
            Style::Points => Symbol::Dot,
            _ if curve.dashed => Symbol::Dashes,
            _ => Symbol::Line,
        };
        Entry { name: curve.name.clone(), symbol, colour: colour(curve, k) }
    });
    let bands = plot.bands.iter().zip(0..).map(|(band, k)| Entry {
        name: band.label.clone(),
        symbol: Symbol::Pale,
        colour: band_colour(k),
    });
    curves.chain(bands).filter(|entry| !entry.name.is_empty()).collect()
}

fn colour(curve: &Curve, k: usize) -> Rgb {
    curve.colour.unwrap_or(PALETTE[k % PALETTE.len()])
}

fn band_colour(k: usize) -> Rgb {
    PALETTE[(k + 4) % PALETTE.len()]
}
