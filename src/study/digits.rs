//! Numbers in words for people.

/// Four digits of a number.
pub fn figure(value: f64) -> String {
    digits(value, 4)
}

/// Some significant digits of a number, without zeros at the end.
pub fn digits(value: f64, count: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", count.saturating_sub(1)).parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}
