//! Ranges of numbers that a key takes.

use std::fmt;

/// A range of finite numbers, with the unit that messages name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
    /// Whether the ends themselves are left out.
    pub open: bool,
    /// Unit, or empty.
    pub unit: &'static str,
}

/// A range that holds its ends.
pub(super) const fn between(low: f64, high: f64, unit: &'static str) -> Limits {
    Limits { low, high, open: false, unit }
}

/// Lengths, stiffnesses, weights, strengths, times: sane and above zero.
pub(super) const fn positive(unit: &'static str) -> Limits {
    between(1e-9, 1e12, unit)
}

/// As [`positive`], or zero.
pub(super) const fn not_negative(unit: &'static str) -> Limits {
    between(0.0, 1e12, unit)
}

/// Values of either sign.
pub(super) const fn signed(unit: &'static str) -> Limits {
    between(-1e12, 1e12, unit)
}

/// Coordinates (m).
pub(super) const COORDINATE: Limits = between(-1e9, 1e9, "m");

/// Times that may be zero (s).
pub(super) const DURATION: Limits = between(0.0, 1e9, "s");

/// Times above zero (s).
pub(super) const INTERVAL: Limits = between(1e-9, 1e9, "s");

/// Shares of a whole.
pub(super) const FRACTION: Limits = between(0.0, 1.0, "");

impl Limits {
    /// Whether a number lies in the range.
    pub fn allow(&self, value: f64) -> bool {
        match self.open {
            true => value > self.low && value < self.high,
            false => value >= self.low && value <= self.high,
        }
    }
}

impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high) = (figure(self.low), figure(self.high));
        match self.open {
            true => write!(f, "greater than {low} and less than {high}")?,
            false => write!(f, "between {low} and {high}")?,
        }
        if self.unit.is_empty() { Ok(()) } else { write!(f, " {}", self.unit) }
    }
}

/// A number as people write it: plain where short, else with an exponent.
pub(super) fn figure(value: f64) -> String {
    let plain = value == 0.0 || (1e-3..1e6).contains(&value.abs());
    if plain { format!("{value}") } else { format!("{value:e}") }
}

/// As [`figure`], rounded to four digits: for numbers that are worked out, not typed.
pub(super) fn rounded(value: f64) -> String {
    figure(format!("{value:.3e}").parse().unwrap_or(value))
}
