//! The pictures of a study: histograms of each group with the fits over each other (the paper's Fig. 6),
//! and RFEM against RMPM (Fig. 7).

use std::{io, path::Path};

use super::{ArmReport, Figures, Pairs, Report};
use crate::{
    case::folder_name,
    math::stats::{Binning, Censoring, Histogram},
    output::plot::{
        self, FittedNormal, HistogramGroup, Marker, Part, Quantity, SeriesPlot, densities, histograms, pairs,
    },
};

const R: Quantity<'static> = Quantity { name: "sliding distance r", unit: "m" };

/// Names of the pictures, with what each shows.
pub fn names(report: &Report) -> Vec<(String, String)> {
    let groups = groups(report).into_iter().map(|(name, _)| (histogram_name(name), format!("Histograms of r, {name}")));
    let paired = report.arms.iter().filter(|a| a.pairs.is_some());
    groups.chain(paired.map(|a| (pairs_name(a), format!("RMPM and RFEM on the same fields, {}", a.arm.name)))).collect()
}

/// Draws all pictures into the folder of the study.
///
/// # Errors
/// Those of the file system.
pub fn draw(out: &Path, report: &Report) -> io::Result<()> {
    for (name, arms) in groups(report) {
        group(&out.join(histogram_name(name)), &arms)?;
    }
    for arm in &report.arms {
        if let Some((found, rfem)) = arm.pairs.as_ref().zip(arm.rfem.as_ref()) {
            compared(&out.join(pairs_name(arm)), arm, found, rfem)?;
        }
    }
    Ok(())
}

/// Arms that share a picture: those of a group, and each alone that has none. Names that differ in signs
/// alone have one file, and so one picture.
fn groups(report: &Report) -> Vec<(&str, Vec<&ArmReport>)> {
    let mut found: Vec<(&str, Vec<&ArmReport>)> = Vec::new();
    for arm in report.arms.iter().filter(|a| !a.rmpm.values.is_empty()) {
        let name = if arm.arm.group.is_empty() { &arm.arm.name } else { &arm.arm.group };
        match found.iter_mut().find(|(n, _)| histogram_name(n) == histogram_name(name)) {
            Some((_, arms)) => arms.push(arm),
            None => found.push((name, vec![arm])),
        }
    }
    found
}

fn histogram_name(group: &str) -> String {
    format!("histograms-{}.png", folder_name(group))
}

fn pairs_name(arm: &ArmReport) -> String {
    format!("{}-pairs.png", arm.folder)
}

fn group(path: &Path, arms: &[&ArmReport]) -> io::Result<()> {
    let mut plots: Vec<SeriesPlot> = arms.iter().filter_map(|a| single(a)).collect();
    plot::share_axes(&mut plots);
    if arms.len() > 1 {
        let fits: Vec<FittedNormal> = arms.iter().filter_map(|a| fit(&a.rmpm, a.arm.name.clone(), false)).collect();
        plots.push(titled(densities(R, &fits, Vec::new()), "Fitted normal distributions over each other"));
    }
    let rows: Vec<Vec<Part>> = plots.chunks(2).map(|row| row.iter().map(Part::Series).collect()).collect();
    plot::sheet(path, &rows)
}

fn single(arm: &ArmReport) -> Option<SeriesPlot> {
    let f = &arm.rmpm;
    let censoring = Censoring { low: Some(0.0), high: f.wall_m };
    let histogram = Histogram::of(&f.values, &Binning::of(&[&f.values], censoring, f.resolution_m))?;
    let fits = [fit(f, "normal, plain".to_owned(), false), censored(f)].into_iter().flatten().collect();
    let group = HistogramGroup { name: format!("{} realisations", f.values.len()), histogram: &histogram, fits };
    let mut markers = Vec::new();
    markers.extend(f.deterministic_m.map(|r| vertical(r, format!("all at the mean: {r:.2} m"))));
    let expected = arm.arm.expect.as_ref().and_then(|e| Some((e.mean?, &e.source)));
    markers.extend(expected.map(|(mean, source)| vertical(mean, format!("mean, {source}: {mean:.2} m"))));
    Some(titled(histograms(R, &[group], markers), &arm.arm.name))
}

fn vertical(value: f64, label: String) -> Marker {
    Marker { value, label, vertical: true }
}

fn titled(plot: SeriesPlot, title: &str) -> SeriesPlot {
    SeriesPlot { title: Some(title.to_owned()), ..plot }
}

fn fit(f: &Figures, name: String, dashed: bool) -> Option<FittedNormal> {
    let m = f.sliding_distance_m.as_ref().filter(|m| m.sd > 0.0)?;
    Some(FittedNormal { name, mean: m.mean, sd: m.sd, dashed })
}

fn censored(f: &Figures) -> Option<FittedNormal> {
    let fit = f.censored_fit.as_ref().filter(|c| c.below + c.above > 0)?;
    Some(FittedNormal { name: "normal, limits as limits".to_owned(), mean: fit.mean, sd: fit.sd, dashed: true })
}

/// Histograms of both methods over each other, and the pairs.
fn compared(path: &Path, arm: &ArmReport, found: &Pairs, rfem: &Figures) -> io::Result<()> {
    let censoring = Censoring { low: Some(0.0), high: arm.rmpm.wall_m };
    let binning = Binning::of(&[&arm.rmpm.values, &rfem.values], censoring, arm.rmpm.resolution_m);
    let each = [("RMPM", &arm.rmpm), ("RFEM", rfem)];
    let drawn = each.map(|(name, f)| (name, Histogram::of(&f.values, &binning)));
    let groups: Vec<HistogramGroup> = drawn
        .iter()
        .filter_map(|(name, h)| {
            Some(HistogramGroup { name: (*name).to_owned(), histogram: h.as_ref()?, fits: Vec::new() })
        })
        .collect();
    let over =
        titled(histograms(R, &groups, Vec::new()), &format!("{}: the same fields by both methods", arm.arm.name));
    let points: Vec<(f64, f64)> = found.pairs.iter().map(|p| (p.rmpm_m, p.rfem_m)).collect();
    let [x, y] = ["r of RMPM", "r of RFEM"].map(|name| Quantity { name, unit: "m" });
    let scatter = titled(pairs(x, y, &points), "Each realisation by both methods");
    plot::sheet(path, &[vec![Part::Series(&over), Part::Series(&scatter)]])
}
