//! `history.csv`: one row per sample.

use std::{fs::File, io, path::Path};

use crate::run::Sample;

/// Columns of the history.
pub const COLUMNS: [&str; 18] = [
    "time_s",
    "dt_s",
    "kinetic_kj_per_m",
    "nodal_kinetic_kj_per_m",
    "strain_kj_per_m",
    "external_kj_per_m",
    "dissipated_kj_per_m",
    "plastic_kj_per_m",
    "friction_kj_per_m",
    "damping_kj_per_m",
    "numerical_kj_per_m",
    "sliding_distance_m",
    "newton_iterations",
    "residual",
    "transfer_kj_per_m",
    "impact_kj_per_m",
    "integrator_kj_per_m",
    "unexplained_kj_per_m",
];

/// Writes rows as they come, and keeps them for the pictures.
pub struct History {
    writer: csv::Writer<File>,
    pub rows: Vec<Sample>,
}

impl History {
    /// A new file with its header.
    pub fn create(path: &Path) -> io::Result<Self> {
        let mut writer = csv::Writer::from_path(path)?;
        writer.write_record(COLUMNS)?;
        Ok(History { writer, rows: Vec::new() })
    }

    /// One row. A cell that has no meaning here is empty.
    pub fn push(&mut self, s: &Sample) -> io::Result<()> {
        if self.rows.last().is_some_and(|last| last.time == s.time) {
            return Ok(());
        }
        let e = &s.energies;
        let numbers = [
            s.time,
            s.dt,
            e.kinetic,
            e.nodal_kinetic,
            e.strain,
            e.external,
            e.dissipated,
            e.plastic,
            e.friction,
            e.damping,
            e.numerical,
        ];
        let mut row: Vec<String> = numbers.iter().map(|v| format!("{v}")).collect();
        row.push(s.sliding_distance.map(|r| format!("{r}")).unwrap_or_default());
        row.push(s.newton_iterations.to_string());
        row.push(s.residual.map(|r| format!("{r}")).unwrap_or_default());
        row.extend([e.transfer, e.impact, e.integrator, e.unexplained].map(|v| format!("{v}")));
        self.writer.write_record(&row)?;
        self.rows.push(*s);
        Ok(())
    }

    /// Everything written is on disk after this.
    pub fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

/// Rows of a history file: time, r, and the energies that the pictures show. A last row that was
/// cut short, by a run that is under way or was killed, is left out.
///
/// # Errors
/// `InvalidData` for a file with other columns; those of the file system.
pub fn read(path: &Path) -> io::Result<Vec<Sample>> {
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_path(path)?;
    if reader.headers()?.iter().ne(COLUMNS) {
        let text = format!("{}: not a history of this version of rmpm", path.display());
        return Err(io::Error::new(io::ErrorKind::InvalidData, text));
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record?;
        if record.len() < COLUMNS.len() {
            continue;
        }
        let number = |k: usize| record.get(k).and_then(|t| t.parse::<f64>().ok());
        let at = |k: usize| number(k).unwrap_or(f64::NAN);
        rows.push(Sample {
            time: at(0),
            dt: at(1),
            energies: crate::sim::Energies {
                kinetic: at(2),
                nodal_kinetic: at(3),
                strain: at(4),
                external: at(5),
                dissipated: at(6),
                plastic: at(7),
                friction: at(8),
                damping: at(9),
                numerical: at(10),
                transfer: at(14),
                impact: at(15),
                integrator: at(16),
                unexplained: at(17),
            },
            sliding_distance: number(11),
            particle_steps: 0,
            newton_iterations: number(12).unwrap_or(0.0) as u32,
            residual: number(13),
        });
    }
    Ok(rows)
}
