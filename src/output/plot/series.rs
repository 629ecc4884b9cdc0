//! Line plots: curves, staircases, points with spread, areas, bars, marker lines and bands.

use std::io;
use std::path::Path;

use super::axes::{Axes, Axis, AxisSpec, BELOW, Frame, left_margin};
use super::canvas::{self, Canvas};
use super::colour::{PALETTE, Rgb};
use super::font;
use super::legend::{Entry, Rows, Symbol};
use super::place::{ABOVE, Place};
use super::text::{Align, TICK, TITLE, TextStyle, fitted};

/// A plot of curves over one pair of axes.
#[derive(Clone, Debug)]
pub struct SeriesPlot {
    /// Line at the top.
    pub title: Option<String>,
    pub x: AxisSpec,
    pub y: AxisSpec,
    pub curves: Vec<Curve>,
    pub areas: Vec<Area>,
    pub bars: Vec<Bars>,
    pub markers: Vec<Marker>,
    pub bands: Vec<Band>,
    /// One unit is as long on both (linear) axes; the frame is narrowed for it.
    pub equal_axes: bool,
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
            areas: Vec::new(),
            bars: Vec::new(),
            markers: Vec::new(),
            bands: Vec::new(),
            equal_axes: false,
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
    /// Radius of the dot at each point (pixels); 6 where there is none.
    pub radii: Vec<f64>,
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

/// The pale area between a lower and an upper curve. A point that is not finite interrupts it.
#[derive(Clone, Debug, Default)]
pub struct Area {
    /// Name in the legend; none where empty.
    pub name: String,
    /// (x, lower y, upper y) in the units of the axes.
    pub points: Vec<(f64, f64, f64)>,
    /// `Step` for a staircase; straight edges for all others.
    pub style: Style,
    /// The next one of [`PALETTE`] where `None`.
    pub colour: Option<Rgb>,
}

/// A named set of bars, such as one histogram.
#[derive(Clone, Debug, Default)]
pub struct Bars {
    /// Name in the legend; none where empty.
    pub name: String,
    pub bars: Vec<Bar>,
    pub fill: Fill,
    /// The next one of [`PALETTE`] where `None`.
    pub colour: Option<Rgb>,
}

/// How bars are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fill {
    #[default]
    Solid,
    /// What lies below shows through.
    Clear,
    /// Slanting strokes: bars that mean something else than those beside them.
    Hatched,
}

/// A bar of a histogram, from 0 up (or down) to `height`.
#[derive(Clone, Debug, Default)]
pub struct Bar {
    pub from: f64,
    pub to: f64,
    pub height: f64,
    /// What stands at its foot; left out where it has no room.
    pub label: String,
}

/// A dashed line across the plot with a label in the margin: to the right, or above for a vertical line.
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
    let head = if plot.title.is_some() { 58 } else { 14 };
    let labels = if plot.markers.iter().any(|m| m.vertical) { ABOVE } else { 0 };
    let top = head + rows.height() + labels + 8;
    let y = y_axis.ticks(((canvas.height() - top - BELOW) / 70).clamp(2, 10) as usize);
    let labelled = plot.markers.iter().filter(|m| !m.vertical);
    let margin =
        labelled.map(|m| font::width(&m.label, TICK)).fold(16.0, f64::max).min(0.3 * f64::from(canvas.width()));
    let room = Frame {
        left: left_margin(&y) + 6,
        top,
        right: canvas.width() - margin as i32 - 24,
        bottom: canvas.height() - BELOW - 8,
    };
    let frame = if plot.equal_axes { equal(room, &x_axis, &y_axis) } else { room };
    let x = x_axis.ticks((frame.width() / 130).max(2) as usize);
    if let Some(title) = &plot.title {
        let title = fitted(title, TITLE, f64::from(canvas.width()) - 40.0);
        canvas.text(&title, (room.x(0.5), 42.0), TextStyle::new(TITLE, Align::Centre));
    }
    rows.draw(&mut canvas, room.x(0.5), head);
    let axes = Axes { x: &x, y: &y, x_axis, y_axis, x_label: &plot.x.label, y_label: &plot.y.label, x_numbers: true };
    draw_data(&mut canvas, plot, &Place { frame, x: x_axis, y: y_axis }, &axes);
    axes.draw(&mut canvas, frame);
    Ok(canvas)
}

/// From what lies behind to what lies in front.
fn draw_data(canvas: &mut Canvas, plot: &SeriesPlot, place: &Place, axes: &Axes<'_>) {
    plot.bands.iter().zip(0..).for_each(|(band, k)| place.band(canvas, band, band_colour(k)));
    axes.draw_grid(canvas, place.frame);
    plot.areas.iter().zip(0..).for_each(|(area, k)| place.area(canvas, area, colour(area.colour, k)));
    plot.bars.iter().zip(0..).for_each(|(bars, k)| place.bars(canvas, bars, colour(bars.colour, k)));
    place.markers(canvas, &plot.markers);
    plot.curves.iter().zip(0..).for_each(|(curve, k)| place.curve(canvas, curve, colour(curve.colour, k)));
    plot.bars.iter().for_each(|bars| place.bar_labels(canvas, bars));
}

/// The largest frame inside another in which a unit is as long on both axes.
pub(super) fn equal(room: Frame, x: &Axis, y: &Axis) -> Frame {
    let (width, height) = (x.hi - x.lo, y.hi - y.lo);
    let scale = (f64::from(room.width()) / width).min(f64::from(room.height()) / height);
    let side = |length: f64, most: i32| ((length * scale).round() as i32).clamp(most.min(100), most);
    let (width, height) = (side(width, room.width()), side(height, room.height()));
    let left = room.left + (room.width() - width) / 2;
    Frame { left, right: left + width, top: room.bottom - height, bottom: room.bottom }
}

/// Gives plots that are to be compared the same axes: those that hold all of them.
pub fn share_axes(plots: &mut [SeriesPlot]) {
    let widest = |axes: Vec<Axis>| {
        let widen = |(lo, hi): (f64, f64), a: &Axis| (lo.min(a.lo), hi.max(a.hi));
        axes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), widen)
    };
    let x = widest(plots.iter().map(x_axis).collect());
    let y = widest(plots.iter().map(y_axis).collect());
    for plot in plots {
        (plot.x.range, plot.y.range) = (Some(x), Some(y));
    }
}

fn x_axis(plot: &SeriesPlot) -> Axis {
    let scattered = plot.curves.iter().any(|c| matches!(c.style, Style::Points | Style::LinePoints));
    let points = plot.curves.iter().flat_map(|c| c.points.iter().map(|p| p.0));
    let areas = plot.areas.iter().flat_map(|a| a.points.iter().map(|p| p.0));
    let bars = plot.bars.iter().flat_map(|b| &b.bars).flat_map(|b| [b.from, b.to]);
    let markers = plot.markers.iter().filter(|m| m.vertical).map(|m| m.value);
    plot.x.fit(points.chain(areas).chain(bars).chain(markers), if scattered { 0.04 } else { 0.0 })
}

fn y_axis(plot: &SeriesPlot) -> Axis {
    let points = plot.curves.iter().flat_map(|c| c.points.iter().map(|p| p.1));
    let spread = plot.curves.iter().flat_map(|c| c.spread.iter().flat_map(|s| [s.0, s.1]));
    let areas = plot.areas.iter().flat_map(|a| a.points.iter().flat_map(|p| [p.1, p.2]));
    let heights = plot.bars.iter().flat_map(|b| &b.bars).flat_map(|b| [0.0, b.height]);
    let markers = plot.markers.iter().filter(|m| !m.vertical).map(|m| m.value);
    plot.y.fit(points.chain(spread).chain(areas).chain(heights).chain(markers), 0.05)
}

fn legend(plot: &SeriesPlot) -> Vec<Entry> {
    let entry = |name: &str, symbol, colour| Entry { name: name.to_owned(), symbol, colour };
    let bars = plot.bars.iter().zip(0..).map(|(bars, k)| {
        let symbol = match bars.fill {
            Fill::Solid | Fill::Clear => Symbol::Bar,
            Fill::Hatched => Symbol::Hatch,
        };
        entry(&bars.name, symbol, colour(bars.colour, k))
    });
    let curves = plot.curves.iter().zip(0..).map(|(curve, k)| {
        let symbol = match curve.style {
            Style::Points => Symbol::Dot,
            _ if curve.dashed => Symbol::Dashes,
            _ => Symbol::Line,
        };
        entry(&curve.name, symbol, colour(curve.colour, k))
    });
    let areas = plot.areas.iter().zip(0..).map(|(area, k)| entry(&area.name, Symbol::Pale, colour(area.colour, k)));
    let bands = plot.bands.iter().zip(0..).map(|(band, k)| entry(&band.label, Symbol::Pale, band_colour(k)));
    bars.chain(curves).chain(areas).chain(bands).filter(|entry| !entry.name.is_empty()).collect()
}

fn colour(given: Option<Rgb>, k: usize) -> Rgb {
    given.unwrap_or(PALETTE[k % PALETTE.len()])
}

fn band_colour(k: usize) -> Rgb {
    PALETTE[(k + 4) % PALETTE.len()]
}
