//! Where the panels of a field picture stand.

use std::io;

use super::axes::{Axis, BELOW, Frame, Scale, left_margin};
use super::view::View;

/// Frames of the panels, the part of the plane they show, and the size of the picture (pixels).
pub struct Layout {
    pub frames: Vec<Frame>,
    pub view: View,
    /// Pixels per metre.
    pub scale: f64,
    pub width: i32,
    pub height: i32,
    /// Top of the legend.
    pub legend: i32,
}

/// What the layout has to leave room for.
pub struct Wanted {
    pub panels: usize,
    pub width: u32,
    pub title: bool,
    pub captions: bool,
    /// Height of the legend (pixels).
    pub legend: i32,
}

const RIGHT: i32 = 36;
const GAP: i32 = 24;
const CAPTION: i32 = 40;

impl Layout {
    /// Equal scales on both axes; as wide as the picture unless the panels would get too high.
    ///
    /// # Errors
    /// `InvalidInput` for more than 64 panels.
    pub fn new(view: View, wanted: &Wanted) -> io::Result<Layout> {
        let panels = wanted.panels.max(1);
        if panels > 64 {
            let text = format!("{panels} panels in one picture; 64 are the most");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
        }
        let width = wanted.width.clamp(400, 8192) as i32;
        let left = left_margin(&Axis::new(view.min[1], view.max[1], Scale::Linear).ticks(6));
        let room = f64::from(width - left - RIGHT);
        let highest = (9000.0 / panels as f64).clamp(120.0, 0.6 * f64::from(width));
        let scale = (room / view.width()).min(highest / view.height());
        let panel_width = (view.width() * scale).round().clamp(room.min(500.0), room);
        let panel_height = (view.height() * scale).round().clamp(120.0, highest);
        let first = left + (0.5 * (room - panel_width)) as i32;
        let (frames, bottom) = stack(panels, (first, first + panel_width as i32), panel_height as i32, wanted);
        let legend = bottom + BELOW + 14;
        let view = view.widened(panel_width.floor() / scale, panel_height.floor() / scale);
        Ok(Layout { frames, view, scale, width, height: legend + wanted.legend + 16, legend })
    }

    /// From metres to pixels within a frame's rectangle (origin at its upper left corner).
    pub fn place(&self, x: [f64; 2]) -> (f64, f64) {
        ((x[0] - self.view.min[0]) * self.scale, (self.view.max[1] - x[1]) * self.scale)
    }
}

/// Frames from the top down, and the bottom of the last.
fn stack(panels: usize, (left, right): (i32, i32), height: i32, wanted: &Wanted) -> (Vec<Frame>, i32) {
    let caption = if wanted.captions { CAPTION } else { 0 };
    let mut top = if wanted.title { 58 } else { 16 };
    let mut frames = Vec::new();
    for _ in 0..panels {
        top += caption;
        frames.push(Frame { left, top, right, bottom: top + height });
        top += height + GAP;
    }
    (frames, top - GAP)
}
