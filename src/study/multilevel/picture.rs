//! The pictures: mean and variance by level, cost against error, P(Y > R).

use std::{io, path::Path};

use super::{Quantity, Study, text::words};
use crate::{
    math::stats::{Summary, levels::Beyond},
    output::plot::{self, Area, AxisSpec, Curve, Marker, PALETTE, Part, SeriesPlot, Style},
};

/// Width of a plot (pixels).
const WIDTH: u32 = 1200;

/// Draws both pictures: `multilevel.png` and `beyond.png`.
///
/// # Errors
/// Those of the file system.
pub fn draw(folder: &Path, study: &Study) -> io::Result<()> {
    let Some(main) = study.quantities.first() else { return Ok(()) };
    let (variances, means) = (variances(study, main), means(study, main));
    let (costs, ratios) = (cost_against_error(study, main), correlations(study));
    let rows =
        [vec![Part::Series(&variances), Part::Series(&means)], vec![Part::Series(&ratios), Part::Series(&costs)]];
    plot::sheet(&folder.join("multilevel.png"), &rows)?;
    plot::series(&folder.join("beyond.png"), &beyond(study, main))
}

/// A plot over log2 of the cell size.
fn by_level(title: String, y: String, curves: Vec<Curve>) -> SeriesPlot {
    SeriesPlot {
        title: Some(title),
        x: AxisSpec::linear("log2 of the cell size (m); finer to the left"),
        y: AxisSpec::linear(y),
        curves,
        width: WIDTH,
        ..SeriesPlot::default()
    }
}

/// log2 of a value at each level from `first` on, with 1.96 standard errors; what is not positive is left out.
fn curve(study: &Study, name: &str, first: usize, values: &[(f64, f64)]) -> Curve {
    let place = |l: usize| study.settings.get(l + first).map_or(f64::NAN, |s| s.cell_m.log2());
    let log = |v: f64| if v > 0.0 { v.log2() } else { f64::NAN };
    let points: Vec<(f64, f64)> = values.iter().enumerate().map(|(l, (v, _))| (place(l), log(*v))).collect();
    let spread = |((v, e), (_, y)): (&(f64, f64), &(f64, f64))| {
        // an interval that reaches 0 goes down as far as it goes up
        let (low, high) = (log(v - 1.96 * e), log(v + 1.96 * e));
        (if low.is_finite() { low } else { 2.0 * y - high }, high)
    };
    Curve { spread: values.iter().zip(&points).map(spread).collect(), ..Curve::new(name, Style::LinePoints, points) }
}

fn variances(study: &Study, q: &Quantity) -> SeriesPlot {
    let (name, unit) = words(&q.name);
    // a variance of n normal values is known to sqrt(2 / (n - 1)) of itself
    let of_levels = |s: &Summary| (s.sd * s.sd, s.sd * s.sd * (2.0 / (s.n as f64 - 1.0)).sqrt());
    let levels: Vec<(f64, f64)> = q.levels.iter().map(of_levels).collect();
    let terms: Vec<(f64, f64)> = q.terms.iter().skip(1).map(|t| (t.variance, t.variance_se)).collect();
    let curves = vec![curve(study, "V[Y_l]", 0, &levels), curve(study, "V[Y_l - Y_(l-1)]", 1, &terms)];
    by_level(format!("Variance of the {name}"), format!("log2 of the variance ({unit} squared)"), curves)
}

fn means(study: &Study, q: &Quantity) -> SeriesPlot {
    let (name, unit) = words(&q.name);
    let levels: Vec<(f64, f64)> = q.levels.iter().map(|s| (s.mean.abs(), s.standard_error)).collect();
    let terms: Vec<(f64, f64)> = q.terms.iter().skip(1).map(|t| (t.mean.abs(), t.mean_se)).collect();
    let curves = vec![curve(study, "|E[Y_l]|", 0, &levels), curve(study, "|E[Y_l - Y_(l-1)]|", 1, &terms)];
    by_level(format!("Mean of the {name}, 1.96 standard errors"), format!("log2 of the mean ({unit})"), curves)
}

/// Correlation of fine and coarse of each measure.
fn correlations(study: &Study) -> SeriesPlot {
    let of = |q: &Quantity| {
        let found = q.terms.iter().zip(&study.settings).filter_map(|(t, s)| Some((s.cell_m.log2(), t.correlation?)));
        let found: Vec<_> = found.collect();
        Curve {
            spread: found.iter().map(|(_, c)| (c.low, c.high)).collect(),
            ..Curve::new(words(&q.name).0, Style::LinePoints, found.iter().map(|(x, c)| (*x, c.r)).collect())
        }
    };
    let curves = study.quantities.iter().map(of).collect();
    let mut plot =
        by_level("Coupling of each level with the next coarser one".to_owned(), "correlation (-)".to_owned(), curves);
    plot.markers = vec![Marker { value: 0.5, label: "V_l = V".to_owned(), vertical: false }];
    plot
}

/// The error that a CPU time buys.
fn cost_against_error(study: &Study, q: &Quantity) -> SeriesPlot {
    const POINTS: u32 = 120;
    let longest = 10.0 * study.forecast.cpu_s.max(study.forecast.plain_cpu_s);
    let shortest = study.split.offers.iter().map(|o| 2.0 * o.run_cpu_s).fold(longest, f64::min).max(1e-6 * longest);
    let time = |k: u32| shortest * (longest / shortest).powf(f64::from(k) / f64::from(POINTS));
    let along = |error: &dyn Fn(f64) -> Option<f64>| -> Vec<(f64, f64)> {
        (0..=POINTS).map(|k| (time(k), error(time(k)).unwrap_or(f64::NAN))).collect()
    };
    let offers = &study.split.offers;
    let least = |s: f64| offers.iter().filter_map(|o| o.error_for(s)).min_by(f64::total_cmp);
    let line = |name: &str, error: &dyn Fn(f64) -> Option<f64>| Curve::new(name, Style::Line, along(error));
    // se^2 x cost is the same for any number of realisations, shared out in the best way
    let product = |ratio: f64| q.plain_cpu_s * q.mean_se.powi(2) * ratio;
    let plain = |s: f64| offers.get(q.levels.len() - 1)?.error_for(s);
    SeriesPlot {
        title: Some("Error against the finest level, for a CPU time".to_owned()),
        x: AxisSpec::log("CPU time (s)"),
        y: AxisSpec::log(format!("root of bias squared + variance of the mean ({})", words(&q.name).1)),
        curves: vec![
            line("plain Monte Carlo, finest level", &plain),
            line("best split", &least),
            line("multilevel", &|s| (s >= product(q.cost_ratio) / 1e4).then(|| (product(q.cost_ratio) / s).sqrt())),
        ],
        markers: vec![Marker { value: study.target.variance().sqrt(), label: "target".to_owned(), vertical: false }],
        width: WIDTH,
        ..SeriesPlot::default()
    }
}

fn beyond(study: &Study, q: &Quantity) -> SeriesPlot {
    let (name, unit) = words(&q.name);
    let band = |name: &str, curve: &[Beyond], k: usize| Area {
        name: name.to_owned(),
        points: curve
            .iter()
            .map(|b| (b.above, b.share - 1.96 * b.standard_error, b.share + 1.96 * b.standard_error))
            .collect(),
        style: Style::Line,
        colour: Some(PALETTE[k].paler(0.3)),
    };
    let line = |name: &str, points: Vec<(f64, f64)>, k: usize, dashed: bool| Curve {
        colour: Some(PALETTE[k]),
        dashed,
        ..Curve::new(name, Style::Line, points)
    };
    let shares = |curve: &[Beyond]| curve.iter().map(|b| (b.above, b.share)).collect();
    let falling = study.beyond.iter().zip(&study.falling).map(|(b, f)| (b.above, *f)).collect();
    SeriesPlot {
        title: Some("Bands: 1.96 standard errors at each R alone".to_owned()),
        x: AxisSpec::linear(format!("R: {name} ({unit})")),
        y: AxisSpec::linear("share of realisations beyond R (-)"),
        areas: vec![band("", &study.plain_beyond, 1), band("", &study.beyond, 0)],
        curves: vec![
            line("multilevel", shares(&study.beyond), 0, false),
            line("the same, made falling for the eye", falling, 0, true),
            line("runs of the finest level alone", shares(&study.plain_beyond), 1, false),
        ],
        ..SeriesPlot::default()
    }
}
