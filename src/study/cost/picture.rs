//! The picture of a study: error over CPU time and over work, with the front of each.

use std::{io, path::Path};

use super::{Row, Study, table::caption};
use crate::output::plot::{self, AxisSpec, Curve, PALETTE, Part, Rgb, SeriesPlot, Style};

/// Width of one of the two plots (pixels).
const WIDTH: u32 = 1250;
const FRONT: Rgb = Rgb(25, 25, 25);

/// What is plotted along x.
type Cost = fn(&Row) -> f64;

/// Draws the picture. Runs without an error, the reference, and errors of exactly 0 have no place on a logarithmic
/// axis and are left out; the table has them.
///
/// # Errors
/// Those of the file system.
pub fn draw(path: &Path, study: &Study) -> io::Result<()> {
    let time = panel(study, "CPU time (s)", |r| r.cpu_s.unwrap_or(f64::NAN), |r| r.on_front);
    let work = panel(study, "blocks sent through the law", |r| r.work.law_blocks as f64, |r| r.on_work_front);
    plot::sheet(path, &[vec![Part::Series(&time), Part::Series(&work)]])
}

fn panel(study: &Study, cost_label: &str, cost: Cost, on_front: fn(&Row) -> bool) -> SeriesPlot {
    let percent = study.is_relative();
    let error = if percent { "error (%)".to_owned() } else { format!("error ({})", study.quantity.unit()) };
    let scale = if percent { 100.0 } else { 1.0 };
    let mut families: Vec<&str> = Vec::new();
    for row in &study.rows {
        if !families.contains(&row.family.as_str()) {
            families.push(&row.family);
        }
    }
    let curve = |(k, family): (usize, &&str)| Curve {
        colour: Some(PALETTE[k % PALETTE.len()]),
        ..Curve::new(*family, Style::Points, points(study, cost, scale, |r| r.family == **family))
    };
    let mut front = points(study, cost, scale, on_front);
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let front = Curve { colour: Some(FRONT), dashed: true, ..Curve::new("front", Style::Step, front) };
    SeriesPlot {
        title: Some(caption(study)),
        x: AxisSpec::log(cost_label),
        y: AxisSpec::log(error),
        curves: std::iter::once(front).chain(families.iter().enumerate().map(curve)).collect(),
        width: WIDTH,
        ..SeriesPlot::default()
    }
}

fn points(study: &Study, cost: Cost, scale: f64, of: impl Fn(&Row) -> bool) -> Vec<(f64, f64)> {
    let rows = study.rows.iter().filter(|r| of(r) && !r.is_reference);
    let found = rows.filter_map(|r| Some((cost(r), scale * r.error?)));
    found.filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite()).collect()
}
