//! The reports as a table for a terminal.

use super::{Report, Row, remedy::aligned};

/// Least width of the column of quantities.
const WIDTH: usize = 60;

/// Names of the columns.
pub fn header() -> String {
    format!("{:WIDTH$}  {:>12}  {:>12}  {:>10}  {:>10}\n", "quantity", "exact", "ours", "error", "tolerance")
}

/// How many rows there are, and how many failed.
pub fn total(reports: &[Report]) -> String {
    let rows: usize = reports.iter().map(|r| r.rows.len()).sum();
    let failed: usize = reports.iter().map(Report::failed).sum();
    format!("\n{rows} rows, {failed} failed\n")
}

/// One problem as an aligned table for a terminal.
pub fn section(report: &Report) -> String {
    let mut out = format!("\n{}: {}\n", report.name, report.about);
    let width = report.rows.iter().map(|row| row.quantity.chars().count()).fold(WIDTH, usize::max);
    for row in &report.rows {
        let verdict = verdict(row);
        out += &format!(
            "{:width$}  {:>12}  {:>12}  {:>10}  {:>10}  {verdict}\n",
            row.quantity,
            number(row.exact),
            number(Some(row.ours)),
            short(row.error),
            short(row.tolerance)
        );
    }
    out += &aligned(&report.remedies);
    out += &format!("  {}\n", cost(report));
    report.fault.iter().for_each(|fault| out += &format!("  STOPPED: {fault}\n"));
    report.notes.iter().for_each(|note| out += &format!("  note: {note}\n"));
    out
}

/// Schemes and work, in a line.
fn cost(report: &Report) -> String {
    let c = &report.cost;
    let (points, newton) = (report.particle_steps, c.newton_iterations);
    let time = c.cpu_s.map(|s| format!(", {s:.1} s of CPU")).unwrap_or_default();
    let schemes = c.schemes().join(" and ");
    format!(
        "cost: {schemes}{} {points} particle-steps, {newton} Newton iterations{time}",
        if schemes.is_empty() { "" } else { "," }
    )
}

/// In a word.
pub(super) fn verdict(row: &Row) -> &'static str {
    match (row.tolerance, row.pass) {
        (_, false) => "FAILED",
        (None, true) => "reported",
        (Some(_), true) => "ok",
    }
}

/// Six figures, with an exponent where the number is far from 1.
pub(super) fn number(value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(v) if (1e-3..1e5).contains(&v.abs()) => format!("{v:.*}", (5.0 - v.abs().log10().floor()) as usize),
        Some(v) => format!("{v:.4e}"),
    }
}

/// Three figures.
pub(super) fn short(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |v| if v == 0.0 { "0".to_owned() } else { format!("{v:.2e}") })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_figures() {
        assert_eq!(number(Some(0.628_319)), "0.628319");
        assert_eq!(number(Some(12.5)), "12.5000");
        assert_eq!(number(Some(1e-9)), "1.0000e-9");
    }
}
