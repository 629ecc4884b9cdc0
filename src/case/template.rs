//! Case files to start from.

/// The names of the templates.
pub const TEMPLATES: &[&str] = &["slope", "rfem", "incline", "bar", "layered"];

/// A commented case file by its name: `slope`, `rfem`, `incline`, `bar` or `layered`.
pub fn template(name: &str) -> Option<&'static str> {
    match name {
        "slope" => Some(include_str!("../../cases/clay-slope.toml")),
        "rfem" => Some(include_str!("../../cases/clay-slope-rfem.toml")),
        "incline" => Some(include_str!("../../cases/incline.toml")),
        "bar" => Some(include_str!("../../cases/bar.toml")),
        "layered" => Some(include_str!("../../cases/layered.toml")),
        _ => None,
    }
}
