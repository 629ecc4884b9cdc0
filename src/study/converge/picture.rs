//! The pictures of a study: all variants side by side, each ladder, and shapes at the end.

use std::{io, path::Path};

use super::{Draws, Ladder, Row, Study, judge::Verdict, typical};
use crate::{
    case::Case,
    output::{
        pictures,
        plot::{self, AxisSpec, Curve, FieldKind, Interval, IntervalPlot, Marker, PALETTE, Part, SeriesPlot, Style},
    },
    run::residual_strain,
    snapshot::Snapshot,
    study::digits::{digits, figure},
};

/// Size of the plot of one ladder (pixels).
const PANEL: (u32, u32) = (1000, 700);

/// Draws `converge.png`, `ladders.png` where there is a ladder, and `shapes.png` into a folder.
///
/// # Errors
/// Those of the file system.
pub fn draw(out: &Path, case: &Case, study: &Study) -> io::Result<()> {
    plot::intervals(&out.join("converge.png"), &intervals(study))?;
    let panels: Vec<SeriesPlot> = study.ladders.iter().map(panel).collect();
    let wide = study.ladders.iter().filter(|l| Some(&l.quantity) == study.ladders.first().map(|f| &f.quantity)).count();
    let rows: Vec<Vec<Part<'_>>> =
        panels.chunks(wide.max(1)).map(|row| row.iter().map(Part::Series).collect()).collect();
    if !rows.is_empty() {
        plot::sheet(&out.join("ladders.png"), &rows)?;
    }
    shapes(&out.join("shapes.png"), case, study)
}

/// The shapes at the end, by mesh and points as in Fig. 5 of the paper; not those of other time steps.
fn shapes(path: &Path, case: &Case, study: &Study) -> io::Result<()> {
    let all = study.rows.iter().all(|r| r.is_step);
    let shown: Vec<(String, &Snapshot)> =
        study.rows.iter().filter(|r| all || !r.is_step).filter_map(|row| shape(row, study)).collect();
    let kind = if residual_strain(case).is_some() { FieldKind::PlasticStrain } else { FieldKind::Displacement };
    let mut options = pictures::options(case, kind);
    options.range = pictures::range(case, kind);
    options.captions = shown.iter().map(|(caption, _)| caption.clone()).collect();
    let views: Vec<&Snapshot> = shown.iter().map(|(_, s)| *s).collect();
    plot::field(path, &views, &options)
}

fn shape<'a>(row: &'a Row, study: &Study) -> Option<(String, &'a Snapshot)> {
    let run = typical(row)?;
    let which = match study.draws {
        Draws::Single => "",
        Draws::Jittered { .. } => ": the run nearest to the median",
        Draws::Realisations { .. } => ": realisation 0",
    };
    let r = run.sliding_distance_m.map(|r| format!(", r = {r:.2} m")).unwrap_or_default();
    Some((format!("{}{which}{r}", row.variant), run.snapshot.as_ref()?))
}

fn intervals(study: &Study) -> IntervalPlot {
    let item = |row: &Row| {
        let s = row.quantities.first().copied().flatten();
        Interval {
            label: row.variant.clone(),
            low: s.map_or(f64::NAN, |s| s.lower_quartile),
            median: s.map_or(f64::NAN, |s| s.median),
            high: s.map_or(f64::NAN, |s| s.upper_quartile),
            values: row.runs.iter().filter_map(|r| r.values.first().copied().flatten()).collect(),
        }
    };
    let quantity = study.quantities.first();
    let name = match quantity.map(|q| q.name()) {
        Some("sliding_distance") => "sliding distance r",
        other => other.unwrap_or_default(),
    };
    IntervalPlot {
        title: Some(match study.draws {
            Draws::Single => "One run a variant".to_owned(),
            Draws::Jittered { jitter, .. } => {
                format!("Median, quartiles and single runs; strength jittered by +-{} %", figure(100.0 * jitter))
            }
            Draws::Realisations { runs } => format!("Median, quartiles and single runs of {runs} realisations"),
        }),
        x_label: "variant".to_owned(),
        y: AxisSpec::linear(in_unit(name, quantity.map_or("", |q| q.unit()))),
        items: study.rows.iter().map(item).collect(),
        ..IntervalPlot::default()
    }
}

fn in_unit(name: &str, unit: &str) -> String {
    let words = name.replace('_', " ");
    if unit.is_empty() { words } else { format!("{words} ({unit})") }
}

/// One ladder: errors with the fitted slope where the rate is clean or the exact value known, else values.
fn panel(ladder: &Ladder) -> SeriesPlot {
    let size = in_unit(ladder.symbol, ladder.size_unit);
    let curves = errors(ladder);
    let logarithmic = !curves.is_empty();
    let name = in_unit(&ladder.quantity, ladder.unit);
    let (x, y) = if logarithmic {
        (AxisSpec::log(size), AxisSpec::log(format!("error of {name}")))
    } else {
        (AxisSpec::linear(size), AxisSpec::linear(name))
    };
    let exact = ladder.exact.filter(|_| !logarithmic);
    SeriesPlot {
        title: Some(title(ladder)),
        x,
        y,
        curves: if logarithmic { curves } else { values(ladder) },
        markers: exact.map(|value| Marker { value, label: "exact".to_owned(), vertical: false }).into_iter().collect(),
        width: PANEL.0,
        height: PANEL.1,
        ..SeriesPlot::default()
    }
}

fn title(ladder: &Ladder) -> String {
    let told = match ladder.verdict {
        Verdict::Clean { rate, limit, uncertainty } => {
            format!("rate {}, limit {} +- {}", digits(rate.value, 3), digits(limit, 5), digits(uncertainty, 2))
        }
        Verdict::SignChange => "differences change sign".to_owned(),
        Verdict::NoDecay { .. } => "differences do not fall".to_owned(),
        Verdict::Unresolved { .. } => "lost in the scatter".to_owned(),
        Verdict::Same => "the same at all levels".to_owned(),
        Verdict::TwoLevels => "one difference".to_owned(),
        Verdict::FewRuns { .. } => "too few runs for a rate".to_owned(),
        Verdict::OddRate { .. } | Verdict::Uncertain { .. } => "no clean rate".to_owned(),
        Verdict::NoValues => "no values".to_owned(),
    };
    format!("By {}: {told}", ladder.axis.words())
}

/// Errors against the exact value, and against the limit with the line of the rate.
fn errors(ladder: &Ladder) -> Vec<Curve> {
    let against = |reference: f64| -> Vec<(f64, f64)> {
        let error = |l: &super::Level| Some((l.size, (l.value? - reference).abs()));
        ladder.levels.iter().filter_map(error).filter(|(_, error)| *error > 0.0).collect()
    };
    let mut curves = Vec::new();
    if let Some(exact) = ladder.exact.filter(|_| ladder.rate_of_errors.is_some()) {
        let curve = Curve::new("against the exact value", Style::LinePoints, against(exact));
        curves.push(Curve { colour: Some(PALETTE[0]), ..curve });
    }
    if let Verdict::Clean { rate, limit, .. } = ladder.verdict {
        let points = against(limit);
        let last = points.last().copied();
        let line = last.map(|(h, e)| points.iter().map(|(x, _)| (*x, e * (x / h).powf(rate.value))).collect());
        let curve = Curve::new("against the limit", Style::Points, points);
        curves.push(Curve { colour: Some(PALETTE[1]), ..curve });
        let name = format!("{}^{}", ladder.symbol, digits(rate.value, 3));
        curves.push(Curve {
            colour: Some(PALETTE[1]),
            dashed: true,
            ..Curve::new(name, Style::Line, line.unwrap_or_default())
        });
    }
    curves
}

/// Values with the least and the largest run, and the runs.
fn values(ladder: &Ladder) -> Vec<Curve> {
    let levels = || ladder.levels.iter().filter_map(|l| Some((l, l.value?)));
    let runs = levels().flat_map(|(l, _)| l.values.iter().map(|v| (l.size, *v))).collect();
    let ends = |values: &[f64]| {
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
    };
    let scatters = levels().any(|(l, _)| l.values.len() > 1);
    let middle = Curve {
        spread: if scatters { levels().map(|(l, _)| ends(&l.values)).collect() } else { Vec::new() },
        colour: Some(PALETTE[0]),
        ..Curve::new("", Style::LinePoints, levels().map(|(l, v)| (l.size, v)).collect())
    };
    let mut curves = vec![middle];
    if scatters {
        let radii = vec![3.0; levels().map(|(l, _)| l.values.len()).sum()];
        curves.push(Curve { colour: Some(PALETTE[1]), radii, ..Curve::new("single runs", Style::Points, runs) });
    }
    curves
}
