//! The picture of a comparison: r(t) of all runs, energies, and the final shapes below one another.

use std::{io, path::Path};

use super::{Group, Row, Run, Study};
use crate::{
    case::Case,
    output::{
        pictures,
        plot::{self, AxisSpec, Curve, Dimension, FieldKind, FieldOptions, PALETTE, Part, Rgb, SeriesPlot, Style},
    },
    run::Sample,
    snapshot::Snapshot,
};

/// Width of a plot (pixels); the shapes are as wide as two.
const WIDTH: u32 = 1250;

/// Draws the picture.
///
/// # Errors
/// Those of the file system.
pub fn draw(path: &Path, case: &Case, study: &Study) -> io::Result<()> {
    let rows: Vec<&Row> = study.rows.iter().filter(|r| r.entry.group == Group::Schemes).collect();
    let typical: Vec<(&Row, &Run)> = rows.iter().filter_map(|r| Some((*r, r.typical()?))).collect();
    let (slide, energies) = (sliding_distance(&rows), energies(&typical));
    let plots: Vec<Part<'_>> = match case.slide {
        Some(_) => vec![Part::Series(&slide), Part::Series(&energies)],
        None => vec![Part::Series(&energies)],
    };
    let views: Vec<&Snapshot> = typical.iter().map(|(_, run)| &run.snapshot).collect();
    let options = shapes(case, &typical, WIDTH * plots.len() as u32);
    plot::sheet(path, &[plots, vec![Part::Field(&views, &options)]])
}

/// One colour a scheme.
fn colour(k: usize) -> Rgb {
    PALETTE[k % PALETTE.len()]
}

/// All runs as thin lines, the one nearest to the median as a thick one.
fn sliding_distance(rows: &[&Row]) -> SeriesPlot {
    let points = |run: &Run| run.history.iter().filter_map(|s| Some((s.time, s.sliding_distance?))).collect();
    let mut curves = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        let thin = |run: &Run| Curve {
            thin: true,
            colour: Some(colour(k).paler(0.5)),
            ..Curve::new("", Style::Step, points(run))
        };
        curves.extend(row.runs.iter().filter(|r| r.fault.is_none()).map(thin));
    }
    for (k, row) in rows.iter().enumerate() {
        let typical = row.typical().map(|run| Curve {
            colour: Some(colour(k)),
            dashed: k > 0,
            ..Curve::new(row.entry.variant.clone(), Style::Step, points(run))
        });
        curves.extend(typical);
    }
    SeriesPlot {
        title: Some("Sliding distance: all runs; thick: nearest to the median".to_owned()),
        x: AxisSpec::linear("time (s)"),
        y: AxisSpec::linear("sliding distance r (m)"),
        curves,
        width: WIDTH,
        ..SeriesPlot::default()
    }
}

fn energies(typical: &[(&Row, &Run)]) -> SeriesPlot {
    type Pick = fn(&Sample) -> f64;
    let terms: [(&str, Pick); 5] = [
        ("external", |s| s.energies.external),
        ("dissipated", |s| s.energies.dissipated),
        ("elastic", |s| s.energies.strain),
        ("kinetic", |s| s.energies.kinetic),
        ("numerical", |s| s.energies.numerical),
    ];
    let curve = |scheme: usize, run: &Run, (k, (name, pick)): (usize, (&str, Pick))| Curve {
        dashed: scheme > 0,
        colour: Some(colour(k)),
        ..Curve::new(
            if scheme == 0 { name } else { "" },
            Style::Line,
            run.history.iter().map(|s| (s.time, pick(s))).collect(),
        )
    };
    let runs = typical.iter().enumerate();
    let curves =
        runs.flat_map(|(scheme, (_, run))| terms.into_iter().enumerate().map(move |term| curve(scheme, run, term)));
    SeriesPlot {
        title: Some("Energies; line: explicit, dashes: implicit".to_owned()),
        x: AxisSpec::linear("time (s)"),
        y: AxisSpec::linear("energy (kJ/m)"),
        curves: curves.collect(),
        width: WIDTH,
        ..SeriesPlot::default()
    }
}

/// Final shapes on one scale, with r.
fn shapes(case: &Case, typical: &[(&Row, &Run)], width: u32) -> FieldOptions {
    let kind =
        if crate::run::residual_strain(case).is_some() { FieldKind::PlasticStrain } else { FieldKind::Displacement };
    let mut options = pictures::options(case, kind);
    options.range = pictures::range(case, kind);
    options.width = width;
    let time = |run: &Run| format!("at the end, t = {:.1} s", run.end_time_s);
    options.captions = typical.iter().map(|(row, run)| format!("{}: {}", row.entry.variant, time(run))).collect();
    options.dimensions = typical.iter().enumerate().filter_map(|(k, (_, run))| dimension(case, run, k)).collect();
    options
}

fn dimension(case: &Case, run: &Run, panel: usize) -> Option<Dimension> {
    let (slide, r) = case.slide.as_ref().zip(run.sliding_distance_m)?;
    let [x, y] = [slide.crest[0], slide.crest[1] + 0.8];
    (r > 0.0).then(|| Dimension { panel, from: [x - r, y], to: [x, y], label: format!("r = {r:.2} m") })
}
