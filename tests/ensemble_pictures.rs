//! Pictures of made-up ensembles: 100 values of r in columns of 0.125 m, 8 of no slide, 15 at the wall.
//! `RMPM_PICTURES=DIR` keeps them to be looked at.

use std::path::{Path, PathBuf};
use std::{env, fs};

use rmpm::math::stats::{
    Binning, CONFIDENCE, CensoredFit, Censoring, Exceedance, Histogram, NormalFit, gauss, running,
};
use rmpm::output::plot::{self, FittedNormal, HistogramGroup, Marker, Part, Quantity};

const R: Quantity<'_> = Quantity { name: "sliding distance r", unit: "m" };
const WALL: Censoring = Censoring { low: Some(0.0), high: Some(18.0) };
/// Spacing of the columns (m).
const COLUMN: f64 = 0.125;

/// Quantiles of a normal with these shares at the limits, in columns, in no order.
fn sample(mean: f64, none: usize, wall: usize) -> Vec<f64> {
    let n = 100;
    let at = |k: usize| (k as f64 + 0.5) / n as f64;
    let sd = (18.0 - mean) / -gauss::quantile(wall.max(1) as f64 / n as f64);
    let value = |k: usize| match k {
        k if k < none => 0.0,
        k if k >= n - wall => 20.0,
        k => ((mean + sd * gauss::quantile(at(k))) / COLUMN).round().max(1.0) * COLUMN,
    };
    (0..n).map(|k| value(37 * k % n)).collect()
}

fn three() -> [(&'static str, Vec<f64>); 3] {
    [
        ("(a) θh = 1.0 m", sample(9.4, 0, 1)),
        ("(b) θh = 6.0 m", sample(9.8, 2, 6)),
        ("(c) θh = 48.0 m", sample(10.1, 8, 15)),
    ]
}

fn folder(temporary: &tempfile::TempDir) -> PathBuf {
    let folder = env::var_os("RMPM_PICTURES").map_or_else(|| temporary.path().to_owned(), PathBuf::from);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn assert_is_picture(path: &Path) {
    let bytes = fs::read(path).unwrap();
    assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 5000, "{}", path.display());
}

fn vertical(value: f64, label: &str) -> Marker {
    Marker { value, label: label.into(), vertical: true }
}

fn markers() -> Vec<Marker> {
    let mut markers = vec![vertical(9.0, "deterministic 9.0 m"), vertical(9.8, "mean 9.8 m")];
    markers.extend(plot::limits(&Censoring { low: None, ..WALL }, ["", "wall 18 m"]));
    markers
}

fn fits(sample: &[f64]) -> Vec<FittedNormal> {
    let plain = NormalFit::of(sample).unwrap();
    let censored = CensoredFit::of(sample, &WALL).unwrap();
    let fit = |name: &str, mean: f64, sd: f64, dashed| FittedNormal {
        name: format!("{name}: {mean:.1} ± {sd:.1} m"),
        mean,
        sd,
        dashed,
    };
    vec![fit("normal", plain.mean, plain.sd, true), fit("normal, censored", censored.mean, censored.sd, false)]
}

#[test]
fn histograms_with_their_fits_are_drawn() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = folder(&temporary);
    let samples = three();
    let binning = Binning::of(&samples.each_ref().map(|(_, s)| s.as_slice()), WALL, COLUMN);
    let mut panels: Vec<plot::SeriesPlot> = samples
        .iter()
        .map(|(title, sample)| {
            let histogram = Histogram::of(sample, &binning).unwrap();
            let group = HistogramGroup { name: "n = 100".into(), histogram: &histogram, fits: fits(sample) };
            let mut panel = plot::histograms(R, &[group], markers());
            panel.title = Some((*title).into());
            panel
        })
        .collect();
    let alone = folder.join("ensemble_histogram.png");
    plot::series(&alone, &plot::SeriesPlot { width: 1200, height: 800, ..panels[2].clone() }).unwrap();
    assert_is_picture(&alone);

    plot::share_axes(&mut panels);
    panels.iter_mut().for_each(|p| (p.width, p.height) = (1200, 620));
    let fitted: Vec<FittedNormal> = samples
        .iter()
        .map(|(title, sample)| FittedNormal { name: title[4..].into(), dashed: false, ..fits(sample).remove(1) })
        .collect();
    let mut overlay = plot::densities(R, &fitted, vec![vertical(9.0, "deterministic 9.0 m")]);
    overlay.title = Some("(d) fitted normals".into());
    (overlay.width, overlay.height) = (1200, 620);
    overlay.x.range = panels[0].x.range;
    panels.push(overlay);
    let rows: Vec<Vec<Part<'_>>> = panels.iter().map(|p| vec![Part::Series(p)]).collect();
    plot::sheet(&folder.join("ensemble_panels.png"), &rows).unwrap();
    assert_is_picture(&folder.join("ensemble_panels.png"));
}

/// r of small strains for the same fields: mostly the first slide only.
fn first_slides(sample: &[f64]) -> Vec<f64> {
    let first = |r: f64| if r == 0.0 { 0.0 } else { ((2.0 + 0.12 * r) / COLUMN).round() * COLUMN };
    sample.iter().map(|r| first(*r)).collect()
}

#[test]
fn two_ensembles_are_drawn_over_each_other_and_as_pairs() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = folder(&temporary);
    let rmpm = sample(10.1, 8, 15);
    let rfem = first_slides(&rmpm);
    let binning = Binning::of(&[&rmpm, &rfem], WALL, COLUMN);
    let histograms = [&rfem, &rmpm].map(|s| Histogram::of(s, &binning).unwrap());
    let group = |name: &str, histogram, sample: &[f64]| {
        let fit = fits(sample).remove(1);
        HistogramGroup { name: name.into(), histogram, fits: vec![fit] }
    };
    let groups = [group("RFEM", &histograms[0], &rfem), group("RMPM", &histograms[1], &rmpm)];
    let mut chart = plot::histograms(R, &groups, vec![vertical(9.0, "deterministic 9.0 m")]);
    (chart.width, chart.height) = (1200, 800);
    plot::series(&folder.join("ensemble_overlay.png"), &chart).unwrap();
    assert_is_picture(&folder.join("ensemble_overlay.png"));

    let both: Vec<(f64, f64)> = rfem.iter().copied().zip(rmpm.iter().copied()).collect();
    let named = |name| Quantity { name, unit: "m" };
    let chart = plot::pairs(named("r of RFEM"), named("r of RMPM"), &both);
    plot::series(&folder.join("ensemble_pairs.png"), &chart).unwrap();
    assert_is_picture(&folder.join("ensemble_pairs.png"));
}

#[test]
fn exceedance_and_settling_moments_are_drawn() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = folder(&temporary);
    let sample = sample(10.1, 8, 15);
    let curve = Exceedance::of(&sample, WALL.high, CONFIDENCE).unwrap();
    let chart = plot::SeriesPlot { width: 1200, height: 800, ..plot::exceedance(R, &curve, markers()) };
    plot::series(&folder.join("ensemble_exceedance.png"), &chart).unwrap();
    assert_is_picture(&folder.join("ensemble_exceedance.png"));

    let plots = plot::settling(R, &running(&sample)).map(|p| plot::SeriesPlot { width: 1200, height: 560, ..p });
    let rows: Vec<Vec<Part<'_>>> = plots.iter().map(|p| vec![Part::Series(p)]).collect();
    plot::sheet(&folder.join("ensemble_settling.png"), &rows).unwrap();
    assert_is_picture(&folder.join("ensemble_settling.png"));
}

#[test]
fn what_has_no_values_is_drawn_empty() {
    let none = Histogram { n: 0, bins: Vec::new(), below: None, above: None };
    let group = HistogramGroup { name: String::new(), histogram: &none, fits: vec![] };
    plot::series_png(&plot::histograms(R, &[group], vec![])).unwrap();
    plot::series_png(&plot::histograms(R, &[], vec![])).unwrap();
    plot::series_png(&plot::densities(R, &[], vec![])).unwrap();
    plot::series_png(&plot::pairs(R, R, &[(f64::NAN, 1.0)])).unwrap();
    plot::settling(R, &[]).iter().for_each(|p| drop(plot::series_png(p).unwrap()));
    let one = Exceedance::of(&[3.0], None, CONFIDENCE).unwrap();
    plot::series_png(&plot::exceedance(R, &one, vec![])).unwrap();
    plot::share_axes(&mut []);
}
