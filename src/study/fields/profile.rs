//! The picture of how a parameter varies (the paper's Fig. 2): over the depth, and about its mean.

use std::{io, path::Path};

use super::FieldReport;
use crate::{
    case,
    field::model::Drawn,
    math::stats::{Binning, Censoring, Histogram, gauss},
    output::plot::{self, AxisSpec, Curve, HistogramGroup, Part, Quantity, Rgb, SeriesPlot, Style},
};

/// Of the lines that are no values of the realisation.
const DARK: Rgb = Rgb(60, 60, 60);

/// Columns of cells that are drawn, as shares of the width.
const COLUMNS: [f64; 3] = [0.1, 0.5, 0.9];

/// Draws, for the first realisation, values along a few verticals with the mean and one standard deviation of a point
/// to both sides; and, for all realisations, the density of the values with the trend of the mean taken out.
/// `trend` is the mean at a height (m) over that at the datum.
///
/// # Errors
/// Those of the file system.
pub fn profile(path: &Path, report: &FieldReport, trend: &dyn Fn(f64) -> f64, drawn: &[Drawn]) -> io::Result<()> {
    let Some((first, parameter)) = drawn.first().zip(report.parameters.first()) else { return Ok(()) };
    let name = parameter.word().replace('_', " ");
    let quantity = Quantity { name: &name, unit: if report.unit.is_empty() { "-" } else { report.unit } };
    let depth = over_depth(report, &quantity, trend, first);
    let density = density(report, quantity, drawn);
    plot::sheet(path, &[vec![Part::Series(&depth), Part::Series(&density)]])
}

fn over_depth(report: &FieldReport, quantity: &Quantity, trend: &dyn Fn(f64) -> f64, drawn: &Drawn) -> SeriesPlot {
    let [nx, ny] = report.cells;
    let height = |row: usize| report.origin_m[1] + (row as f64 + 0.5) * report.cell_m[1];
    let line = |value: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        (0..ny).map(|row| (report.mean * trend(height(row)) * value(row), height(row))).collect()
    };
    let column = |share: &f64| {
        let k = ((share * nx as f64) as usize).min(nx - 1);
        let x = report.origin_m[0] + (k as f64 + 0.5) * report.cell_m[0];
        let factor = |row: usize| drawn.factors.get(row * nx + k).copied().unwrap_or(f64::NAN);
        Curve::new(format!("x = {x:.2} m"), Style::Line, line(&factor))
    };
    let variation = report.sd / report.mean;
    let dark = |name: &str, dashed: bool, factor: f64| Curve {
        dashed,
        colour: Some(DARK),
        ..Curve::new(name, Style::Line, line(&|_| factor))
    };
    let mut curves: Vec<Curve> = COLUMNS.iter().map(column).collect();
    // one name for the pair
    curves.extend([
        dark("mean", false, 1.0),
        dark("mean +- sd", true, 1.0 - variation),
        dark("", true, 1.0 + variation),
    ]);
    SeriesPlot {
        title: Some(format!("Realisation {}: over the depth", report.realisations.first().copied().unwrap_or(0))),
        x: AxisSpec::linear(format!("{} ({})", quantity.name, quantity.unit)),
        y: AxisSpec::linear("y (m)"),
        curves,
        ..SeriesPlot::default()
    }
}

fn density(report: &FieldReport, quantity: Quantity, drawn: &[Drawn]) -> SeriesPlot {
    let values: Vec<f64> = drawn.iter().flat_map(|d| &d.factors).map(|f| report.mean * f).collect();
    let histogram = Histogram::of(&values, &Binning::of(&[&values], Censoring::default(), 0.0));
    let groups: Vec<HistogramGroup> = histogram
        .iter()
        .map(|histogram| HistogramGroup { name: format!("{} cells", values.len()), histogram, fits: Vec::new() })
        .collect();
    let mut plot = plot::histograms(quantity, &groups, Vec::new());
    // counts of thousands of cells say nothing beside the density
    plot.bars.iter_mut().flat_map(|bars| &mut bars.bars).for_each(|bar| bar.label.clear());
    plot.curves.push(Curve::new("points, as asked for", Style::Line, marginal(report)));
    plot.title = Some(format!("{} realisations: about the mean, averaged over cells", drawn.len()));
    plot
}

/// Density of point values at the datum, over three and a half standard deviations to both sides.
fn marginal(report: &FieldReport) -> Vec<(f64, f64)> {
    const POINTS: u32 = 400;
    let (mean, sd) = (report.mean, report.sd.abs());
    let (low, high) = (mean - 3.5 * sd, mean + 3.5 * sd);
    let variation = sd / mean.abs();
    let log_sd = variation.powi(2).ln_1p().sqrt();
    let at = |value: f64| match report.marginal {
        case::Marginal::Normal { .. } => gauss::density((value - mean) / sd) / sd,
        // the density of exp(s Z - s^2 / 2) times the mean
        case::Marginal::Lognormal => {
            let ratio = value / mean;
            if ratio <= 0.0 { 0.0 } else { gauss::density(ratio.ln() / log_sd + 0.5 * log_sd) / (log_sd * value.abs()) }
        }
    };
    let points = (0..=POINTS).map(|k| low + (high - low) * f64::from(k) / f64::from(POINTS));
    points.map(|v| (v, at(v))).filter(|(_, d)| d.is_finite()).collect()
}
