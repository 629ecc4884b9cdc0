//! The study as a table, for a terminal and in Markdown.

use super::{ArmReport, Figures, Report};
use crate::math::stats::Moments;

const HEAD: [&str; 11] = [
    "arm",
    "n",
    "mean r +- se (m)",
    "sd +- se (m)",
    "median (m)",
    "r = 0",
    "at wall",
    "at mean (m)",
    "source (m)",
    "volume (m3/m)",
    "CPU (s)",
];

/// The table and the remarks, for a terminal.
pub fn table(report: &Report) -> String {
    let rows = rows(report);
    let width = |k: usize| rows.iter().map(|r| r[k].chars().count()).chain([HEAD[k].len()]).max().unwrap_or(0);
    let widths: Vec<usize> = (0..HEAD.len()).map(width).collect();
    let line = |cells: &[String]| {
        let first = format!("{:<w$}", cells[0], w = widths[0]);
        let rest = cells.iter().zip(&widths).skip(1).map(|(c, w)| format!("  {c:>w$}"));
        std::iter::once(first).chain(rest).collect::<String>() + "\n"
    };
    let mut text = format!("{}\n", report.title);
    text += &line(&HEAD.map(str::to_owned));
    rows.iter().for_each(|row| text += &line(row));
    report.remarks.iter().for_each(|remark| text += &format!("note: {remark}\n"));
    text
}

/// `report.md`: the same, with the pictures.
pub fn markdown(report: &Report) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let mut text = format!("# {}\n\nCase: `{}`, rmpm {}.\n\n", report.title, report.case, report.build.version);
    text += &line(&HEAD.map(str::to_owned));
    text += &format!("|{}\n", "---|".repeat(HEAD.len()));
    rows(report).iter().for_each(|row| text += &line(row));
    text += "\n## What this says, and what it does not\n\n";
    report.remarks.iter().for_each(|remark| text += &format!("- {remark}\n"));
    text += "\n## Pictures\n\n";
    super::picture::names(report).iter().for_each(|(name, what)| text += &format!("![{what}]({name})\n\n"));
    text
}

fn rows(report: &Report) -> Vec<Vec<String>> {
    report.arms.iter().flat_map(arm_rows).collect()
}

fn arm_rows(arm: &ArmReport) -> Vec<Vec<String>> {
    let source = arm.arm.expect.as_ref().and_then(|e| e.mean);
    let mut rows = vec![row(&arm.arm.name, &arm.rmpm, source)];
    rows.extend(arm.rfem.as_ref().map(|f| row(&format!("{}, RFEM", arm.arm.name), f, None)));
    rows
}

fn row(name: &str, f: &Figures, source: Option<f64>) -> Vec<String> {
    let r = f.sliding_distance_m.as_ref();
    let of = |text: &dyn Fn(&Moments) -> String| r.map_or("-".to_owned(), text);
    let median = |m: &Moments| m.quantiles.iter().find(|q| q.share == 0.5).map_or(f64::NAN, |q| q.value);
    let metres = |v: Option<f64>| v.map_or("-".to_owned(), |v| format!("{v:.2}"));
    let share = |s: &Option<crate::math::stats::Share>| s.as_ref().map_or("-".to_owned(), |s| s.count.to_string());
    let failed = if f.failed > 0 { format!(" ({} failed)", f.failed) } else { String::new() };
    vec![
        name.to_owned(),
        format!("{}{failed}", f.realisations),
        of(&|m| format!("{:.2} +- {:.2}", m.mean, m.mean_se)),
        of(&|m| format!("{:.2} +- {:.2}", m.sd, m.sd_se)),
        of(&|m| format!("{:.2}", median(m))),
        share(&f.no_slide),
        share(&f.at_wall),
        metres(f.deterministic_m),
        metres(source),
        f.slide_volume_m3_per_m.as_ref().map_or("-".to_owned(), |v| format!("{:.1} +- {:.1}", v.mean, v.mean_se)),
        format!("{:.0}", f.cpu_s),
    ]
}
