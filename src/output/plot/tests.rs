use std::time::Instant;

use super::axes::Axis;
use super::canvas::Canvas;
use super::colour::{NO_VALUE, WHITE};
use super::points::Raster;
use super::view::side;
use super::*;
use super::{clip, field as field_mod, font, place, series as series_mod, text, ticks};
use crate::math::tensor::Voigt;
use crate::snapshot::{Snapshot, Stage};

/// Squares of side `h` at the given places.
fn body(places: &[[f64; 2]], h: f64) -> Snapshot {
    let n = places.len();
    Snapshot {
        position: places.to_vec(),
        reference: places.to_vec(),
        velocity: vec![[0.0; 2]; n],
        mass: vec![1.0; n],
        initial_volume: vec![h * h; n],
        jacobian: vec![1.0; n],
        stress: vec![Voigt::default(); n],
        plastic_strain: vec![0.1; n],
        strength: vec![20.0; n],
        peak_strength: vec![f64::NAN; n],
        stage: vec![Stage::Elastic; n],
        material: vec![0; n],
        strain_energy: vec![0.0; n],
        ..Snapshot::default()
    }
}

/// The four Gauss points of `nx` by `ny` cells of side 2 h.
fn gauss(nx: usize, ny: usize, h: f64) -> Vec<[f64; 2]> {
    let line = |n: usize| {
        (0..n)
            .flat_map(move |i| [-1.0, 1.0].map(|s| h * (2.0 * i as f64 + 1.0 + s / 3.0_f64.sqrt())))
            .collect::<Vec<_>>()
    };
    line(ny).iter().flat_map(|y| line(nx).into_iter().map(|x| [x, *y])).collect()
}

fn options(kind: FieldKind) -> FieldOptions {
    FieldOptions { kind, ..FieldOptions::default() }
}

/// Extent of the pixels that satisfy a test, with their count: (x0, y0, x1, y1, count).
fn extent(canvas: &Canvas, test: impl Fn(Rgb) -> bool) -> (i32, i32, i32, i32, i32) {
    let mut e = (i32::MAX, i32::MAX, i32::MIN, i32::MIN, 0);
    for y in 0..canvas.height() {
        for x in (0..canvas.width()).filter(|x| test(canvas.get(*x, y))) {
            e = (e.0.min(x), e.1.min(y), e.2.max(x), e.3.max(y), e.4 + 1);
        }
    }
    e
}

/// Lightness L* of an sRGB colour (CIE 1976).
fn lightness(c: Rgb) -> f64 {
    let linear = |x: u8| {
        let x = f64::from(x) / 255.0;
        if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
    };
    let y = 0.2126 * linear(c.0) + 0.7152 * linear(c.1) + 0.0722 * linear(c.2);
    if y > 0.008856 { 116.0 * y.cbrt() - 16.0 } else { 903.3 * y }
}

#[test]
fn ticks_are_round_and_inside() {
    assert_eq!(ticks::linear(0.0, 10.0, 5), (vec![0.0, 2.0, 4.0, 6.0, 8.0, 10.0], 2.0));
    assert_eq!(ticks::nice_step(0.32, 5), 0.1);
    for (lo, hi) in [(0.0, 1.0), (-3e-9, 2e-9), (0.99, 1.01), (-7e12, 3e13), (1e6, 1e6 + 1.0)] {
        for target in [2, 5, 10] {
            let (values, step) = ticks::linear(lo, hi, target);
            assert!(values.len() <= target + 1, "{lo} {hi} {target}: {values:?}");
            assert!(values.iter().all(|v| *v >= lo - 1e-5 * step && *v <= hi + 1e-5 * step));
            let labels = ticks::labels(&values, step);
            let mut distinct = labels.clone();
            distinct.dedup();
            assert_eq!(distinct, labels, "each tick has a label of its own");
        }
    }
}

#[test]
fn numbers_are_written_as_a_reader_expects() {
    let label = |values: &[f64], step| ticks::labels(values, step).join(" ");
    assert_eq!(label(&[-0.2, 0.0, 0.2], 0.2), "\u{2212}0.2 0.0 0.2");
    assert_eq!(label(&[0.0, 2e7], 2e7), "0 2×10⁷");
    assert_eq!(label(&[1.5e-5, 2e-5], 5e-6), "1.5×10⁻⁵ 2.0×10⁻⁵");
    assert_eq!((ticks::number(5.80), ticks::number(-0.0)), ("5.8".into(), "0".into()));
    assert_eq!(ticks::log_labels(&[1e-4, 1.0]).join(" "), "10⁻⁴ 10⁰");
    assert_eq!(ticks::log_labels(&[0.001, 20.0]).join(" "), "0.001 20");
    assert_eq!(ticks::logarithmic(0.5, 2e3, 10), vec![1.0, 10.0, 100.0, 1000.0]);
    assert_eq!(ticks::logarithmic(1.0, 12.0, 5), vec![1.0, 2.0, 5.0, 10.0]);
}

#[test]
fn any_range_can_be_drawn() {
    let ends = [f64::NAN, f64::NEG_INFINITY, f64::MIN, -1.0, 0.0, 5e-324, 1.0, 1.0 + 1e-15, f64::MAX, f64::INFINITY];
    for lo in ends {
        for hi in ends {
            for scale in [Scale::Linear, Scale::Log] {
                let axis = Axis::new(lo, hi, scale);
                assert!(axis.lo < axis.hi && (axis.hi - axis.lo).is_finite(), "{lo} {hi}");
                assert_eq!((axis.fraction(axis.lo), axis.fraction(axis.hi)), (0.0, 1.0), "{lo} {hi}");
                assert!(axis.ticks(6).len() <= 40);
            }
        }
    }
}

#[test]
fn lightness_of_the_maps_is_monotone() {
    let l = |map: ColourMap| (0..=255).map(|i| lightness(map.at(f64::from(i) / 255.0))).collect::<Vec<_>>();
    let rising = |v: &[f64]| v.windows(2).all(|w| w[1] > w[0] - 0.35);
    let sequential = l(ColourMap::Sequential);
    assert!(rising(&sequential));
    assert!(sequential[0] < 25.0 && sequential[255] > 85.0, "{} {}", sequential[0], sequential[255]);
    let diverging = l(ColourMap::Diverging);
    let falling: Vec<f64> = diverging[128..].iter().rev().copied().collect();
    assert!(rising(&diverging[..128]) && rising(&falling));
    let (weak, strong) = (ColourMap::Diverging.at(-1.0), ColourMap::Diverging.at(2.0));
    assert!(weak.2 > 2 * weak.0 && strong.0 > 2 * strong.2, "blue is weak, red is strong");
    assert_eq!(ColourMap::Sequential.at(f64::NAN), NO_VALUE);
}

#[test]
fn a_block_has_no_seam_and_its_true_size() {
    let colour = FieldKind::Stage.class_colour(0);
    // Gauss points leave gaps of 0.155 sides inside a cell; odd widths make pixels fall unevenly.
    for (h, width) in [(0.125, 1600), (0.125, 1237), (0.03, 911), (0.0625, 1600)] {
        let s = body(&gauss(20, 10, h), h);
        let view = View { min: [-0.7 * h, -0.3 * h], max: [41.0 * h, 21.0 * h] };
        let o = FieldOptions { width, view: Some(view), ..options(FieldKind::Stage) };
        let canvas = field_mod::draw(&[&s], &o).unwrap();
        let frame_bottom = canvas.height() - 150;
        let inside = extent(&canvas, |c| c == colour);
        let (x1, y1) = (inside.2, inside.3.min(frame_bottom));
        // The legend's swatch is below; the block is the part above it.
        let top = inside.1;
        let left = (0..canvas.width()).find(|x| canvas.get(*x, top) == colour).unwrap();
        let right = (0..canvas.width()).rev().find(|x| canvas.get(*x, top) == colour).unwrap();
        let bottom = (0..frame_bottom).rev().find(|y| canvas.get(left, *y) == colour).unwrap();
        assert!(right <= x1 && bottom <= y1);
        for y in top..=bottom {
            assert!((left..=right).all(|x| canvas.get(x, y) == colour), "a seam in row {y}");
        }
        // The outermost Gauss points stand 0.423 h from the edge and are half a side wide.
        let metres = 40.0 * h + 2.0 * h * (0.5 - (1.0 - 1.0 / 3.0_f64.sqrt()));
        let ratio = f64::from(right - left + 1) / f64::from(bottom - top + 1);
        let expected = metres / (metres - 20.0 * h);
        assert!((ratio / expected - 1.0).abs() < 2.0 / f64::from(bottom - top), "{ratio} {expected}");
    }
}

#[test]
fn a_point_is_as_large_as_its_volume() {
    let mut s = body(&[[1.0, 1.0]], 0.4);
    s.jacobian[0] = 0.25;
    assert!((side(&s, 0) - 0.2).abs() < 1e-15);
    let mut raster = Raster::new(100, 80);
    let mut canvas = Canvas::new(100, 80).unwrap();
    raster.square((50.0, 40.0), 20.0, BLUE);
    raster.draw(&mut canvas, (0, 0));
    assert_eq!(extent(&canvas, |c| c == BLUE), (40, 30, 59, 49, 400));
}

const BLUE: Rgb = Rgb(0, 0, 255);

#[test]
fn squares_outside_or_without_a_number_do_no_harm() {
    let mut raster = Raster::new(10, 10);
    for x in [f64::NAN, f64::INFINITY, -1e300, 1e300, -3.0, 13.0] {
        raster.square((x, 5.0), 2.0, BLUE);
        raster.square((5.0, x), 2.0, BLUE);
    }
    raster.square((5.0, 5.0), f64::NAN, BLUE);
    let mut canvas = Canvas::new(10, 10).unwrap();
    raster.draw(&mut canvas, (0, 0));
    assert_eq!(extent(&canvas, |c| c == BLUE).4, 0);
    // A point without size is one pixel; a gap wider than a seam stays open.
    raster.square((2.0, 5.0), 0.0, BLUE);
    raster.square((6.0, 5.0), 0.0, BLUE);
    raster.close(2);
    raster.draw(&mut canvas, (0, 0));
    assert_eq!(extent(&canvas, |c| c == BLUE).4, 2);
}

#[test]
fn odd_snapshots_are_drawn() {
    let empty = Snapshot::default();
    let one = body(&[[3.0, 4.0]], 0.5);
    let mut odd = body(&gauss(3, 3, 0.5), 0.5);
    odd.position[0] = [f64::NAN, 1.0];
    odd.position[1] = [1e300, f64::INFINITY];
    odd.plastic_strain[2] = f64::NAN;
    odd.plastic_strain[3] = f64::INFINITY;
    odd.strength[3] = -1e308;
    odd.strength[4] = 1e308;
    odd.jacobian[5] = -1.0;
    odd.initial_volume[6] = f64::MAX;
    odd.velocity.clear();
    odd.material[7] = u16::MAX;
    let far = body(&[[0.0, 0.0], [8e8, 0.0]], 1e-3);
    for kind in FieldKind::ALL {
        for frames in [vec![], vec![&empty], vec![&one], vec![&odd, &empty, &one], vec![&far]] {
            field_mod::draw(&frames, &options(kind)).unwrap();
        }
    }
    assert!(field_mod::draw(&[&one; 65], &options(FieldKind::Stage)).is_err());
    let bad = View { min: [f64::NAN; 2], max: [1.0; 2] };
    field_mod::draw(
        &[&one],
        &FieldOptions { view: Some(bad), range: Some((f64::NAN, 1.0)), width: 0, ..options(FieldKind::Strength) },
    )
    .unwrap();
}

#[test]
fn two_million_points_take_seconds() {
    let s = body(&gauss(1000, 500, 0.01), 0.01);
    let start = Instant::now();
    field_mod::draw(&[&s], &options(FieldKind::PlasticStrain)).unwrap();
    assert!(start.elapsed().as_secs_f64() < 30.0, "{:?}", start.elapsed());
}

#[test]
fn names_of_fields_are_read_back() {
    for kind in FieldKind::ALL {
        assert_eq!(FieldKind::parse(kind.name()), Some(kind));
    }
    assert_eq!(FieldKind::parse(" Plastic-Strain"), Some(FieldKind::PlasticStrain));
    assert_eq!(FieldKind::parse("pressure"), None);
    assert_eq!(FieldKind::names().count(), 10);
}

#[test]
fn the_automatic_range_leaves_out_the_tail() {
    let mut s = body(&gauss(20, 10, 0.5), 0.5);
    (0..s.len()).for_each(|i| s.plastic_strain[i] = if i == 7 { 50.0 } else { 0.3 * i as f64 / 800.0 });
    let (lo, hi) = FieldKind::PlasticStrain.automatic_range(&[&s]);
    assert!(lo == 0.0 && (hi - 0.3).abs() < 1e-12);
    s.plastic_strain.fill(0.0);
    assert_eq!(FieldKind::PlasticStrain.automatic_range(&[&s]), (0.0, 1.0));
    assert_eq!(FieldKind::Strength.automatic_range(&[&s]), (20.0, 20.0));
    assert_eq!(FieldKind::PeakStrength.automatic_range(&[&s]), (0.0, 1.0));
}

#[test]
fn lines_are_cut_at_the_frame() {
    let (lo, hi) = ((0.0, 0.0), (10.0, 10.0));
    let parts = clip::polyline(&[(-5.0, 5.0), (5.0, 5.0), (5.0, 25.0), (7.0, 25.0), (7.0, 5.0)], lo, hi);
    assert_eq!(parts, vec![vec![(0.0, 5.0), (5.0, 5.0), (5.0, 10.0)], vec![(7.0, 10.0), (7.0, 5.0)]]);
    assert_eq!(
        clip::polyline(&[(1.0, 1.0), (f64::NAN, 2.0), (2.0, 2.0), (3.0, 3.0)], lo, hi),
        vec![vec![(2.0, 2.0), (3.0, 3.0)]]
    );
    assert!(clip::polyline(&[(-1e300, 20.0), (1e300, 20.0)], lo, hi).is_empty());
    let wave: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i) / 100.0, f64::from(i).sin())).collect();
    let thin = clip::thin(wave.clone());
    let top = |v: &[(f64, f64)]| v.iter().map(|p| p.1).fold(0.0, f64::max);
    assert!(thin.len() <= 4000 && top(&thin) == top(&wave) && thin.last() == wave.last());
}

#[test]
fn odd_series_are_drawn() {
    let points = vec![(0.0, f64::NAN), (1.0, f64::INFINITY), (2.0, -1e300), (3.0, 1e300), (f64::NAN, 0.0), (-1.0, 0.0)];
    for style in [Style::Line, Style::Step, Style::Points, Style::LinePoints] {
        for axis in [AxisSpec::linear("x"), AxisSpec::log("x")] {
            let spread = points.iter().map(|p| (p.1 - 1.0, p.1 + 1.0)).collect();
            let curve = Curve { spread, ..Curve::new("c", style, points.clone()) };
            let marker = Marker { value: f64::NAN, label: "m".into(), vertical: true };
            let band = Band { from: f64::NAN, to: 1.0, label: "b".into() };
            let bar = Bar { from: -1.0, to: f64::INFINITY, height: 1e308, label: "5".into() };
            let nan = Bar { from: f64::NAN, ..bar.clone() };
            let bars = |fill| Bars { name: "b".into(), bars: vec![bar.clone(), nan.clone()], fill, colour: None };
            let area = Area { points: points.iter().map(|p| (p.0, p.1, 1.0)).collect(), style, ..Area::default() };
            let curves = vec![curve, Curve::new("none", style, vec![]), Curve::new("one", style, vec![(1.0, 1.0)])];
            let plot = SeriesPlot {
                x: axis.clone(),
                y: axis,
                curves,
                areas: vec![area],
                bars: [Fill::Solid, Fill::Clear, Fill::Hatched].map(bars).to_vec(),
                markers: vec![marker],
                equal_axes: true,
                bands: vec![band],
                ..SeriesPlot::default()
            };
            series_mod::draw(&plot).unwrap();
        }
    }
    series_mod::draw(&SeriesPlot::default()).unwrap();
    let item = Interval {
        low: f64::NAN,
        median: f64::INFINITY,
        high: 1.0,
        values: vec![f64::NAN, 1e300],
        ..Interval::default()
    };
    intervals_png(&IntervalPlot { items: vec![item; 200], ..IntervalPlot::default() }).unwrap();
    intervals_png(&IntervalPlot::default()).unwrap();
    assert!(series_png(&SeriesPlot { width: u32::MAX, ..SeriesPlot::default() }).is_err());
}

#[test]
fn labels_stand_side_by_side() {
    let labels = [(900.0, 200.0), (100.0, 300.0), (890.0, 150.0), (110.0, 100.0)];
    let middles = place::side_by_side(&labels, (0.0, 1000.0));
    assert_eq!(middles[1], 150.0, "held at the left end");
    assert_eq!(middles[0], 900.0, "at its place");
    let mut spans: Vec<(f64, f64)> = middles.iter().zip(labels).map(|(m, l)| (m - l.1 / 2.0, m + l.1 / 2.0)).collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(spans.windows(2).all(|w| w[0].1 <= w[1].0) && spans[0].0 >= 0.0 && spans[3].1 <= 1000.0, "{spans:?}");
}

#[test]
fn a_unit_is_as_long_on_both_axes() {
    let room = super::axes::Frame { left: 100, top: 20, right: 1100, bottom: 620 };
    for (x, y) in [((0.0, 20.0), (0.0, 20.0)), ((0.0, 40.0), (5.0, 10.0)), ((-3.0, 2.0), (0.0, 30.0))] {
        let (x, y) = (Axis::new(x.0, x.1, Scale::Linear), Axis::new(y.0, y.1, Scale::Linear));
        let f = series_mod::equal(room, &x, &y);
        let (across, up) = (f64::from(f.width()) / (x.hi - x.lo), f64::from(f.height()) / (y.hi - y.lo));
        // Sides are whole pixels, 100 at least.
        assert!((across / up - 1.0).abs() < 0.005, "{across} {up}");
        assert!(f.left >= room.left && f.right <= room.right && f.top >= room.top && f.bottom == room.bottom);
    }
}

#[test]
fn an_area_ends_at_the_frame() {
    let edges = |style| Area { points: vec![(-9.0, -9.0, 0.5), (9.0, -9.0, 0.5)], style, ..Area::default() };
    for style in [Style::Line, Style::Step] {
        let axis = |label| AxisSpec { range: Some((0.0, 1.0)), ..AxisSpec::linear(label) };
        let areas = vec![edges(style)];
        let plot = SeriesPlot { x: axis("x"), y: axis("y"), areas, ..SeriesPlot::default() };
        let canvas = series_mod::draw(&plot).unwrap();
        let pale = canvas.get(canvas.width() / 2 + 31, canvas.height() * 3 / 4);
        assert!(pale != WHITE && pale.2 > pale.0);
        let (x0, y0, x1, y1, count) = extent(&canvas, |c| c == pale);
        let area = (x1 - x0 + 1) * (y1 - y0 + 1);
        // All but the lines of the grid, and half of the frame's height.
        assert!(f64::from(count) > 0.97 * f64::from(area) && x0 > 60 && y1 < canvas.height() - 86, "{count} {area}");
        assert!((f64::from(y1 - y0) / f64::from(canvas.height() - 86 - 8 - 22) - 0.5).abs() < 0.01);
    }
}

#[test]
fn text_has_width_and_every_sign_we_write() {
    assert!(font::width("plastic strain", 24.0) > 100.0);
    assert!(font::width("m", 24.0) > font::width("i", 24.0));
    for sign in "θσεγμφτρ₀²³⁻⁷\u{2212}±·°×…≤≥√".chars() {
        assert!(font::outline(&sign.to_string(), 24.0).is_some(), "{sign}");
        assert_ne!(font::outline(&sign.to_string(), 24.0), font::outline("?", 24.0), "{sign}");
    }
    assert!(font::width(&text::fitted(&"long ".repeat(10_000), 24.0, 300.0), 24.0) <= 300.0);
    assert_eq!(text::fitted("short", 24.0, 300.0), "short");
    let mut canvas = Canvas::new(60, 40).unwrap();
    canvas.text("H", (30.0, 30.0), text::TextStyle::new(24.0, text::Align::Centre));
    let (x0, y0, x1, y1, _) = extent(&canvas, |c| c != WHITE);
    assert!((x0 + x1 - 60).abs() <= 2 && (29..=30).contains(&y1) && y0 < 15, "{x0} {y0} {x1} {y1}");
}
