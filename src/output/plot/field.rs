//! The shape of a slope, coloured by a field; several times one below the other.

use std::io;
use std::path::Path;

use super::annotate::{draw_base, draw_dimension, draw_line};
use super::axes::{Axes, Axis, Frame, Scale};
use super::canvas::{self, Canvas};
use super::kind::FieldKind;
use super::layout::{Layout, Wanted};
use super::look::Look;
use super::points::Raster;
use super::text::{Align, LABEL, TITLE, TextStyle, fitted};
use super::ticks;
use super::view::{View, side};
use crate::snapshot::Snapshot;

/// What a field picture shows.
#[derive(Clone, Debug)]
pub struct FieldOptions {
    pub kind: FieldKind,
    /// Ends of the colour scale in the field's unit; from the data where `None`
    /// ([`FieldKind::automatic_range`]).
    pub range: Option<(f64, f64)>,
    /// Line at the top.
    pub title: Option<String>,
    /// Line above each panel; the time where there is none.
    pub captions: Vec<String>,
    /// Part of the plane (m); all snapshots with a margin where `None`.
    pub view: Option<View>,
    /// Initial geometry, a dashed line through these corners (m).
    pub outline: Vec<[f64; 2]>,
    /// Height of the base, a hatched line (m).
    pub base: Option<f64>,
    pub dimensions: Vec<Dimension>,
    /// Names of the materials in the legend.
    pub material_names: Vec<String>,
    /// Widest gap between points that is closed, in sides of a point. Points at the Gauss
    /// positions of a cell leave seams of 0.155 sides inside the cell and, where the body has
    /// turned, holes of about 0.7 sides.
    pub seam: f64,
    /// Width of the picture (pixels).
    pub width: u32,
}

impl Default for FieldOptions {
    fn default() -> Self {
        FieldOptions {
            kind: FieldKind::PlasticStrain,
            range: None,
            title: None,
            captions: Vec::new(),
            view: None,
            outline: Vec::new(),
            base: None,
            dimensions: Vec::new(),
            material_names: Vec::new(),
            seam: 0.75,
            width: 1600,
        }
    }
}

/// A measured length: a double arrow between two positions with a label.
#[derive(Clone, Debug)]
pub struct Dimension {
    /// Index of the panel, from the top.
    pub panel: usize,
    /// Ends (m).
    pub from: [f64; 2],
    pub to: [f64; 2],
    pub label: String,
}

/// Draws one panel per snapshot, all with one colour scale, into a PNG file.
///
/// # Errors
/// `InvalidInput` for a picture that cannot be drawn (more than 64 panels); those of the file
/// system.
pub fn field(path: &Path, snapshots: &[&Snapshot], options: &FieldOptions) -> io::Result<()> {
    canvas::save(path, &field_png(snapshots, options)?)
}

/// The same as a PNG file in memory.
///
/// # Errors
/// As for [`field`].
pub fn field_png(snapshots: &[&Snapshot], options: &FieldOptions) -> io::Result<Vec<u8>> {
    draw(snapshots, options)?.png()
}

pub(super) fn draw(snapshots: &[&Snapshot], options: &FieldOptions) -> io::Result<Canvas> {
    let look = Look::new(snapshots, options);
    let view = options.view.and_then(View::checked).unwrap_or_else(|| whole_view(snapshots, options));
    let wanted = Wanted {
        panels: snapshots.len(),
        width: options.width,
        title: options.title.is_some(),
        captions: !snapshots.is_empty(),
        legend: look.height(options.width),
    };
    let layout = Layout::new(view, &wanted)?;
    let mut canvas = Canvas::new(layout.width as u32, layout.height as u32)?;
    if let Some(title) = &options.title {
        let title = fitted(title, TITLE, f64::from(layout.width) - 40.0);
        canvas.text(&title, (0.5 * f64::from(layout.width), 42.0), TextStyle::new(TITLE, Align::Centre));
    }
    for k in 0..layout.frames.len() {
        draw_panel(&mut canvas, &layout, k, snapshots.get(k).copied(), options, &look);
    }
    look.draw(&mut canvas, &layout);
    Ok(canvas)
}

/// Everything that is drawn, with room for the labels of dimensions.
fn whole_view(snapshots: &[&Snapshot], options: &FieldOptions) -> View {
    let mut further = options.outline.clone();
    further.extend(options.dimensions.iter().flat_map(|d| [d.from, d.to]));
    let room = 0.03 * View::around(snapshots, &further).width();
    further.extend(options.dimensions.iter().map(|d| [d.from[0], d.from[1].max(d.to[1]) + room]));
    View::around(snapshots, &further)
}

fn draw_panel(
    canvas: &mut Canvas,
    layout: &Layout,
    k: usize,
    snapshot: Option<&Snapshot>,
    options: &FieldOptions,
    look: &Look,
) {
    let frame = layout.frames[k];
    match snapshot {
        Some(s) if !s.is_empty() => draw_points(canvas, layout, frame, s, options, look),
        _ => canvas.text("no points", (frame.x(0.5), frame.y(0.5)), TextStyle::new(LABEL, Align::Centre)),
    }
    if let Some(base) = options.base {
        draw_base(canvas, layout, frame, base);
    }
    draw_line(canvas, layout, frame, &options.outline, 2.0, Some((10.0, 7.0)));
    options.dimensions.iter().filter(|d| d.panel == k).for_each(|d| draw_dimension(canvas, layout, frame, d));
    draw_axes(canvas, layout, frame, k + 1 == layout.frames.len());
    if let Some(s) = snapshot {
        let caption = options.captions.get(k).cloned().unwrap_or_else(|| format!("t = {} s", ticks::number(s.time)));
        let caption = fitted(&caption, LABEL, f64::from(frame.width()));
        let corner = (f64::from(frame.left), f64::from(frame.top) - 13.0);
        canvas.text(&caption, corner, TextStyle::new(LABEL, Align::Left));
    }
}

fn draw_points(canvas: &mut Canvas, layout: &Layout, frame: Frame, s: &Snapshot, options: &FieldOptions, look: &Look) {
    let mut raster = Raster::new(frame.width() as usize, frame.height() as usize);
    let mut sides = 0.0;
    for i in 0..s.len() {
        let side = side(s, i) * layout.scale;
        sides += side;
        raster.square(layout.place(s.position[i]), side, look.colour(options.kind.value(s, i)));
    }
    let mean = sides / s.len() as f64;
    let widest = (options.seam.clamp(0.0, 10.0) * mean).ceil();
    raster.close((widest as usize).max(1));
    raster.draw(canvas, (frame.left, frame.top));
}

pub(super) fn draw_axes(canvas: &mut Canvas, layout: &Layout, frame: Frame, last: bool) {
    let view = layout.view;
    let x_axis = Axis::new(view.min[0], view.max[0], Scale::Linear);
    let y_axis = Axis::new(view.min[1], view.max[1], Scale::Linear);
    let x = x_axis.ticks((frame.width() / 120).max(2) as usize);
    let y = y_axis.ticks((frame.height() / 60).clamp(2, 10) as usize);
    Axes { x: &x, y: &y, x_axis, y_axis, x_label: "x (m)", y_label: "y (m)", x_numbers: last }.draw(canvas, frame);
}
