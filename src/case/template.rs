//! Case files to start from.

/// The names of the templates.
pub const TEMPLATES: &[&str] = &["slope", "random", "rfem", "incline", "bar", "layered"];

/// A commented case file by its name: `slope`, `random`, `rfem`, `incline`, `bar` or `layered`.
pub fn template(name: &str) -> Option<&'static str> {
    match name {
        "slope" => Some(include_str!("../../cases/clay-slope.toml")),
        "random" => Some(include_str!("../../cases/random-slope.toml")),
        "rfem" => Some(include_str!("../../cases/clay-slope-rfem.toml")),
        "incline" => Some(include_str!("../../cases/incline.toml")),
        "bar" => Some(include_str!("../../cases/bar.toml")),
        "layered" => Some(include_str!("../../cases/layered.toml")),
        _ => None,
    }
}
