//! All pictures and a frame of a made-up slope. `RMPM_PICTURES=DIR` keeps them to be looked at.

use std::path::{Path, PathBuf};
use std::{env, fs};

use rmpm::math::tensor::Voigt;
use rmpm::output::{plot, vtk};
use rmpm::snapshot::{Snapshot, Stage};

/// Side of a cell (m).
const CELL: f64 = 0.25;
/// The initial shape: 5 m high, 45 degrees, 20 m from the crest to the left (m).
const OUTLINE: [[f64; 2]; 5] = [[0.0, 0.0], [25.0, 0.0], [20.0, 5.0], [0.0, 5.0], [0.0, 0.0]];

/// 2 x 2 Gauss points of all cells that touch the slope, after a slide of `slide` metres: 7240.
fn slope(time: f64, slide: f64) -> Snapshot {
    let mut s = Snapshot { time, step: (time * 1000.0) as u64, ..Snapshot::default() };
    for row in 0..20 {
        for column in 0..100 - row {
            for (i, j) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
                let gauss = |k: i32, s: f64| CELL * (f64::from(k) + 0.5 + 0.5 * s / 3.0_f64.sqrt());
                push(&mut s, [gauss(column, i), gauss(row, j)], slide);
            }
        }
    }
    s
}

/// A point of a body that turns on a slip circle by `slide` metres at the circle: an isochoric
/// motion.
fn push(s: &mut Snapshot, x0: [f64; 2], slide: f64) {
    const CENTRE: [f64; 2] = [22.0, 8.0];
    let arm = [x0[0] - CENTRE[0], x0[1] - CENTRE[1]];
    let distance = 7.5 - arm[0].hypot(arm[1]);
    let share = 1.0 / (1.0 + (-6.0 * distance).exp());
    let (sin, cos) = (slide * share / 7.5).sin_cos();
    let x = [CENTRE[0] + cos * arm[0] - sin * arm[1], CENTRE[1] + sin * arm[0] + cos * arm[1]];
    let plastic = slide * 6.0 * share * (1.0 - share) + 0.02 * slide * (2.0 * x0[0]).sin().abs() * share;
    let peak = 20.0 * (1.0 + 0.25 * (0.9 * x0[0] + (3.0 * x0[1]).sin()).sin() * (2.5 * x0[1]).cos());
    s.position.push(x);
    s.reference.push(x0);
    s.velocity.push([share * slide, -0.2 * share * slide]);
    s.mass.push(2.0 * CELL * CELL / 4.0);
    s.initial_volume.push(CELL * CELL / 4.0);
    s.jacobian.push(1.0);
    let weight = -20.0 * (5.0 - x0[1]);
    s.stress.push(Voigt { xx: 0.5 * weight, yy: weight, zz: 0.5 * weight, xy: 0.0 });
    s.plastic_strain.push(plastic);
    s.strength.push((peak - 50.0 * plastic).max(0.2 * peak));
    s.peak_strength.push(peak);
    s.stage.push(match plastic {
        p if p > 0.32 => Stage::Residual,
        p if p > 0.1 => Stage::Softening,
        p if p > 0.02 => Stage::Unloading,
        _ => Stage::Elastic,
    });
    s.material.push(u16::from(x0[1] < 1.0));
    s.strain_energy.push(1e-3);
}

fn folder(temporary: &tempfile::TempDir) -> PathBuf {
    let kept = env::var_os("RMPM_PICTURES").map(PathBuf::from);
    let folder = kept.unwrap_or_else(|| temporary.path().to_owned());
    fs::create_dir_all(folder.join("frames")).unwrap();
    folder
}

fn assert_is_picture(path: &Path) {
    let bytes = fs::read(path).unwrap();
    assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 5000, "{}", path.display());
}

#[test]
fn every_field_of_a_slope_is_drawn() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = folder(&temporary);
    let frames = [slope(0.0, 0.0), slope(5.8, 1.2), slope(11.0, 3.0)];
    assert_eq!(frames[0].len(), 7240);
    for kind in plot::FieldKind::ALL {
        let dimension = plot::Dimension { panel: 0, from: [15.1, 5.5], to: [20.0, 5.5], label: "r = 4.9 m".into() };
        let options = plot::FieldOptions {
            kind,
            title: Some(format!("Made-up slope, {}", kind.name())),
            outline: OUTLINE.to_vec(),
            base: Some(0.0),
            dimensions: vec![dimension],
            ..plot::FieldOptions::default()
        };
        let path = folder.join(format!("{}.png", kind.name()));
        plot::field(&path, &[&frames[2]], &options).unwrap();
        assert_is_picture(&path);
    }
    let stacked =
        plot::FieldOptions { outline: OUTLINE.to_vec(), range: Some((0.0, 0.32)), ..plot::FieldOptions::default() };
    plot::field(&folder.join("stacked.png"), &frames.each_ref(), &stacked).unwrap();
    assert_is_picture(&folder.join("stacked.png"));
}

#[test]
fn series_and_intervals_are_drawn() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = folder(&temporary);
    draw_sliding_distance(&folder.join("sliding_distance.png"));
    draw_energies(&folder.join("energies.png"));
    draw_convergence(&folder.join("convergence.png"));
    draw_histogram(&folder.join("histogram.png"));
    draw_intervals(&folder.join("intervals.png"), 6);
    draw_intervals(&folder.join("intervals_many.png"), 16);
}

fn draw_sliding_distance(path: &Path) {
    let points = vec![(0.0, 0.0), (5.8, 2.9), (8.9, 5.5), (11.0, 8.8), (17.0, 8.8)];
    let marker = |value, label: &str| plot::Marker { value, label: label.into(), vertical: false };
    let chart = plot::SeriesPlot {
        title: Some("Sliding distance".into()),
        x: plot::AxisSpec::linear("time (s)"),
        y: plot::AxisSpec::linear("sliding distance r (m)"),
        curves: vec![plot::Curve::new("0.25 m moved", plot::Style::Step, points)],
        markers: vec![
            marker(9.0, "paper: 9.0 m"),
            marker(9.1, "mean: 9.1 m"),
            plot::Marker { value: 5.0, label: "gravity complete".into(), vertical: true },
        ],
        bands: vec![plot::Band { from: 13.0, to: 17.0, label: "at rest".into() }],
        ..plot::SeriesPlot::default()
    };
    plot::series(path, &chart).unwrap();
    assert_is_picture(path);
}

fn draw_energies(path: &Path) {
    let curve = |name: &str, f: fn(f64) -> f64| {
        let points = (0..20_000).map(|i| f64::from(i) * 1e-3).map(|t| (t, f(t))).collect();
        plot::Curve::new(name, plot::Style::Line, points)
    };
    let mut numerical = curve("numerical", |t| -3.0 * (t / 4.0).sqrt());
    numerical.dashed = true;
    let chart = plot::SeriesPlot {
        x: plot::AxisSpec::linear("time (s)"),
        y: plot::AxisSpec::linear("energy (kJ/m)"),
        curves: vec![
            curve("kinetic", |t| 60.0 * (-(t - 7.0).powi(2) / 4.0).exp() * (1.0 + 0.2 * (20.0 * t).sin())),
            curve("strain", |t| 40.0 * (t / 5.0).min(1.0)),
            curve("external work", |t| 400.0 / (1.0 + (7.0 - t).exp())),
            curve("dissipated", |t| 330.0 / (1.0 + (8.0 - t).exp())),
            numerical,
        ],
        ..plot::SeriesPlot::default()
    };
    plot::series(path, &chart).unwrap();
    assert_is_picture(path);
}

fn draw_convergence(path: &Path) {
    let cells = [8.0, 16.0, 32.0, 64.0, 128.0];
    let power = |c: f64, n: f64| cells.iter().map(|x: &f64| (*x, c * x.powf(-n))).collect::<Vec<_>>();
    let mut gimp = plot::Curve::new("GIMP", plot::Style::LinePoints, power(0.8, 2.0));
    gimp.spread = gimp.points.iter().map(|p| (0.6 * p.1, 1.7 * p.1)).collect();
    let mut slope = plot::Curve::new("slope −2", plot::Style::Line, power(0.3, 2.0));
    slope.dashed = true;
    let chart = plot::SeriesPlot {
        title: Some("Self-weight column".into()),
        x: plot::AxisSpec::log("cells over the height (-)"),
        y: plot::AxisSpec::log("stress error (-)"),
        curves: vec![gimp, plot::Curve::new("linear", plot::Style::Points, power(0.09, 0.1)), slope],
        ..plot::SeriesPlot::default()
    };
    plot::series(path, &chart).unwrap();
    assert_is_picture(path);
}

fn draw_histogram(path: &Path) {
    let normal = |r: f64| (-0.5 * ((r - 9.75) / 2.5).powi(2)).exp() / (2.5 * (2.0 * std::f64::consts::PI).sqrt());
    let bar = |k: i32| plot::Bar {
        from: f64::from(k),
        to: f64::from(k) + 1.0,
        height: normal(f64::from(k) + 0.5) * (1.0 + 0.3 * f64::from(k).sin()),
        label: String::new(),
    };
    let curve = (0..200).map(|i| f64::from(i) * 0.1).map(|r| (r, normal(r))).collect();
    let chart = plot::SeriesPlot {
        title: Some("θh = 6 m, 100 realisations".into()),
        x: plot::AxisSpec::linear("sliding distance r (m)"),
        y: plot::AxisSpec::linear("probability density (1/m)"),
        bars: vec![plot::Bars { bars: (0..20).map(bar).collect(), ..plot::Bars::default() }],
        curves: vec![plot::Curve::new("normal, μ = 9.75 m, σ = 2.5 m", plot::Style::Line, curve)],
        ..plot::SeriesPlot::default()
    };
    plot::series(path, &chart).unwrap();
    assert_is_picture(path);
}

fn draw_intervals(path: &Path, count: usize) {
    let item = |k: usize| {
        let values: Vec<f64> = (0..12).map(|i| 9.0 + ((7 * i + 3 * k) % 12) as f64 / 4.0 - 1.2).collect();
        let label =
            if count < 10 { format!("h = {:.3} m", 0.5 / (k + 1) as f64) } else { format!("variant {k} of many") };
        plot::Interval { label, low: 8.4, median: 9.1 + 0.1 * k as f64, high: 10.6, values }
    };
    let chart = plot::IntervalPlot {
        title: Some("Jittered runs of each variant".into()),
        x_label: "variant".into(),
        y: plot::AxisSpec { range: Some((0.0, 14.0)), ..plot::AxisSpec::linear("sliding distance r (m)") },
        items: (0..count).map(item).collect(),
        markers: vec![(9.0, "paper: 9.0 m".into())],
        ..plot::IntervalPlot::default()
    };
    plot::intervals(path, &chart).unwrap();
    assert_is_picture(path);
}

#[test]
fn frames_and_their_list_are_written() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = folder(&temporary);
    let mut list = Vec::new();
    for (k, time, slide) in [(0, 0.0, 0.0), (1, 5.8, 1.2), (2, 11.0, 3.0)] {
        let name = format!("frames/{k:06}.vtp");
        let snapshot = slope(time, slide);
        vtk::write_vtp(&folder.join(&name), &snapshot).unwrap();
        assert_eq!(vtk::read_vtp(&folder.join(&name)).unwrap().position, snapshot.position);
        list.push((time, name));
    }
    vtk::write_pvd(&folder.join("run.pvd"), &list).unwrap();
}
