//! The comparison as text: tables for people, rows for other programs.

use super::{
    Group, Row, Study,
    figures::{FIGURES, Figure},
};
use crate::math::stats::Summary;

/// Figures of the second table, which has a line a variant.
const SWEEP: [(&str, &str); 8] = [
    ("onset_kn_m3", "onset"),
    ("first_block_m", "1st block"),
    ("sliding_distance_m", "r"),
    ("amplitude_m", "moved"),
    ("dissipated_kj_per_m", "dissipated"),
    ("numerical_kj_per_m", "numerical"),
    ("onset_cpu_s", "CPU onset"),
    ("cpu_s", "CPU end"),
];

/// Both tables and the conclusions.
pub fn table(study: &Study) -> String {
    let mut text = schemes(&study.rows);
    if study.rows.iter().any(|r| r.entry.group != Group::Schemes) {
        text += &sweep(study);
    }
    study.conclusions.iter().for_each(|line| text += &format!("- {line}\n"));
    text
}

/// Explicit and implicit side by side.
fn schemes(rows: &[Row]) -> String {
    let Some([a, b]) = rows.get(..2) else { return String::new() };
    let heads = [a, b].map(|r| format!("{} ({} runs)", r.entry.variant, r.runs.len()));
    let mut text = format!("{:<36} {:>28} {:>28}\n", "medians (least to largest)", heads[0], heads[1]);
    for f in FIGURES {
        let digits = digits(f, rows);
        let cell = |row: &Row| row.figures.get(f.name).map(|s| spread(s, digits));
        let cells = [cell(a), cell(b)];
        if cells.iter().any(Option::is_some) {
            let [x, y] = cells.map(|c| c.unwrap_or_else(|| "-".to_owned()));
            text += &format!("{:<36} {x:>28} {y:>28}\n", f.words);
        }
    }
    for (words, count) in [("failed", counts(a, b, |r| r.failed)), ("not at rest", counts(a, b, |r| r.not_at_rest))] {
        if count != [0, 0] {
            text += &format!("{words:<36} {:>28} {:>28}\n", count[0], count[1]);
        }
    }
    text + "\n"
}

fn counts(a: &Row, b: &Row, of: fn(&Row) -> usize) -> [usize; 2] {
    [of(a), of(b)]
}

/// Decimals of a figure; more where all values are small.
fn digits(f: &Figure, rows: &[Row]) -> usize {
    let largest = rows.iter().filter_map(|r| r.median(f.name)).map(f64::abs).fold(0.0, f64::max);
    let small = f.digits > 0 && largest > 0.0 && largest < 1.0;
    if small { f.digits + (-largest.log10()).ceil().clamp(0.0, 12.0) as usize } else { f.digits }
}

fn spread(s: &Summary, digits: usize) -> String {
    if s.min == s.max {
        return format!("{:.digits$}", s.median);
    }
    format!("{:.digits$} ({:.digits$} to {:.digits$})", s.median, s.min, s.max)
}

/// A line a variant of the implicit scheme.
fn sweep(study: &Study) -> String {
    let shown: Vec<&(&str, &str)> =
        SWEEP.iter().filter(|(name, _)| study.rows.iter().any(|r| r.figures.contains_key(name))).collect();
    let mut text = format!("{:<32} {:>5}", "medians", "runs");
    shown.iter().for_each(|(_, head)| text += &format!(" {head:>10}"));
    text.push('\n');
    for row in &study.rows {
        text += &format!("{:<32} {:>5}", row.entry.variant, row.runs.len());
        for (name, _) in &shown {
            let digits = FIGURES.iter().find(|f| f.name == *name).map_or(2, |f| digits(f, &study.rows));
            let cell = row.median(name).map_or("-".to_owned(), |v| format!("{v:.digits$}"));
            text += &format!(" {cell:>10}");
        }
        text.push('\n');
    }
    text + "\n"
}

/// One row a variant: counts, then median, least and largest of each figure that any variant has.
///
/// # Errors
/// Those of the writer.
pub fn csv(study: &Study) -> std::io::Result<String> {
    let shown: Vec<_> = FIGURES.iter().filter(|f| study.rows.iter().any(|r| r.figures.contains_key(f.name))).collect();
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut header: Vec<String> = ["variant", "runs", "failed", "censored", "not_at_rest"].map(str::to_owned).to_vec();
    header.extend(shown.iter().flat_map(|f| [f.name.to_owned(), format!("{}_min", f.name), format!("{}_max", f.name)]));
    writer.write_record(&header)?;
    for row in &study.rows {
        let mut cells = vec![row.entry.variant.clone()];
        cells.extend([row.runs.len(), row.failed, row.censored, row.not_at_rest].map(|n| n.to_string()));
        for f in &shown {
            let s = row.figures.get(f.name);
            cells.extend([s.map(|s| s.median), s.map(|s| s.min), s.map(|s| s.max)].map(number));
        }
        writer.write_record(&cells)?;
    }
    let bytes = writer.into_inner().map_err(|e| std::io::Error::other(e.to_string()))?;
    String::from_utf8(bytes).map_err(std::io::Error::other)
}

fn number(value: Option<f64>) -> String {
    value.map(|v| format!("{v}")).unwrap_or_default()
}
