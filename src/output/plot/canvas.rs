//! A white sheet of pixels: exact rectangles, lines, discs, text.

use std::io::{self, Write};
use std::path::Path;

use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, PixmapPaint, Rect, Stroke, StrokeDash, Transform,
};

use super::clip;
use super::colour::{Rgb, WHITE};
use super::font;
use super::text::{Align, TextStyle};
use crate::output::atomic;

/// Horizontal distance of the strokes of a hatch (pixels).
const HATCH: f64 = 9.0;

/// A picture in the making. Pixels, x to the right, y down.
pub struct Canvas {
    pixmap: Pixmap,
}

impl Canvas {
    /// A white picture.
    ///
    /// # Errors
    /// `InvalidInput` if a side is 0 or there would be more than 2^28 pixels.
    pub fn new(width: u32, height: u32) -> io::Result<Canvas> {
        let small = u64::from(width) * u64::from(height) <= 1 << 28;
        let pixmap = small.then(|| Pixmap::new(width, height)).flatten();
        let mut pixmap = pixmap.ok_or_else(|| {
            let text = format!("a picture of {width} x {height} pixels cannot be drawn");
            io::Error::new(io::ErrorKind::InvalidInput, text)
        })?;
        pixmap.fill(tiny_skia::Color::WHITE);
        Ok(Canvas { pixmap })
    }

    pub fn width(&self) -> i32 {
        self.pixmap.width() as i32
    }

    pub fn height(&self) -> i32 {
        self.pixmap.height() as i32
    }

    /// Colours one pixel; outside the sheet nothing happens.
    pub fn set(&mut self, x: i32, y: i32, c: Rgb) {
        if x < 0 || y < 0 || x >= self.width() || y >= self.height() {
            return;
        }
        let at = 4 * (y as usize * self.pixmap.width() as usize + x as usize);
        self.pixmap.data_mut()[at..at + 4].copy_from_slice(&[c.0, c.1, c.2, 255]);
    }

    /// Colour of a pixel; white outside the sheet.
    #[cfg(test)]
    pub fn get(&self, x: i32, y: i32) -> Rgb {
        let pixel = u32::try_from(x).ok().zip(u32::try_from(y).ok());
        pixel.and_then(|(x, y)| self.pixmap.pixel(x, y)).map_or(WHITE, |p| Rgb(p.red(), p.green(), p.blue()))
    }

    /// Fills the pixels `x0..x1`, `y0..y1`, without smoothing.
    pub fn rect(&mut self, (x0, y0): (i32, i32), (x1, y1): (i32, i32), colour: Rgb) {
        for y in y0.max(0)..y1.min(self.height()) {
            for x in x0.max(0)..x1.min(self.width()) {
                self.set(x, y, colour);
            }
        }
    }

    /// The same with `opacity` in 0..1.
    pub fn tint(&mut self, (x0, y0): (i32, i32), (x1, y1): (i32, i32), colour: Rgb, opacity: f64) {
        let rect = Rect::from_ltrb(x0 as f32, y0 as f32, x1.max(x0 + 1) as f32, y1.max(y0 + 1) as f32);
        if let Some(rect) = rect {
            let mut paint = paint(colour);
            paint.set_color_rgba8(colour.0, colour.1, colour.2, (opacity.clamp(0.0, 1.0) * 255.0) as u8);
            self.pixmap.fill_rect(rect, &paint, Transform::identity(), None);
        }
    }

    /// The edge of a rectangle, `width` pixels inwards.
    pub fn edge(&mut self, (x0, y0): (i32, i32), (x1, y1): (i32, i32), width: i32, colour: Rgb) {
        self.rect((x0, y0), (x1, y0 + width), colour);
        self.rect((x0, y1 - width), (x1, y1), colour);
        self.rect((x0, y0), (x0 + width, y1), colour);
        self.rect((x1 - width, y0), (x1, y1), colour);
    }

    /// Slanting strokes inside a rectangle.
    pub fn hatch(&mut self, (x0, y0): (i32, i32), (x1, y1): (i32, i32), colour: Rgb) {
        let (lo, hi) = ((f64::from(x0), f64::from(y0)), (f64::from(x1), f64::from(y1)));
        let height = hi.1 - lo.1;
        // x + y is a whole multiple on every stroke, so those of neighbouring rectangles are in line.
        let first = ((lo.0 + lo.1) / HATCH).floor() * HATCH - hi.1;
        let strokes = (0..).map(|k| first + f64::from(k) * HATCH).take_while(|x| *x < hi.0);
        for x in strokes {
            for part in clip::polyline(&[(x, hi.1), (x + height, lo.1)], lo, hi) {
                self.line(&part, 1.5, colour, None);
            }
        }
    }

    /// A polyline with round joints; `dash` is the length of dashes and gaps (pixels).
    pub fn line(&mut self, points: &[(f64, f64)], width: f64, colour: Rgb, dash: Option<(f64, f64)>) {
        let Some(path) = path_of(points, false) else {
            return;
        };
        let dash = dash.and_then(|(on, off)| StrokeDash::new(vec![on as f32, off as f32], 0.0));
        let line_cap = if dash.is_some() { LineCap::Butt } else { LineCap::Round };
        let stroke = Stroke { width: width as f32, line_cap, line_join: LineJoin::Round, dash, ..Stroke::default() };
        self.pixmap.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
    }

    /// A filled polygon.
    pub fn polygon(&mut self, points: &[(f64, f64)], colour: Rgb) {
        if let Some(path) = path_of(points, true) {
            self.pixmap.fill_path(&path, &paint(colour), FillRule::Winding, Transform::identity(), None);
        }
    }

    /// A filled disc with a thin white edge.
    pub fn disc(&mut self, (x, y): (f64, f64), radius: f64, colour: Rgb) {
        for (radius, colour) in [(radius + 1.0, WHITE), (radius, colour)] {
            if let Some(path) = PathBuilder::from_circle(x as f32, y as f32, radius as f32) {
                self.pixmap.fill_path(&path, &paint(colour), FillRule::Winding, Transform::identity(), None);
            }
        }
    }

    /// Lays another picture onto this one, its upper left corner to `corner`.
    pub fn paste(&mut self, other: &Canvas, corner: (i32, i32)) {
        let (paint, whole) = (PixmapPaint::default(), Transform::identity());
        self.pixmap.draw_pixmap(corner.0, corner.1, other.pixmap.as_ref(), &paint, whole, None);
    }

    /// Text with its baseline through (x, y).
    pub fn text(&mut self, text: &str, (x, y): (f64, f64), style: TextStyle) {
        let Some(path) = font::outline(text, style.size) else {
            return;
        };
        let shift = match style.align {
            Align::Left => 0.0,
            Align::Centre => -0.5 * font::width(text, style.size),
            Align::Right => -font::width(text, style.size),
        };
        let place = Transform::from_translate(shift as f32, 0.0)
            .post_concat(Transform::from_rotate(-style.angle as f32))
            .post_translate(x as f32, y as f32);
        self.pixmap.fill_path(&path, &paint(style.colour), FillRule::Winding, place, None);
    }

    /// Text over a drawing: on a white patch.
    pub fn text_on_patch(&mut self, text: &str, (x, y): (f64, f64), style: TextStyle) {
        let half = 0.5 * font::width(text, style.size) + 6.0;
        let middle = match style.align {
            Align::Left => x + half - 6.0,
            Align::Centre => x,
            Align::Right => x - half + 6.0,
        };
        let top = ((middle - half) as i32, (y - 0.82 * style.size) as i32);
        self.tint(top, ((middle + half) as i32, (y + 0.26 * style.size) as i32), WHITE, 0.85);
        self.text(text, (x, y), style);
    }

    /// The picture as a PNG file in memory.
    ///
    /// # Errors
    /// Those of the encoder.
    pub fn png(&self) -> io::Result<Vec<u8>> {
        self.pixmap.encode_png().map_err(io::Error::other)
    }
}

/// Writes a PNG file whole or not at all.
///
/// # Errors
/// Those of the file system.
pub fn save(path: &Path, png: &[u8]) -> io::Result<()> {
    atomic::write(path, |out| out.write_all(png))
}

fn paint(colour: Rgb) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(colour.0, colour.1, colour.2, 255);
    paint
}

fn path_of(points: &[(f64, f64)], close: bool) -> Option<tiny_skia::Path> {
    let ((x, y), rest) = points.split_first()?;
    let mut path = PathBuilder::new();
    path.move_to(*x as f32, *y as f32);
    rest.iter().for_each(|(x, y)| path.line_to(*x as f32, *y as f32));
    if close {
        path.close();
    }
    path.finish()
}
