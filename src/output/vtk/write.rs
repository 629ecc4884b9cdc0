//! A snapshot to a `.vtp` file.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use super::column::{COLUMNS, Column, Section};
use crate::output::atomic;
use crate::snapshot::Snapshot;

/// Writes one frame; `path` appears only once the file is whole. Units as in [`Snapshot`].
///
/// # Errors
/// `InvalidInput` if the snapshot's vectors differ in length; those of the file system.
pub fn write_vtp(path: &Path, snapshot: &Snapshot) -> io::Result<()> {
    check_lengths(snapshot)?;
    atomic::write(path, |out| {
        out.write_all(header(snapshot.len() as u64).as_bytes())?;
        for column in COLUMNS {
            write_column(out, column, snapshot)?;
        }
        out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
    })
}

/// The XML in front of the raw data, up to and with the underscore that marks its start.
fn header(points: u64) -> String {
    let mut xml = String::from("<?xml version=\"1.0\"?>\n");
    xml += "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n";
    xml += "  <PolyData>\n";
    let mut offset = 0;
    section(&mut xml, Section::Field, "FieldData", points, &mut offset);
    let _ = writeln!(xml, "    <Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"{points}\">");
    section(&mut xml, Section::Points, "Points", points, &mut offset);
    section(&mut xml, Section::Verts, "Verts", points, &mut offset);
    section(&mut xml, Section::PointData, "PointData", points, &mut offset);
    xml += "    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _";
    xml
}

/// One element with its arrays; `offset` runs on (the columns stand in the order of the sections).
fn section(xml: &mut String, part: Section, tag: &str, points: u64, offset: &mut u64) {
    let _ = writeln!(xml, "      <{tag}>");
    for column in COLUMNS.iter().filter(|c| c.section == part) {
        let _ = write!(xml, "        <DataArray type=\"{}\" Name=\"{}\"", column.number, column.name);
        let _ = write!(xml, " NumberOfComponents=\"{}\"", column.components);
        for (k, name) in column.component_names.iter().enumerate() {
            let _ = write!(xml, " ComponentName{k}=\"{name}\"");
        }
        if part == Section::Field {
            xml.push_str(" NumberOfTuples=\"1\"");
        }
        let _ = writeln!(xml, " format=\"appended\" offset=\"{offset}\"/>");
        *offset += 8 + data_bytes(column, points);
    }
    let _ = writeln!(xml, "      </{tag}>");
}

fn data_bytes(column: &Column, points: u64) -> u64 {
    column.tuples(points) * column.components * column.bytes
}

fn write_column(out: &mut impl Write, column: &Column, snapshot: &Snapshot) -> io::Result<()> {
    const CHUNK: usize = 1 << 16;
    let points = snapshot.len() as u64;
    out.write_all(&data_bytes(column, points).to_le_bytes())?;
    let mut buffer = Vec::with_capacity(CHUNK + 64);
    for i in 0..column.tuples(points) as usize {
        (column.put)(snapshot, i, &mut buffer);
        if buffer.len() >= CHUNK {
            out.write_all(&buffer)?;
            buffer.clear();
        }
    }
    out.write_all(&buffer)
}

fn check_lengths(s: &Snapshot) -> io::Result<()> {
    let lengths = [
        ("reference", s.reference.len()),
        ("velocity", s.velocity.len()),
        ("mass", s.mass.len()),
        ("initial_volume", s.initial_volume.len()),
        ("jacobian", s.jacobian.len()),
        ("stress", s.stress.len()),
        ("plastic_strain", s.plastic_strain.len()),
        ("strength", s.strength.len()),
        ("peak_strength", s.peak_strength.len()),
        ("stage", s.stage.len()),
        ("material", s.material.len()),
        ("strain_energy", s.strain_energy.len()),
    ];
    match lengths.iter().find(|(_, length)| *length != s.len()) {
        None => Ok(()),
        Some((name, length)) => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            format!("snapshot at step {}: {} positions but {length} entries of {name}", s.step, s.len()),
        )),
    }
}
