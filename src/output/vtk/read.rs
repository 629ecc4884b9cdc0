//! A `.vtp` file of our own back to a snapshot.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use super::column::{COLUMNS, Column};
use crate::math::tensor::Voigt;
use crate::snapshot::{Snapshot, Stage};

/// Reads a frame that [`super::write_vtp`] wrote, bit for bit. Units as in [`Snapshot`].
///
/// # Errors
/// `InvalidData`, naming the file and what is wrong, if the file is damaged or of another make;
/// nothing is allocated for data that the file does not hold. Those of the file system.
pub fn read_vtp(path: &Path) -> io::Result<Snapshot> {
    read(path).map_err(|e| io::Error::new(e.kind(), format!("{}: {e}", path.display())))
}

fn read(path: &Path) -> io::Result<Snapshot> {
    let mut frame = Frame::open(path)?;
    Ok(Snapshot {
        time: frame.reals("TimeValue")?.first().copied().unwrap_or(f64::NAN),
        step: frame.tuples("step", u64::from_le_bytes)?.first().copied().unwrap_or(0),
        position: frame.planes("Points")?,
        reference: frame.planes("reference")?,
        velocity: frame.planes("velocity")?,
        mass: frame.reals("mass")?,
        initial_volume: frame.reals("initial_volume")?,
        jacobian: frame.reals("jacobian")?,
        stress: frame.stresses()?,
        plastic_strain: frame.reals("plastic_strain")?,
        strength: frame.reals("strength")?,
        peak_strength: frame.reals("peak_strength")?,
        stage: frame.stages()?,
        material: frame.tuples("material", u16::from_le_bytes)?,
        strain_energy: frame.reals("strain_energy")?,
    })
}

/// An open file with its XML header read.
struct Frame {
    file: File,
    length: u64,
    header: String,
    /// Where the appended data start (byte of the file).
    data: u64,
    points: u64,
}

impl Frame {
    fn open(path: &Path) -> io::Result<Frame> {
        let mut file = File::open(path)?;
        let length = file.metadata()?.len();
        let header = read_header(&mut file)?;
        let data = header.len() as u64;
        let kinds = ["type=\"PolyData\"", "byte_order=\"LittleEndian\"", "header_type=\"UInt64\""];
        if let Some(kind) = kinds.iter().find(|kind| !header.contains(**kind)) {
            return Err(damaged(format!("not a frame of rmpm: no {kind}")));
        }
        let piece = element(&header, "<Piece ", "NumberOfPoints=\"").unwrap_or("");
        let points = number(piece, "NumberOfPoints")?;
        Ok(Frame { file, length, header, data, points })
    }

    /// The raw bytes of an array, after its type and length have been checked.
    fn bytes(&mut self, name: &str) -> io::Result<(&'static Column, Vec<u8>)> {
        let column = COLUMNS.iter().find(|c| c.name == name);
        let column = column.ok_or_else(|| damaged(format!("no array is named '{name}'")))?;
        let start = self.start(column)?;
        let room = self.length.checked_sub(start).and_then(|left| left.checked_sub(8));
        let room = room.ok_or_else(|| damaged(format!("'{name}' starts behind the end of the file")))?;
        self.file.seek(SeekFrom::Start(start))?;
        let mut stated = [0; 8];
        self.file.read_exact(&mut stated)?;
        let stated = u64::from_le_bytes(stated);
        let expected = column.tuples(self.points).checked_mul(column.components * column.bytes);
        if expected != Some(stated) || stated > room {
            let text = format!("'{name}' has {stated} bytes for {} points, {room} are left in the file", self.points);
            return Err(damaged(text));
        }
        let mut bytes = vec![0; stated as usize];
        self.file.read_exact(&mut bytes)?;
        Ok((column, bytes))
    }

    /// Where an array starts in the file (byte), with its type checked.
    fn start(&self, column: &Column) -> io::Result<u64> {
        let name = format!(" Name=\"{}\"", column.name);
        let tag = element(&self.header, "<DataArray ", &name)
            .ok_or_else(|| damaged(format!("the array '{}' is missing", column.name)))?;
        let same = attribute(tag, "type") == Some(column.number)
            && attribute(tag, "format") == Some("appended")
            && number(tag, "NumberOfComponents")? == column.components;
        let start = self.data.checked_add(number(tag, "offset")?);
        start.filter(|_| same).ok_or_else(|| damaged(format!("the array '{}' is of another make", column.name)))
    }

    fn tuples<const N: usize, T>(&mut self, name: &str, parse: fn([u8; N]) -> T) -> io::Result<Vec<T>> {
        let (_, bytes) = self.bytes(name)?;
        Ok(bytes.as_chunks::<N>().0.iter().map(|chunk| parse(*chunk)).collect())
    }

    fn reals(&mut self, name: &str) -> io::Result<Vec<f64>> {
        self.tuples(name, f64::from_le_bytes)
    }

    /// The x and y of 3-vectors.
    fn planes(&mut self, name: &str) -> io::Result<Vec<[f64; 2]>> {
        let reals = self.reals(name)?;
        Ok(reals.as_chunks::<3>().0.iter().map(|v| [v[0], v[1]]).collect())
    }

    fn stresses(&mut self) -> io::Result<Vec<Voigt>> {
        let reals = self.reals("stress")?;
        let voigt = |v: &[f64; 4]| Voigt { xx: v[0], yy: v[1], zz: v[2], xy: v[3] };
        Ok(reals.as_chunks::<4>().0.iter().map(voigt).collect())
    }

    fn stages(&mut self) -> io::Result<Vec<Stage>> {
        self.bytes("stage")?.1.into_iter().map(stage).collect()
    }
}

fn stage(code: u8) -> io::Result<Stage> {
    match code {
        0 => Ok(Stage::Elastic),
        1 => Ok(Stage::Unloading),
        2 => Ok(Stage::Softening),
        3 => Ok(Stage::Residual),
        _ => Err(damaged(format!("no stage of the law has the code {code}"))),
    }
}

/// The text up to and with the underscore behind `<AppendedData>`.
fn read_header(file: &mut File) -> io::Result<String> {
    const MOST: u64 = 1 << 16;
    const MARK: &[u8] = b"<AppendedData encoding=\"raw\">";
    let mut bytes = Vec::new();
    file.by_ref().take(MOST).read_to_end(&mut bytes)?;
    let end = bytes.windows(MARK.len()).position(|w| w == MARK).map(|at| at + MARK.len());
    let end = end.and_then(|at| bytes[at..].iter().position(|b| *b == b'_').map(|k| at + k + 1));
    let end = end.ok_or_else(|| damaged("not a frame of rmpm: no appended raw data".into()))?;
    bytes.truncate(end);
    String::from_utf8(bytes).map_err(|_| damaged("the header is not text".into()))
}

/// The first tag that starts with `open` and holds `part`.
fn element<'a>(header: &'a str, open: &str, part: &str) -> Option<&'a str> {
    header.split(open).skip(1).filter_map(|rest| rest.split('>').next()).find(|tag| {
        // Attributes are compared with their leading blank, which the first one has lost.
        tag.contains(part) || tag.starts_with(part.trim_start())
    })
}

fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let key = format!("{name}=\"");
    let at = tag.match_indices(&key).find(|(at, _)| *at == 0 || tag.as_bytes()[at - 1] == b' ')?.0;
    tag[at + key.len()..].split('"').next()
}

fn number(tag: &str, name: &str) -> io::Result<u64> {
    let text = attribute(tag, name).ok_or_else(|| damaged(format!("no {name} in the header")))?;
    text.parse().map_err(|_| damaged(format!("{name} = '{text}' is no count")))
}

fn damaged(text: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, text)
}
