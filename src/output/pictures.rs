//! The pictures of a run, drawn from its frames and its history.

mod mechanism;
mod process;

use std::{io, path::Path};

use super::{
    plot::{self, AxisSpec, Curve, Dimension, FieldKind, FieldOptions, Marker, SeriesPlot, Style},
    vtk,
};
use crate::{
    case::Case,
    measure::{Plateau, plateaus},
    run::Sample,
    snapshot::Snapshot,
};

/// Frames nearest to the wanted times, in order and without repeats. Without wanted times: the
/// first, and five spread evenly from the onset to the end.
pub fn choose(frames: &[(f64, String)], wanted: &[f64], onset: f64) -> Vec<usize> {
    let end = frames.last().map_or(0.0, |(t, _)| *t);
    let usual = std::iter::once(0.0).chain((0..5).map(|k| onset + (end - onset) * f64::from(k) / 4.0));
    let wanted: Vec<f64> = if wanted.is_empty() { usual.collect() } else { wanted.to_vec() };
    let mut chosen: Vec<usize> = wanted.iter().filter_map(|t| nearest(frames, *t)).collect();
    chosen.dedup();
    chosen
}

/// When the soil gets going (s): the kinetic energy first exceeds a tenth of its largest value.
pub fn onset(rows: &[Sample]) -> f64 {
    let peak = rows.iter().map(|s| s.energies.kinetic).fold(0.0, f64::max);
    rows.iter().find(|s| s.energies.kinetic > 0.1 * peak).map_or(0.0, |s| s.time)
}

fn nearest(frames: &[(f64, String)], time: f64) -> Option<usize> {
    (0..frames.len()).min_by(|&a, &b| (frames[a].0 - time).abs().total_cmp(&(frames[b].0 - time).abs()))
}

/// Reads the chosen frames of a run folder.
pub fn load(folder: &Path, frames: &[(f64, String)], chosen: &[usize]) -> io::Result<Vec<Snapshot>> {
    chosen.iter().filter_map(|&k| frames.get(k)).map(|(_, name)| vtk::read_vtp(&folder.join(name))).collect()
}

/// The look of this case's field pictures.
pub fn options(case: &Case, kind: FieldKind) -> FieldOptions {
    let mut outline = case.region.first().map(|r| r.shape.corners()).unwrap_or_default();
    outline.extend(outline.first().copied());
    FieldOptions {
        kind,
        range: None,
        title: Some(case.title.clone()),
        outline: if case.region.len() == 1 { outline } else { Vec::new() },
        base: Some(case.grid.origin[1]),
        material_names: case.material.keys().cloned().collect(),
        ..FieldOptions::default()
    }
}

/// The whole set; `began` is the onset of failure (s), where there was one: shape by plastic strain, strength and stage; r(t); energies.
pub fn draw(
    folder: &Path,
    case: &Case,
    rows: &[Sample],
    frames: &[(f64, String)],
    began: Option<f64>,
) -> io::Result<()> {
    process::draw(folder, case, frames, began, &blocks(case, rows))?;
    if case.strength_reduction.is_some() {
        mechanism::draw(folder, case, frames, began)?;
    }
    let snapshots = load(folder, frames, &choose(frames, &case.output.pictures, onset(rows)))?;
    let views: Vec<&Snapshot> = snapshots.iter().collect();
    let to = |name: &str| folder.join("pictures").join(name);
    let strong = snapshots.iter().any(|s| s.strength.iter().any(|c| c.is_finite()));
    if !views.is_empty() {
        if strong {
            for kind in [FieldKind::PlasticStrain, FieldKind::Strength, FieldKind::Stage] {
                let mut o = options(case, kind);
                o.range = range(case, kind);
                o.dimensions = distance(case, rows, &views);
                plot::field(&to(&format!("{}.png", kind.name())), &views, &o)?;
            }
        }
        plot::field(&to("displacement.png"), &views, &options(case, FieldKind::Displacement))?;
    }
    if case.slide.is_some() {
        plot::series(&to("sliding_distance.png"), &sliding_distance(rows, &blocks(case, rows)))?;
    }
    plot::series(&to("energies.png"), &energies(rows))
}

/// A fixed colour scale for plastic strain, so that runs can be compared: up to twice the strain
/// at which the strength is residual.
pub fn range(case: &Case, kind: FieldKind) -> Option<(f64, f64)> {
    let residual = crate::run::residual_strain(case)?;
    match kind {
        FieldKind::PlasticStrain => Some((0.0, 2.0 * residual)),
        _ => None,
    }
}

/// The arrow of r in the last panel, as the paper draws it, at the time of that panel.
pub fn distance(case: &Case, rows: &[Sample], views: &[&Snapshot]) -> Vec<Dimension> {
    let (Some(slide), Some(last)) = (&case.slide, views.last()) else { return Vec::new() };
    let gap = |s: &&Sample| (s.time - last.time).abs();
    let nearest = rows.iter().min_by(|a, b| gap(a).total_cmp(&gap(b)));
    let r = nearest.and_then(|s| s.sliding_distance).unwrap_or(0.0);
    if r <= 0.0 {
        return Vec::new();
    }
    let y = slide.crest[1] + 0.8;
    vec![Dimension {
        panel: views.len() - 1,
        from: [slide.crest[0] - r, y],
        to: [slide.crest[0], y],
        label: format!("r = {r:.2} m"),
    }]
}

/// Blocks of the slide, from the history.
fn blocks(case: &Case, rows: &[Sample]) -> Vec<Plateau> {
    let Some(slide) = &case.slide else { return Vec::new() };
    let (time, r): (Vec<f64>, Vec<f64>) = rows.iter().map(|s| (s.time, s.sliding_distance.unwrap_or(0.0))).unzip();
    plateaus(&time, &r, slide.block_hold, slide.block_length)
}

fn sliding_distance(rows: &[Sample], blocks: &[Plateau]) -> SeriesPlot {
    let points = rows.iter().filter_map(|s| Some((s.time, s.sliding_distance?))).collect();
    let marker = |p: &Plateau| Marker {
        value: p.sliding_distance_m,
        label: format!("{:.2} m at {:.1} s", p.sliding_distance_m, p.from_s),
        vertical: false,
    };
    SeriesPlot {
        title: Some("Retrogression: each plateau is a block".to_owned()),
        x: AxisSpec::linear("time (s)"),
        y: AxisSpec::linear("sliding distance r (m)"),
        curves: vec![Curve::new("", Style::Step, points)],
        markers: blocks.iter().map(marker).collect(),
        ..SeriesPlot::default()
    }
}

fn energies(rows: &[Sample]) -> SeriesPlot {
    type Pick = fn(&Sample) -> f64;
    let curves: [(&str, Pick); 5] = [
        ("external (gravity)", |s| s.energies.external),
        ("dissipated", |s| s.energies.dissipated),
        ("elastic", |s| s.energies.strain),
        ("kinetic", |s| s.energies.kinetic),
        ("numerical", |s| s.energies.numerical),
    ];
    let curve =
        |(name, pick): (&str, Pick)| Curve::new(name, Style::Line, rows.iter().map(|s| (s.time, pick(s))).collect());
    SeriesPlot {
        title: Some("Energies: external = kinetic + elastic + dissipated + numerical".to_owned()),
        x: AxisSpec::linear("time (s)"),
        y: AxisSpec::linear("energy (kJ/m)"),
        curves: curves.map(curve).to_vec(),
        ..SeriesPlot::default()
    }
}
