//! Pictures of Monte Carlo ensembles, as line plots: histograms with fitted normals, exceedance, settling
//! moments, pairs. Draw them with [`series`](fn@super::series) or, several at once, with [`sheet`](fn@super::sheet).

use super::axes::AxisSpec;
use super::colour::{PALETTE, Rgb};
use super::series::{Area, Bar, Bars, Curve, Fill, Marker, SeriesPlot, Style};
use super::ticks::number;
use crate::math::stats::{Bin, Censoring, Exceed, Exceedance, Histogram, Prefix, gauss};

/// What was counted, such as the sliding distance r in m.
#[derive(Clone, Copy, Debug)]
pub struct Quantity<'a> {
    pub name: &'a str,
    pub unit: &'a str,
}

impl Quantity<'_> {
    fn axis(&self) -> AxisSpec {
        AxisSpec::linear(self.labelled(self.name))
    }

    fn labelled(&self, name: &str) -> String {
        format!("{name} ({})", self.unit)
    }
}

/// A normal distribution to be drawn over a histogram; mean and sd in the unit of the quantity.
#[derive(Clone, Debug)]
pub struct FittedNormal {
    /// Name in the legend.
    pub name: String,
    pub mean: f64,
    pub sd: f64,
    pub dashed: bool,
}

/// One ensemble in a picture of histograms.
#[derive(Clone, Debug)]
pub struct HistogramGroup<'a> {
    /// Name in the legend; none where empty.
    pub name: String,
    pub histogram: &'a Histogram,
    pub fits: Vec<FittedNormal>,
}

/// Density histograms over one another with their fitted normals. Bars of values at a limit are hatched.
/// Of one group the bars carry their counts; several let each other show through.
pub fn histograms(quantity: Quantity<'_>, groups: &[HistogramGroup<'_>], markers: Vec<Marker>) -> SeriesPlot {
    let alone = groups.len() == 1;
    let all = groups.iter().flat_map(|g| g.histogram.all());
    let range = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), b| (lo.min(b.from), hi.max(b.to)));
    let mut plot = density_plot(quantity, markers);
    for (k, group) in groups.iter().enumerate() {
        plot.bars.extend(bars(group, quantity, PALETTE[k % PALETTE.len()], alone));
        let colours = if alone { &PALETTE[1..] } else { &PALETTE[k % PALETTE.len()..] };
        for (fit, colour) in
            group.fits.iter().zip(colours.iter().cycle().step_by(if alone { 1 } else { PALETTE.len() }))
        {
            plot.curves.push(normal_curve(fit, range, *colour));
        }
    }
    plot
}

/// Fitted normals alone, over the range of all within three standard deviations.
pub fn densities(quantity: Quantity<'_>, fits: &[FittedNormal], markers: Vec<Marker>) -> SeriesPlot {
    let reach = |(lo, hi): (f64, f64), f: &FittedNormal| (lo.min(f.mean - 3.0 * f.sd), hi.max(f.mean + 3.0 * f.sd));
    let range = fits.iter().fold((f64::INFINITY, f64::NEG_INFINITY), reach);
    let mut plot = density_plot(quantity, markers);
    plot.curves = fits.iter().zip(PALETTE.iter().cycle()).map(|(fit, c)| normal_curve(fit, range, *c)).collect();
    plot
}

fn density_plot(quantity: Quantity<'_>, markers: Vec<Marker>) -> SeriesPlot {
    let y = AxisSpec::linear(format!("probability density (1/{})", quantity.unit));
    SeriesPlot { x: quantity.axis(), y, markers, ..SeriesPlot::default() }
}

/// The known values, and those at a limit.
fn bars(group: &HistogramGroup<'_>, quantity: Quantity<'_>, colour: Rgb, alone: bool) -> Vec<Bars> {
    let h = group.histogram;
    let label = |b: &Bin| if alone && b.count > 0 { b.count.to_string() } else { String::new() };
    let bar = |b: &Bin| Bar { from: b.from, to: b.to, height: b.density, label: label(b) };
    let below = h.below.map(|b| format!("{} at or below {} {}", b.count, number(b.to), quantity.unit));
    let above = h.above.map(|b| format!("{} at or above {} {}", b.count, number(b.from), quantity.unit));
    let limits: Vec<String> = below.into_iter().chain(above).collect();
    let whose = if alone || limits.is_empty() { String::new() } else { format!("{}: ", group.name) };
    let known = Bars {
        name: group.name.clone(),
        bars: h.bins.iter().map(bar).collect(),
        fill: if alone { Fill::Solid } else { Fill::Clear },
        colour: Some(colour),
    };
    let censored = Bars {
        name: whose + &limits.join(", "),
        bars: h.below.iter().chain(&h.above).map(bar).collect(),
        fill: Fill::Hatched,
        colour: Some(colour),
    };
    vec![known, censored]
}

fn normal_curve(fit: &FittedNormal, (lo, hi): (f64, f64), colour: Rgb) -> Curve {
    const POINTS: u32 = 400;
    let at = |k: u32| lo + (hi - lo) * f64::from(k) / f64::from(POINTS);
    let density = |x: f64| gauss::density((x - fit.mean) / fit.sd) / fit.sd;
    let points = (0..=POINTS).map(|k| (at(k), density(at(k)))).collect();
    Curve { dashed: fit.dashed, colour: Some(colour), ..Curve::new(fit.name.clone(), Style::Line, points) }
}

/// P(X > R) as a staircase, with the interval at each R and the band that holds the whole curve. Ends where
/// the curve is no longer known.
pub fn exceedance(quantity: Quantity<'_>, curve: &Exceedance, markers: Vec<Marker>) -> SeriesPlot {
    let steps = staircase(curve);
    let percent = number(100.0 * curve.confidence);
    let area = |name: &str, paler: f64, ends: fn(&Exceed) -> (f64, f64)| Area {
        name: if name.is_empty() { String::new() } else { format!("{percent} % {name}") },
        points: steps.iter().map(|e| (e.above, ends(e).0, ends(e).1)).collect(),
        style: Style::Step,
        colour: Some(PALETTE[0].paler(paler)),
    };
    let points = steps.iter().map(|e| (e.above, e.share)).collect();
    SeriesPlot {
        x: quantity.axis(),
        y: AxisSpec { range: Some((0.0, 1.0)), ..AxisSpec::linear("share of realisations beyond (-)") },
        areas: vec![
            // The band beside the interval, not below it, so that the legend has the colours of the plot.
            area("interval at each value", 0.0, |e| (e.low, e.high)),
            area("band of the whole curve", 0.5, |e| (e.high, e.band_high.max(e.high))),
            area("", 0.5, |e| (e.band_low.min(e.low), e.low)),
        ],
        curves: vec![Curve::new(format!("n = {}", curve.n), Style::Step, points)],
        markers,
        ..SeriesPlot::default()
    }
}

/// The steps of a curve, begun a little before the first and carried on to the end of what is known.
fn staircase(curve: &Exceedance) -> Vec<Exceed> {
    let (first, last) = curve.range();
    let end = curve.high.unwrap_or(last + 0.05 * (last - first));
    let start = first - 0.05 * (end - first);
    let mut steps: Vec<Exceed> = curve.at(start).into_iter().chain(curve.steps()).collect();
    if let Some(step) = steps.last().copied().filter(|step| step.above < end) {
        steps.push(Exceed { above: end, ..step });
    }
    steps
}

/// Mean and standard deviation over the number of realisations, each with 1.96 standard errors to both
/// sides: two plots. The axes are fitted to what comes after the first tenth.
pub fn settling(quantity: Quantity<'_>, prefixes: &[Prefix]) -> [SeriesPlot; 2] {
    let mean = |p: &Prefix| (p.mean, p.mean_se);
    let sd = |p: &Prefix| (p.sd, p.sd_se);
    [settling_of(quantity, prefixes, "mean", mean), settling_of(quantity, prefixes, "standard deviation", sd)]
}

fn settling_of(quantity: Quantity<'_>, prefixes: &[Prefix], name: &str, pick: fn(&Prefix) -> (f64, f64)) -> SeriesPlot {
    let points: Vec<(f64, f64, f64)> = prefixes.iter().map(|p| (p.len as f64, pick(p).0, 1.96 * pick(p).1)).collect();
    let late = points.iter().skip(prefixes.len() / 10).filter(|p| p.2.is_finite());
    let reach = |(lo, hi): (f64, f64), p: &(f64, f64, f64)| (lo.min(p.1 - p.2), hi.max(p.1 + p.2));
    let (lo, hi) = late.fold((f64::INFINITY, f64::NEG_INFINITY), reach);
    let room = 0.05 * (hi - lo);
    let known = |p: &&(f64, f64, f64)| p.2.is_finite();
    SeriesPlot {
        x: AxisSpec::linear("number of realisations n (-)"),
        y: AxisSpec {
            range: (lo <= hi).then_some((lo - room, hi + room)),
            ..AxisSpec::linear(quantity.labelled(name))
        },
        areas: vec![Area {
            name: "± 1.96 standard errors".into(),
            points: points.iter().filter(known).map(|p| (p.0, p.1 - p.2, p.1 + p.2)).collect(),
            ..Area::default()
        }],
        curves: vec![Curve::new(
            format!("{name} of {}", quantity.name),
            Style::Line,
            points.iter().map(|p| (p.0, p.1)).collect(),
        )],
        ..SeriesPlot::default()
    }
}

/// Pairs of two results of the same realisations, with the line on which both are the same; the area of a
/// dot grows with the number of pairs that lie there.
pub fn pairs(x: Quantity<'_>, y: Quantity<'_>, pairs: &[(f64, f64)]) -> SeriesPlot {
    let mut sorted: Vec<(f64, f64)> = pairs.iter().copied().filter(|p| p.0.is_finite() && p.1.is_finite()).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let groups: Vec<&[(f64, f64)]> = sorted.chunk_by(|a, b| a == b).collect();
    let most = groups.iter().map(|g| g.len()).max().unwrap_or(1);
    // At most 26 pixels, whatever the number.
    let unit = (26.0 / (most as f64).sqrt()).min(7.0);
    let range = ends(sorted.iter().flat_map(|p| [p.0, p.1]));
    let name = if most > 1 { format!("pairs (area: how many, at most {most})") } else { "pairs".to_owned() };
    let dots = Curve {
        radii: groups.iter().map(|g| unit * (g.len() as f64).sqrt()).collect(),
        ..Curve::new(name, Style::Points, groups.iter().map(|g| g[0]).collect())
    };
    let same = Curve {
        dashed: true,
        colour: Some(PALETTE[7]),
        ..Curve::new("both the same", Style::Line, vec![(range.0, range.0), (range.1, range.1)])
    };
    let axis = |q: Quantity<'_>| AxisSpec { range: Some(range), ..q.axis() };
    SeriesPlot {
        x: axis(x),
        y: axis(y),
        curves: vec![same, Curve { colour: Some(PALETTE[0]), ..dots }],
        equal_axes: true,
        width: 1200,
        height: 1200,
        ..SeriesPlot::default()
    }
}

/// Ends of an axis that holds these values with some room.
fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let widen = |(lo, hi): (f64, f64), v: f64| (lo.min(v), hi.max(v));
    let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), widen);
    if lo > hi {
        return (0.0, 1.0);
    }
    let room = if hi > lo { 0.05 * (hi - lo) } else { 0.5 };
    (lo - room, hi + room)
}

/// The limits of a sample as vertical markers, `names` for the low and the high one.
pub fn limits(censoring: &Censoring, names: [&str; 2]) -> Vec<Marker> {
    let marker =
        |(value, name): (Option<f64>, &str)| Some(Marker { value: value?, label: name.to_owned(), vertical: true });
    [censoring.low, censoring.high].into_iter().zip(names).filter_map(marker).collect()
}
