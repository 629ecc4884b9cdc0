//! From values to colours, and the legend.

use super::axes::{Axis, Scale};
use super::canvas::Canvas;
use super::colour::{NO_VALUE, Rgb};
use super::field::FieldOptions;
use super::kind::FieldKind;
use super::layout::Layout;
use super::legend::{BAR_HEIGHT, ColourBar, Entry, Rows, Symbol};
use crate::snapshot::Snapshot;

/// From values to colours, and the legend that says so.
pub struct Look {
    kind: FieldKind,
    range: Axis,
    extremes: (f64, f64),
    classes: Vec<Entry>,
    missing: bool,
}

impl Look {
    pub fn new(snapshots: &[&Snapshot], options: &FieldOptions) -> Look {
        let kind = options.kind;
        let mut look = Look {
            kind,
            range: Axis::new(0.0, 1.0, Scale::Linear),
            extremes: (f64::NAN, f64::NAN),
            classes: Vec::new(),
            missing: false,
        };
        let values = || snapshots.iter().flat_map(|s| (0..s.len()).map(|i| kind.value(s, i)));
        if kind.has_classes() {
            look.classes = classes(kind, values(), &options.material_names);
            return look;
        }
        // f64::min and max pass over NaN.
        look.extremes = values().fold(look.extremes, |(lo, hi), v| (lo.min(v), hi.max(v)));
        look.missing = values().any(f64::is_nan);
        let (lo, hi) = options.range.unwrap_or_else(|| kind.automatic_range(snapshots));
        look.range = Axis::new(lo, hi, Scale::Linear);
        look
    }

    /// Colour of a value or class.
    pub fn colour(&self, value: f64) -> Rgb {
        match self.kind.has_classes() {
            true if value.is_nan() => NO_VALUE,
            true => self.kind.class_colour(value as usize),
            false => self.kind.map().at(self.range.fraction(value)),
        }
    }

    fn rows(&self, width: i32) -> Rows {
        Rows::new(self.classes.clone(), f64::from(width) - 60.0)
    }

    /// Height of the legend (pixels) on a picture of this width.
    pub fn height(&self, width: u32) -> i32 {
        if self.kind.has_classes() { self.rows(width as i32).height() } else { BAR_HEIGHT }
    }

    /// Draws the legend.
    pub fn draw(&self, canvas: &mut Canvas, layout: &Layout) {
        let middle = 0.5 * f64::from(layout.width);
        if self.kind.has_classes() {
            self.rows(layout.width).draw(canvas, middle, layout.legend);
            return;
        }
        let title =
            if self.missing { format!("{}; grey: none", self.kind.title()) } else { self.kind.title().to_owned() };
        let bar = ColourBar { map: self.kind.map(), range: self.range, title: &title, extremes: self.extremes };
        let half = (0.27 * f64::from(layout.width)) as i32;
        bar.draw(canvas, layout.width / 2 - half, layout.width / 2 + half, layout.legend);
    }
}

/// All four stages, or the first materials that occur.
fn classes(kind: FieldKind, values: impl Iterator<Item = f64>, names: &[String]) -> Vec<Entry> {
    const MOST: usize = 16;
    let mut present: Vec<usize> = if kind == FieldKind::Stage { (0..4).collect() } else { Vec::new() };
    if kind == FieldKind::Material {
        let mut seen = vec![false; usize::from(u16::MAX) + 1];
        values.filter(|v| *v >= 0.0).for_each(|v| seen[v as usize % (usize::from(u16::MAX) + 1)] = true);
        present = (0..seen.len()).filter(|class| seen[*class]).take(MOST).collect();
    }
    let name = |class: usize| names.get(class).filter(|_| kind == FieldKind::Material).cloned();
    let entry = |class: usize| Entry {
        name: name(class).unwrap_or_else(|| kind.class_name(class)),
        symbol: Symbol::Swatch,
        colour: kind.class_colour(class),
    };
    present.into_iter().map(entry).collect()
}
