//! A field of cell values as a picture: cells coloured by value, the soil outlined.

use std::io;
use std::path::Path;

use super::annotate::draw_line;
use super::axes::{Axis, Frame, Scale};
use super::canvas::{self, Canvas};
use super::colour::ColourMap;
use super::field::draw_axes;
use super::kind::round_outwards;
use super::layout::{Layout, Wanted};
use super::legend::{BAR_HEIGHT, ColourBar};
use super::text::{Align, LABEL, TITLE, TextStyle, fitted};
use super::view::View;
use crate::math::polygon;
use crate::output::field::CellField;

/// How a field of cells is shown.
#[derive(Clone, Debug)]
pub struct CellsOptions {
    /// Line at the top.
    pub title: String,
    /// Line above the cells.
    pub caption: String,
    /// What stands at the colour bar, with the unit.
    pub legend: String,
    /// Ends of the colour scale; from the values where `None`.
    pub range: Option<(f64, f64)>,
    /// Corners of the soil's regions (m); cells outside all of them are drawn pale.
    pub outlines: Vec<Vec<[f64; 2]>>,
    /// Width of the picture (pixels).
    pub width: u32,
}

/// How far cells outside the soil are on the way to white.
const PALE: f64 = 0.72;

/// Draws a field into a PNG file.
///
/// # Errors
/// `InvalidInput` for a picture that cannot be drawn; those of the file system.
pub fn cells(path: &Path, field: &CellField<'_>, options: &CellsOptions) -> io::Result<()> {
    canvas::save(path, &draw(field, options)?.png()?)
}

fn draw(field: &CellField<'_>, options: &CellsOptions) -> io::Result<Canvas> {
    let far = [0, 1].map(|k| field.origin[k] + field.cell[k] * field.cells[k] as f64);
    let wanted = Wanted { panels: 1, width: options.width, title: true, captions: true, legend: BAR_HEIGHT };
    let layout = Layout::new(View::around(&[], &[field.origin, far]), &wanted)?;
    let mut canvas = Canvas::new(layout.width as u32, layout.height as u32)?;
    let width = f64::from(layout.width);
    let title = fitted(&options.title, TITLE, width - 40.0);
    canvas.text(&title, (0.5 * width, 42.0), TextStyle::new(TITLE, Align::Centre));
    let (low, high) = options.range.unwrap_or_else(|| range(field.values));
    let scale = Axis::new(low, high, Scale::Linear);
    for frame in &layout.frames {
        draw_cells(&mut canvas, &layout, *frame, field, options, &scale);
        draw_soil(&mut canvas, &layout, *frame, options);
        draw_axes(&mut canvas, &layout, *frame, true);
    }
    draw_bar(&mut canvas, &layout, field, options, scale);
    Ok(canvas)
}

/// Each pixel takes the colour of the cell under its middle.
fn draw_cells(
    canvas: &mut Canvas,
    layout: &Layout,
    frame: Frame,
    field: &CellField<'_>,
    options: &CellsOptions,
    scale: &Axis,
) {
    let inside = |x| options.outlines.is_empty() || options.outlines.iter().any(|o| polygon::contains(o, x));
    for row in 0..frame.height() {
        for column in 0..frame.width() {
            let x = layout.view.min[0] + (f64::from(column) + 0.5) / layout.scale;
            let y = layout.view.max[1] - (f64::from(row) + 0.5) / layout.scale;
            if let Some(value) = field.at([x, y]) {
                let colour = MAP.at(scale.fraction(value));
                let colour = if inside([x, y]) { colour } else { colour.paler(PALE) };
                canvas.set(frame.left + column, frame.top + row, colour);
            }
        }
    }
}

/// Weak is blue and strong is red, as in the pictures of a run.
const MAP: ColourMap = ColourMap::Diverging;

fn draw_soil(canvas: &mut Canvas, layout: &Layout, frame: Frame, options: &CellsOptions) {
    for outline in &options.outlines {
        let closed: Vec<[f64; 2]> = outline.iter().chain(outline.first()).copied().collect();
        draw_line(canvas, layout, frame, &closed, 2.5, None);
    }
    let caption = fitted(&options.caption, LABEL, f64::from(frame.width()));
    let corner = (f64::from(frame.left), f64::from(frame.top) - 13.0);
    canvas.text(&caption, corner, TextStyle::new(LABEL, Align::Left));
}

fn draw_bar(canvas: &mut Canvas, layout: &Layout, field: &CellField<'_>, options: &CellsOptions, range: Axis) {
    // f64::min and max pass over NaN
    let extremes = field.values.iter().fold((f64::NAN, f64::NAN), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
    let missing = field.values.iter().any(|v| v.is_nan());
    let title = if missing { format!("{}; grey: none", options.legend) } else { options.legend.clone() };
    let half = (0.27 * f64::from(layout.width)) as i32;
    let middle = layout.width / 2;
    ColourBar { map: MAP, range, title: &title, extremes }.draw(canvas, middle - half, middle + half, layout.legend);
}

/// A colour scale for these values, without the outermost 0.5 %.
pub fn range(values: &[f64]) -> (f64, f64) {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let quantile = |q| crate::math::stats::quantile(&sorted, q);
    quantile(0.005).zip(quantile(0.995)).map_or((0.0, 1.0), |(low, high)| round_outwards(low, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two cells, the lowest and the highest value; the soil is the lower half.
    #[test]
    fn cells_have_the_colours_of_their_values_and_are_pale_outside_the_soil() {
        let field = CellField {
            name: "c",
            unit: "kPa",
            origin: [0.0, 0.0],
            cell: [2.0, 2.0],
            cells: [2, 1],
            values: &[10.0, 30.0],
        };
        let options = CellsOptions {
            title: "title".into(),
            caption: "caption".into(),
            legend: "c (kPa)".into(),
            range: Some((10.0, 30.0)),
            outlines: vec![vec![[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]]],
            width: 800,
        };
        let canvas = draw(&field, &options).unwrap();
        let seen: Vec<_> = (0..canvas.height()).flat_map(|y| (0..canvas.width()).map(move |x| (x, y))).collect();
        let area = |colour| seen.iter().filter(|(x, y)| canvas.get(*x, *y) == colour).count() as f64;
        for colour in [MAP.at(0.0), MAP.at(1.0)] {
            let (inside, outside) = (area(colour), area(colour.paler(PALE)));
            // the colour bar adds a column of 26 pixels, the outline takes a few rows away
            assert!(outside > 10_000.0 && (inside / outside - 1.0).abs() < 0.05, "{inside} {outside}");
        }
    }
}
