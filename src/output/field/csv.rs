//! A field as a table.

use std::{io, path::Path};

use super::CellField;
use crate::output::atomic;

/// Writes one row a cell: the middle of the cell and the value, under `x_m,y_m,NAME_UNIT`. Numbers are the shortest
/// that read back to the same bits.
///
/// # Errors
/// `InvalidInput` if there is not one value a cell; those of the file system.
pub fn write_csv(path: &Path, field: &CellField<'_>) -> io::Result<()> {
    field.check()?;
    atomic::write(path, |out| {
        let mut table = csv::Writer::from_writer(out);
        table.write_record(["x_m", "y_m", &field.column()])?;
        for (k, value) in field.values.iter().enumerate() {
            let cell = [k % field.cells[0], k / field.cells[0]];
            let [x, y] = [0, 1].map(|a| field.origin[a] + (cell[a] as f64 + 0.5) * field.cell[a]);
            table.write_record([x, y, *value].map(|v| v.to_string()))?;
        }
        table.flush()
    })
}
