//! Legends: a colour bar, and rows of symbols with names.

use super::axes::Axis;
use super::canvas::Canvas;
use super::colour::{BLACK, ColourMap, Rgb};
use super::font;
use super::text::{Align, LABEL, TICK, TextStyle, fitted};
use super::ticks;

/// What stands before a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symbol {
    Swatch,
    Pale,
    Bar,
    Hatch,
    Line,
    Dashes,
    Dot,
}

/// One name of a legend.
#[derive(Clone, Debug)]
pub struct Entry {
    pub name: String,
    pub symbol: Symbol,
    pub colour: Rgb,
}

const ROW: i32 = 38;
const SYMBOL: f64 = 46.0;
const SPACE: f64 = 36.0;

/// A legend as rows no wider than the picture.
pub struct Rows {
    rows: Vec<(f64, Vec<Entry>)>,
}

impl Rows {
    pub fn new(entries: Vec<Entry>, most: f64) -> Rows {
        let mut rows: Vec<(f64, Vec<Entry>)> = Vec::new();
        for mut entry in entries {
            entry.name = fitted(&entry.name, TICK, most - SYMBOL - SPACE);
            let width = SYMBOL + font::width(&entry.name, TICK) + SPACE;
            match rows.last_mut() {
                Some((sum, row)) if *sum + width <= most + SPACE => {
                    *sum += width;
                    row.push(entry);
                }
                _ => rows.push((width, vec![entry])),
            }
        }
        Rows { rows }
    }

    /// Pixels from top to bottom.
    pub fn height(&self) -> i32 {
        self.rows.len() as i32 * ROW
    }

    /// Draws the rows around the column `middle`.
    pub fn draw(&self, canvas: &mut Canvas, middle: f64, top: i32) {
        for ((width, row), k) in self.rows.iter().zip(0..) {
            let mut x = middle - 0.5 * (width - SPACE);
            let y = f64::from(top + k * ROW) + 0.5 * f64::from(ROW);
            for entry in row {
                draw_symbol(canvas, entry, (x, y));
                canvas.text(&entry.name, (x + SYMBOL, y + 0.36 * TICK), TextStyle::new(TICK, Align::Left));
                x += SYMBOL + font::width(&entry.name, TICK) + SPACE;
            }
        }
    }
}

fn draw_symbol(canvas: &mut Canvas, entry: &Entry, (x, y): (f64, f64)) {
    let ends = [(x, y), (x + SYMBOL - 10.0, y)];
    let corner = ((x + 6.0) as i32, (y - 12.0) as i32);
    let opposite = (corner.0 + 26, corner.1 + 24);
    match entry.symbol {
        Symbol::Swatch => {
            canvas.rect(corner, opposite, entry.colour);
            canvas.edge(corner, opposite, 1, BLACK);
        }
        Symbol::Pale => canvas.tint(corner, opposite, entry.colour, 0.25),
        Symbol::Bar => {
            canvas.rect(corner, opposite, entry.colour.paler(0.6));
            canvas.edge(corner, opposite, 1, entry.colour);
        }
        Symbol::Hatch => {
            canvas.hatch(corner, opposite, entry.colour);
            canvas.edge(corner, opposite, 1, entry.colour);
        }
        Symbol::Line => canvas.line(&ends, 4.0, entry.colour, None),
        Symbol::Dashes => canvas.line(&ends, 3.0, entry.colour, Some((10.0, 6.0))),
        Symbol::Dot => canvas.disc((x + 18.0, y), 7.0, entry.colour),
    }
}

/// A horizontal colour bar with title, numbers and, where values lie beyond its ends, an arrow
/// with the extreme value.
pub struct ColourBar<'a> {
    pub map: ColourMap,
    pub range: Axis,
    pub title: &'a str,
    /// Lowest and highest value shown; NaN if there is none.
    pub extremes: (f64, f64),
}

/// Pixels from the top of a colour bar's title to the bottom of its numbers.
pub const BAR_HEIGHT: i32 = 112;
const THICK: i32 = 26;

impl ColourBar<'_> {
    /// Draws the bar between the columns `left` and `right`.
    pub fn draw(&self, canvas: &mut Canvas, left: i32, right: i32, top: i32) {
        let middle = 0.5 * f64::from(left + right);
        let title = fitted(self.title, LABEL, f64::from(canvas.width()) - 40.0);
        canvas.text(&title, (middle, f64::from(top) + 26.0), TextStyle::new(LABEL, Align::Centre));
        let bar = top + 42;
        for x in left..right {
            let t = (f64::from(x - left) + 0.5) / f64::from(right - left);
            canvas.rect((x, bar), (x + 1, bar + THICK), self.map.at(t));
        }
        canvas.edge((left - 2, bar - 2), (right + 2, bar + THICK + 2), 2, BLACK);
        self.draw_numbers(canvas, left, right, bar + THICK);
        self.draw_extremes(canvas, left, right, bar);
    }

    fn draw_numbers(&self, canvas: &mut Canvas, left: i32, right: i32, y: i32) {
        let place = |v: f64| f64::from(left) + self.range.fraction(v) * f64::from(right - left);
        let target = ((right - left) / 100).max(2) as usize;
        for (value, label) in self.range.ticks(target) {
            let x = place(value).round() as i32;
            canvas.rect((x - 1, y), (x + 1, y + 8), BLACK);
            canvas.text(&label, (place(value), f64::from(y) + 34.0), TextStyle::new(TICK, Align::Centre));
        }
    }

    fn draw_extremes(&self, canvas: &mut Canvas, left: i32, right: i32, bar: i32) {
        let slack = 1e-9 * (self.range.hi - self.range.lo);
        let y = f64::from(bar) + 0.5 * f64::from(THICK);
        if self.extremes.1 > self.range.hi + slack {
            arrow(canvas, (f64::from(right) + 5.0, y), 18.0, self.map.at(1.0));
            let text = format!("max {}", ticks::number(self.extremes.1));
            canvas.text(&text, (f64::from(right) + 34.0, y + 0.36 * TICK), TextStyle::new(TICK, Align::Left));
        }
        if self.extremes.0 < self.range.lo - slack {
            arrow(canvas, (f64::from(left) - 5.0, y), -18.0, self.map.at(0.0));
            let text = format!("min {}", ticks::number(self.extremes.0));
            canvas.text(&text, (f64::from(left) - 34.0, y + 0.36 * TICK), TextStyle::new(TICK, Align::Right));
        }
    }
}

/// A triangle `length` pixels long whose base stands at (x, y).
fn arrow(canvas: &mut Canvas, (x, y): (f64, f64), length: f64, colour: Rgb) {
    let half = 0.5 * f64::from(THICK);
    let corners = [(x, y - half), (x + length, y), (x, y + half), (x, y - half)];
    canvas.polygon(&corners, colour);
    canvas.line(&corners, 2.0, BLACK, None);
}
