//! Several pictures on one sheet: rows of plots and shapes.

use std::io;
use std::path::Path;

use super::canvas::{self, Canvas};
use super::{FieldOptions, SeriesPlot, field, series};
use crate::snapshot::Snapshot;

/// A picture on a sheet.
pub enum Part<'a> {
    Series(&'a SeriesPlot),
    Field(&'a [&'a Snapshot], &'a FieldOptions),
}

/// Draws rows of pictures into one PNG file, each row from the left.
///
/// # Errors
/// `InvalidInput` for pictures of impossible size; those of the file system.
pub fn sheet(path: &Path, rows: &[Vec<Part<'_>>]) -> io::Result<()> {
    let drawn = rows.iter().map(|row| row.iter().map(draw).collect()).collect::<io::Result<Vec<Vec<Canvas>>>>()?;
    let width = drawn.iter().map(|row| row.iter().map(Canvas::width).sum::<i32>()).max().unwrap_or(1);
    let heights: Vec<i32> = drawn.iter().map(|row| row.iter().map(Canvas::height).max().unwrap_or(0)).collect();
    let mut whole = Canvas::new(width.max(1) as u32, heights.iter().sum::<i32>().max(1) as u32)?;
    let mut top = 0;
    for (row, height) in drawn.iter().zip(heights) {
        let mut left = 0;
        for part in row {
            whole.paste(part, (left, top));
            left += part.width();
        }
        top += height;
    }
    canvas::save(path, &whole.png()?)
}

fn draw(part: &Part<'_>) -> io::Result<Canvas> {
    match part {
        Part::Series(plot) => series::draw(plot),
        Part::Field(snapshots, options) => field::draw(snapshots, options),
    }
}
