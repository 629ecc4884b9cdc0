//! The list of a run's frames with their times (`.pvd`).

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use crate::output::atomic;

/// Writes the list of frames: time (s) and file, relative to the folder of `path`.
///
/// # Errors
/// Those of the file system.
pub fn write_pvd(path: &Path, frames: &[(f64, String)]) -> io::Result<()> {
    atomic::write(path, |out| {
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(out, "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">")?;
        writeln!(out, "  <Collection>")?;
        for (time, file) in frames {
            let file = escape(file);
            writeln!(out, "    <DataSet timestep=\"{time:?}\" group=\"\" part=\"0\" file=\"{file}\"/>")?;
        }
        writeln!(out, "  </Collection>\n</VTKFile>")
    })
}

/// Reads such a list: time (s) and file of each frame, in the order of the file.
///
/// # Errors
/// `InvalidData` if an entry has no time or file; those of the file system.
pub fn read_pvd(path: &Path) -> io::Result<Vec<(f64, String)>> {
    let text = fs::read_to_string(path)?;
    let tags = text.split("<DataSet ").skip(1).filter_map(|rest| rest.split("/>").next());
    let bad = |tag: &str| {
        let text = format!("{}: no time and file in '{tag}'", path.display());
        io::Error::new(io::ErrorKind::InvalidData, text)
    };
    tags.map(|tag| entry(tag).ok_or_else(|| bad(tag))).collect()
}

fn entry(tag: &str) -> Option<(f64, String)> {
    let time = value(tag, "timestep=\"")?.parse().ok()?;
    Some((time, unescape(value(tag, "file=\"")?)))
}

fn value<'a>(tag: &'a str, key: &str) -> Option<&'a str> {
    tag.split_once(key)?.1.split_once('"').map(|(value, _)| value)
}

/// Text as it may stand in an XML attribute.
pub(in crate::output) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn unescape(text: &str) -> String {
    text.replace("&quot;", "\"").replace("&gt;", ">").replace("&lt;", "<").replace("&amp;", "&")
}
