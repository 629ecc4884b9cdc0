//! Rows of numbers, and their table.

use std::collections::BTreeMap;

use serde::Serialize;

use super::reference::{Answer, Measure, Reference};
use crate::sim::Simulation;

/// One quantity: the exact value, ours, and whether they agree.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What, with its unit.
    pub quantity: String,
    /// The exact or published value, or the bound; `None` where a number is only reported.
    pub exact: Option<f64>,
    pub ours: f64,
    /// Error in the sense of `measure`.
    pub error: Option<f64>,
    pub measure: Measure,
    /// Largest error that passes; `None` where a number is only reported.
    pub tolerance: Option<f64>,
    pub pass: bool,
    /// Where the tolerance comes from, or why the number is only reported.
    pub why_tolerance: String,
}

/// What came out of a problem.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    pub name: String,
    pub about: String,
    pub source: String,
    pub rows: Vec<Row>,
    /// Material points moved, summed over all steps of all runs.
    pub particle_steps: u64,
    /// What a reader should know beside the numbers.
    pub notes: Vec<String>,
    /// Case files to be run again, by name: written beside the report.
    #[serde(skip)]
    pub files: BTreeMap<String, String>,
}

impl Report {
    /// An empty report.
    pub(super) fn new(name: &str, reference: &Reference) -> Self {
        Report {
            name: name.to_owned(),
            about: reference.about.clone(),
            source: reference.source.clone(),
            rows: Vec::new(),
            particle_steps: 0,
            notes: Vec::new(),
            files: BTreeMap::new(),
        }
    }

    /// Whether every row passes.
    pub fn pass(&self) -> bool {
        self.rows.iter().all(|row| row.pass)
    }

    /// Adds a row against the answer `key` of the reference.
    pub(super) fn row(&mut self, reference: &Reference, key: &str, ours: f64) -> Result<(), String> {
        let answer = reference.answer(key)?;
        self.push(answer, answer.quantity.clone(), answer.exact, ours);
        Ok(())
    }

    /// As [`Report::row`] for one of several set-ups, with an exact value worked out for it
    /// where there is one.
    pub(super) fn row_of(
        &mut self,
        reference: &Reference,
        key: &str,
        setup: &str,
        exact: Option<f64>,
        ours: f64,
    ) -> Result<(), String> {
        let answer = reference.answer(key)?;
        self.push(answer, format!("{}, {setup}", answer.quantity), exact.or(answer.exact), ours);
        Ok(())
    }

    fn push(&mut self, answer: &Answer, quantity: String, exact: Option<f64>, ours: f64) {
        let error = exact.and_then(|exact| answer.measure.error(exact, ours));
        let tolerance = answer.tolerance.filter(|_| answer.measure != Measure::Reported);
        // a NaN is no pass
        let pass = match (error, tolerance) {
            (Some(error), Some(tolerance)) => error <= tolerance,
            _ => answer.measure == Measure::Reported,
        };
        let why_tolerance = answer.why.clone();
        self.rows.push(Row { quantity, exact, ours, error, measure: answer.measure, tolerance, pass, why_tolerance });
    }

    /// Books the work of a run that is over.
    pub(super) fn count(&mut self, simulation: &Simulation) {
        self.particle_steps += simulation.work.particle_steps;
    }

    /// Adds a note.
    pub(super) fn note(&mut self, text: impl Into<String>) {
        self.notes.push(text.into());
    }
}

/// The reports as an aligned table for a terminal.
pub fn table(reports: &[Report]) -> String {
    let widest = |r: &Report| r.rows.iter().map(|row| row.quantity.chars().count()).max().unwrap_or(0);
    let width = reports.iter().map(widest).max().unwrap_or(0).max(8);
    let mut out =
        format!("{:width$}  {:>12}  {:>12}  {:>10}  {:>10}\n", "quantity", "exact", "ours", "error", "tolerance");
    for report in reports {
        out += &section(report, width);
    }
    let rows = reports.iter().flat_map(|r| &r.rows);
    let failed = rows.clone().filter(|row| !row.pass).count();
    out + &format!("\n{} rows, {failed} failed\n", rows.count())
}

fn section(report: &Report, width: usize) -> String {
    let mut out = format!("\n{}: {}\n", report.name, report.about);
    for row in &report.rows {
        let verdict = match (row.tolerance, row.pass) {
            (_, false) => "FAILED",
            (None, true) => "reported",
            (Some(_), true) => "ok",
        };
        out += &format!(
            "{:width$}  {:>12}  {:>12}  {:>10}  {:>10}  {verdict}\n",
            row.quantity,
            number(row.exact),
            number(Some(row.ours)),
            short(row.error),
            short(row.tolerance)
        );
    }
    report.notes.iter().for_each(|note| out += &format!("  note: {note}\n"));
    out
}

/// Six figures, with an exponent where the number is far from 1.
fn number(value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(v) if (1e-3..1e5).contains(&v.abs()) => format!("{v:.*}", (5.0 - v.abs().log10().floor()) as usize),
        Some(v) => format!("{v:.4e}"),
    }
}

fn short(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |v| if v == 0.0 { "0".to_owned() } else { format!("{v:.2e}") })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_passes_within_its_tolerance_and_not_a_number_never_does() {
        let text = "about = \"a\"\nsource = \"s\"\n[answer.x]\nquantity = \"x\"\nexact = 2.0\nmeasure = \"relative\"\ntolerance = 0.01\nwhy = \"w\"\n";
        let reference = Reference::read(text).unwrap();
        let mut report = Report::new("n", &reference);
        for ours in [2.01, 2.03, f64::NAN] {
            report.row(&reference, "x", ours).unwrap();
        }
        assert_eq!(report.rows.iter().map(|r| r.pass).collect::<Vec<_>>(), [true, false, false]);
        assert!(table(&[report]).contains("3 rows, 2 failed"));
    }

    #[test]
    fn numbers_have_six_figures() {
        assert_eq!(number(Some(0.628_319)), "0.628319");
        assert_eq!(number(Some(12.5)), "12.5000");
        assert_eq!(number(Some(1e-9)), "1.0000e-9");
    }
}
