//! Text on a picture.

use super::colour::{BLACK, Rgb};
use super::font;

/// Font sizes (pixels per em).
pub const TITLE: f64 = 31.0;
pub const LABEL: f64 = 27.0;
pub const TICK: f64 = 24.0;

/// Where the given point lies along the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Centre,
    Right,
}

/// How a text is set.
#[derive(Clone, Copy, Debug)]
pub struct TextStyle {
    /// Pixels per em.
    pub size: f64,
    pub align: Align,
    /// Anti-clockwise (degrees).
    pub angle: f64,
    pub colour: Rgb,
}

impl TextStyle {
    pub fn new(size: f64, align: Align) -> Self {
        TextStyle { size, align, angle: 0.0, colour: BLACK }
    }

    pub fn turned(self, angle: f64) -> Self {
        TextStyle { angle, ..self }
    }
}

/// The text cut so that it is no wider than `most` pixels at this size.
pub fn fitted(text: &str, size: f64, most: f64) -> String {
    if font::width(text, size) <= most {
        return text.to_owned();
    }
    // A text far longer than a line would be measured again and again.
    let mut short: String = text.chars().take(400).collect();
    while !short.is_empty() && font::width(&format!("{short}…"), size) > most {
        short.pop();
    }
    format!("{}…", short.trim_end())
}
