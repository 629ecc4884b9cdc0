use std::fs;

use super::*;

const VALUES: [f64; 6] = [1.0, -0.0, 1.0 / 3.0, 4e300, f64::MIN_POSITIVE, 20.25];

fn sample() -> CellField<'static> {
    CellField { name: "c <0>", unit: "kPa", origin: [-1.0, 0.5], cell: [0.25, 0.5], cells: [3, 2], values: &VALUES }
}

/// The bytes that a writer leaves.
fn written(write: fn(&std::path::Path, &CellField<'_>) -> io::Result<()>) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("field");
    write(&path, &sample()).unwrap();
    fs::read(path).unwrap()
}

fn bits(bytes: &[u8]) -> Vec<u64> {
    bytes.as_chunks::<8>().0.iter().map(|b| u64::from_le_bytes(*b)).collect()
}

#[test]
fn a_table_reads_back_to_the_same_bits() {
    let bytes = written(write_csv);
    let mut table = ::csv::Reader::from_reader(&bytes[..]);
    assert_eq!(table.headers().unwrap(), vec!["x_m", "y_m", "c <0>_kPa"]);
    let rows: Vec<[f64; 3]> = table.deserialize().map(|row| row.unwrap()).collect();
    assert_eq!(rows.iter().map(|r| r[2].to_bits()).collect::<Vec<_>>(), VALUES.map(f64::to_bits));
    // the first cell of the upper row
    assert_eq!([rows[3][0], rows[3][1]], [-0.875, 1.25]);
}

#[test]
fn an_array_reads_back_to_the_same_bits() {
    let bytes = written(write_npy);
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = std::str::from_utf8(&bytes[10..start]).unwrap();
    assert!(start.is_multiple_of(64) && header.ends_with('\n'), "{start}");
    assert_eq!(header.trim_end(), "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }");
    assert_eq!(bits(&bytes[start..]), VALUES.map(f64::to_bits));
}

#[test]
fn an_image_has_its_geometry_and_reads_back_to_the_same_bits() {
    let bytes = written(write_vti);
    let mark = b"<AppendedData encoding=\"raw\">\n   _";
    let start = bytes.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len();
    let header = std::str::from_utf8(&bytes[..start]).unwrap();
    for part in [
        "WholeExtent=\"0 3 0 2 0 0\"",
        "Origin=\"-1.0 0.5 0\"",
        "Spacing=\"0.25 0.5 1\"",
        "type=\"Float64\" Name=\"c &lt;0&gt;_kPa\"",
        "offset=\"0\"",
    ] {
        assert!(header.contains(part), "{part} in {header}");
    }
    let length = u64::from_le_bytes(bytes[start..start + 8].try_into().unwrap()) as usize;
    assert_eq!(bits(&bytes[start + 8..start + 8 + length]), VALUES.map(f64::to_bits));
    assert_eq!(&bytes[start + 8 + length..], b"\n  </AppendedData>\n</VTKFile>\n");
}

#[test]
fn a_field_with_a_missing_value_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let field = CellField { values: &VALUES[1..], ..sample() };
    for write in [write_csv, write_npy, write_vti] {
        let error = write(&folder.path().join("field"), &field).unwrap_err();
        assert!(error.to_string().contains("5 values for 3 x 2 cells"), "{error}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_position_finds_its_cell() {
    let field = sample();
    assert_eq!(field.at([-0.99, 0.51]), Some(1.0));
    assert_eq!(field.at([-0.26, 1.49]), Some(20.25));
    assert_eq!(field.at([-1.01, 0.6]), None);
    assert_eq!(field.at([f64::NAN, 0.6]), None);
}
