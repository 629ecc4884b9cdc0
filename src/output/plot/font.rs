//! The embedded font: DejaVu Sans (licence beside the file), cut down to ASCII, Greek and a few
//! signs.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, GlyphId, OutlineCurve, Point};
use tiny_skia::{Path, PathBuilder};

static FONT: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(include_bytes!("font/DejaVuSans-subset.ttf")).ok());

/// Width of a text set in `size` pixels per em (pixels).
pub fn width(text: &str, size: f64) -> f64 {
    place(text, size, |_, _, _| ())
}

/// Outline of a text whose baseline starts at the origin (pixels, y down).
pub fn outline(text: &str, size: f64) -> Option<Path> {
    let mut path = PathBuilder::new();
    let scale = scale(size);
    place(text, size, |font, glyph, x| {
        let curves = font.outline(glyph).map(|o| o.curves).unwrap_or_default();
        add_glyph(&mut path, &curves, |p| (x as f32 + p.x * scale, -p.y * scale));
    });
    path.finish()
}

fn scale(size: f64) -> f32 {
    let em = FONT.as_ref().and_then(Font::units_per_em).unwrap_or(1000.0);
    size as f32 / em
}

/// Calls `put` with each glyph and its x; returns the width.
fn place(text: &str, size: f64, mut put: impl FnMut(&FontRef<'static>, GlyphId, f64)) -> f64 {
    let Some(font) = FONT.as_ref() else {
        return 0.0;
    };
    let scale = f64::from(scale(size));
    let (mut x, mut before) = (0.0, None);
    for c in text.chars() {
        let glyph = glyph(font, c);
        if let Some(left) = before {
            x += scale * f64::from(font.kern_unscaled(left, glyph));
        }
        put(font, glyph, x);
        x += scale * f64::from(font.h_advance_unscaled(glyph));
        before = Some(glyph);
    }
    x
}

/// The glyph of a character, a question mark for one that the font lacks.
fn glyph(font: &FontRef<'static>, c: char) -> GlyphId {
    let glyph = font.glyph_id(c);
    if glyph == GlyphId(0) { font.glyph_id('?') } else { glyph }
}

fn add_glyph(path: &mut PathBuilder, curves: &[OutlineCurve], map: impl Fn(Point) -> (f32, f32)) {
    let mut pen: Option<Point> = None;
    for curve in curves {
        let (start, end) = match curve {
            OutlineCurve::Line(a, b) | OutlineCurve::Quad(a, _, b) | OutlineCurve::Cubic(a, _, _, b) => (*a, *b),
        };
        let ((sx, sy), (ex, ey)) = (map(start), map(end));
        if pen != Some(start) {
            path.close();
            path.move_to(sx, sy);
        }
        match curve {
            OutlineCurve::Line(..) => path.line_to(ex, ey),
            OutlineCurve::Quad(_, c, _) => path.quad_to(map(*c).0, map(*c).1, ex, ey),
            OutlineCurve::Cubic(_, c, d, _) => path.cubic_to(map(*c).0, map(*c).1, map(*d).0, map(*d).1, ex, ey),
        }
        pen = Some(end);
    }
    path.close();
}
