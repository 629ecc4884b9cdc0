//! A field as a VTK image.

use std::{
    io::{self, Write},
    path::Path,
};

use super::CellField;
use crate::output::{atomic, vtk::escape};

/// Writes XML ImageData (`.vti`) with one array of cell data named `NAME_UNIT`: Float64, appended raw, little-endian,
/// behind its length in bytes as UInt64. The image lies in the plane z = 0.
///
/// # Errors
/// `InvalidInput` if there is not one value a cell; those of the file system.
pub fn write_vti(path: &Path, field: &CellField<'_>) -> io::Result<()> {
    field.check()?;
    atomic::write(path, |out| {
        out.write_all(header(field).as_bytes())?;
        out.write_all(&(8 * field.values.len() as u64).to_le_bytes())?;
        field.write_raw(out)?;
        out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
    })
}

/// The XML in front of the raw data, up to and with the underscore that marks its start.
fn header(field: &CellField<'_>) -> String {
    let extent = format!("0 {} 0 {} 0 0", field.cells[0], field.cells[1]);
    let ([x, y], [dx, dy], name) = (field.origin, field.cell, escape(&field.column()));
    format!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  \
         <ImageData WholeExtent=\"{extent}\" Origin=\"{x:?} {y:?} 0\" Spacing=\"{dx:?} {dy:?} 1\">\n    \
         <Piece Extent=\"{extent}\">\n      <PointData/>\n      <CellData Scalars=\"{name}\">\n        \
         <DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"1\" format=\"appended\" offset=\"0\"/>\n      \
         </CellData>\n    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n   _"
    )
}
