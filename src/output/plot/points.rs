//! Material points as squares of their true size, without seams.

use super::canvas::Canvas;
use super::colour::Rgb;

/// A rectangle of pixels that squares are drawn on; later ones cover earlier ones.
pub struct Raster {
    width: usize,
    height: usize,
    cells: Vec<Option<Rgb>>,
}

impl Raster {
    pub fn new(width: usize, height: usize) -> Raster {
        Raster { width, height, cells: vec![None; width * height] }
    }

    /// Fills a square, its edges moved to the nearest pixel edge, so that squares with a common
    /// edge share it; at least one pixel is filled. Pixels, y down.
    pub fn square(&mut self, (x, y): (f64, f64), side: f64, colour: Rgb) {
        if !(x.is_finite() && y.is_finite() && side.is_finite()) {
            return;
        }
        let (left, right) = covered(x, side, self.width);
        let (top, bottom) = covered(y, side, self.height);
        if left >= right {
            return;
        }
        for row in top..bottom {
            self.cells[row * self.width + left..row * self.width + right].fill(Some(colour));
        }
    }

    /// Closes seams: empty runs of at most `most` pixels between filled ones, along rows and then
    /// along columns, take the colour of the nearer side. The outer boundary stays where it is.
    pub fn close(&mut self, most: usize) {
        for row in self.cells.chunks_mut(self.width.max(1)) {
            close_row(row, most);
        }
        let mut last = vec![None; self.width];
        for y in 0..self.height {
            for (x, last) in last.iter_mut().enumerate() {
                if self.cells[y * self.width + x].is_some()
                    && let Some(above) = last.replace(y)
                    && (2..=most + 1).contains(&(y - above))
                {
                    self.close_column(x, above, y);
                }
            }
        }
    }

    fn close_column(&mut self, x: usize, above: usize, below: usize) {
        let at = |y: usize| y * self.width + x;
        let (first, second) = (self.cells[at(above)], self.cells[at(below)]);
        for y in above + 1..below {
            self.cells[y * self.width + x] = if 2 * y <= above + below { first } else { second };
        }
    }

    /// Copies the filled pixels onto a picture, the upper left corner to `corner`.
    pub fn draw(&self, canvas: &mut Canvas, corner: (i32, i32)) {
        for (row, y) in self.cells.chunks(self.width.max(1)).zip(corner.1..) {
            for (cell, x) in row.iter().zip(corner.0..) {
                if let Some(colour) = cell {
                    canvas.set(x, y, *colour);
                }
            }
        }
    }
}

/// Pixels that an interval covers, cut to `0..size`.
fn covered(middle: f64, side: f64, size: usize) -> (usize, usize) {
    let from = (middle - 0.5 * side).round();
    let to = (middle + 0.5 * side).round().max(from + 1.0);
    // The cast takes negative numbers to 0.
    ((from as usize).min(size), (to as usize).min(size))
}

fn close_row(row: &mut [Option<Rgb>], most: usize) {
    let mut last: Option<usize> = None;
    for x in 0..row.len() {
        if row[x].is_none() {
            continue;
        }
        if let Some(left) = last.replace(x)
            && x - left > 1
            && x - left - 1 <= most
        {
            let (first, second) = (row[left], row[x]);
            for (k, cell) in row.iter_mut().enumerate().take(x).skip(left + 1) {
                *cell = if 2 * k <= left + x { first } else { second };
            }
        }
    }
}
