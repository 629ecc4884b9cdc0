//! Fields of cell values as files: a table (`.csv`), an image for ParaView and PyVista (`.vti`) and an array for NumPy
//! (`.npy`).

mod csv;
mod npy;
mod vti;

use std::io;

pub use csv::write_csv;
pub use npy::write_npy;
pub use vti::write_vti;

/// Values over a lattice of equal cells.
#[derive(Clone, Copy, Debug)]
pub struct CellField<'a> {
    /// What it is, such as `cohesion`.
    pub name: &'a str,
    /// Its unit, such as `kPa`; empty for a number without one.
    pub unit: &'a str,
    /// Lower left corner (m).
    pub origin: [f64; 2],
    /// Sides of a cell (m).
    pub cell: [f64; 2],
    /// Cells along x and the vertical.
    pub cells: [usize; 2],
    /// One value a cell: row by row, x fastest, the lowest row first.
    pub values: &'a [f64],
}

impl CellField<'_> {
    /// Name and unit in one word: `cohesion_kPa`.
    pub fn column(&self) -> String {
        if self.unit.is_empty() { self.name.to_owned() } else { format!("{}_{}", self.name, self.unit) }
    }

    /// The value at a position (m), if a cell lies there.
    pub fn at(&self, position: [f64; 2]) -> Option<f64> {
        let cell = |k: usize| {
            let place = (position[k] - self.origin[k]) / self.cell[k];
            (place >= 0.0 && place < self.cells[k] as f64).then_some(place as usize)
        };
        self.values.get(cell(1)? * self.cells[0] + cell(0)?).copied()
    }

    /// # Errors
    /// `InvalidInput` if there is not one value a cell.
    fn check(&self) -> io::Result<()> {
        let [wide, high] = self.cells;
        if wide.checked_mul(high) == Some(self.values.len()) {
            return Ok(());
        }
        let text = format!("field '{}': {} values for {wide} x {high} cells", self.name, self.values.len());
        Err(io::Error::new(io::ErrorKind::InvalidInput, text))
    }

    /// The values as raw bytes, little-endian.
    fn write_raw(&self, out: &mut impl io::Write) -> io::Result<()> {
        self.values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))
    }
}

#[cfg(test)]
mod tests;
