//! What stands on a panel beside the points: base, outline, dimensions.

use super::axes::Frame;
use super::canvas::Canvas;
use super::clip;
use super::colour::BLACK;
use super::field::Dimension;
use super::layout::Layout;
use super::text::{Align, LABEL, TextStyle};

/// A thick line with strokes below it.
pub fn draw_base(canvas: &mut Canvas, layout: &Layout, frame: Frame, base: f64) {
    let y = f64::from(frame.top) + layout.place([0.0, base]).1;
    if !(y > f64::from(frame.top) && y < f64::from(frame.bottom)) {
        return;
    }
    let row = y.round() as i32;
    canvas.rect((frame.left, row), (frame.right, (row + 3).min(frame.bottom)), BLACK);
    let length = (f64::from(frame.bottom) - y - 3.0).clamp(0.0, 11.0);
    for x in (frame.left + 12..frame.right - 2).step_by(14) {
        let x = f64::from(x);
        canvas.line(&[(x, y + 3.0), (x - length, y + 3.0 + length)], 1.5, BLACK, None);
    }
}

/// A polyline through positions (m), cut at the frame.
pub fn draw_line(
    canvas: &mut Canvas,
    layout: &Layout,
    frame: Frame,
    corners: &[[f64; 2]],
    width: f64,
    dash: Option<(f64, f64)>,
) {
    let place = |x: &[f64; 2]| {
        let (px, py) = layout.place(*x);
        (f64::from(frame.left) + px, f64::from(frame.top) + py)
    };
    let points: Vec<_> = corners.iter().map(place).collect();
    let (lo, hi) = ((f64::from(frame.left), f64::from(frame.top)), (f64::from(frame.right), f64::from(frame.bottom)));
    for part in clip::polyline(&points, lo, hi) {
        canvas.line(&part, width, BLACK, dash);
    }
}

/// A double arrow with its label.
pub fn draw_dimension(canvas: &mut Canvas, layout: &Layout, frame: Frame, d: &Dimension) {
    let length = (d.to[0] - d.from[0]).hypot(d.to[1] - d.from[1]);
    if !(length.is_finite() && length > 0.0) {
        return;
    }
    draw_line(canvas, layout, frame, &[d.from, d.to], 2.0, None);
    // Arrow heads of 14 pixels.
    let along = [0, 1].map(|k| (d.to[k] - d.from[k]) / length * 14.0 / layout.scale);
    for (tip, way) in [(d.from, 1.0), (d.to, -1.0)] {
        let wing = |s: f64| [tip[0] + way * along[0] - s * along[1], tip[1] + way * along[1] + s * along[0]];
        draw_line(canvas, layout, frame, &[wing(0.4), tip, wing(-0.4)], 2.0, None);
    }
    let middle = layout.place([0.5 * (d.from[0] + d.to[0]), 0.5 * (d.from[1] + d.to[1])]);
    let at = (f64::from(frame.left) + middle.0, f64::from(frame.top) + middle.1 - 13.0);
    canvas.text_on_patch(&d.label, at, TextStyle::new(LABEL, Align::Centre));
}
