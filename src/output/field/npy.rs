//! A field as a NumPy array.
//!
//! Format 1.0 (NEP 1): the bytes `93 NUMPY 1 0`, the length of the header as two bytes, little-endian, the header, and the
//! raw numbers. The header is a Python dictionary, filled up with blanks and a line end so that the numbers start
//! at a multiple of 64 bytes.

use std::{
    io::{self, Write},
    path::Path,
};

use super::CellField;
use crate::output::atomic;

/// Magic, version and length of the header (bytes).
const BEFORE: usize = 10;

/// Writes a 2-D array of Float64 with a row of the field a row, the lowest first: `numpy.load(path)[j, i]` is the
/// value of column i and row j from the lower left corner.
///
/// # Errors
/// `InvalidInput` if there is not one value a cell; those of the file system.
pub fn write_npy(path: &Path, field: &CellField<'_>) -> io::Result<()> {
    field.check()?;
    atomic::write(path, |out| {
        out.write_all(&header(field.cells))?;
        field.write_raw(out)
    })
}

fn header([wide, high]: [usize; 2]) -> Vec<u8> {
    let mut text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({high}, {wide}), }}");
    // with the line end a multiple of 64; the text has less than 100 bytes whatever the counts
    let length = (BEFORE + text.len() + 1).next_multiple_of(64) - BEFORE;
    text.push_str(&" ".repeat(length - 1 - text.len()));
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes
}
