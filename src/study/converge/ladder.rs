//! The ladders of a study: their levels, and what is told of each.

use serde::Serialize;

use super::{
    Axis, Draws, Row, Scheme,
    judge::{Difference, Samples, Verdict, judge},
    text,
};
use crate::{case::Case, math::stats::log_slope, study::quantity::Quantity};

/// One level.
#[derive(Clone, Debug, Serialize)]
pub struct Level {
    pub variant: String,
    /// What is refined, in the unit of the ladder.
    pub size: f64,
    /// Runs with a value.
    pub runs: usize,
    /// The median of jittered runs, the mean over realisations, or the value of one run.
    pub value: Option<f64>,
    /// The value of the next finer level with one, less this.
    pub difference: Option<Difference>,
    /// The value less the exact one, where the case gives that.
    pub error: Option<f64>,
    /// The values of the runs.
    #[serde(skip)]
    pub values: Vec<f64>,
}

/// One quantity as one thing is refined, from the coarsest level.
#[derive(Clone, Debug, Serialize)]
pub struct Ladder {
    pub axis: Axis,
    pub quantity: String,
    /// Of the quantity; empty for a pure number.
    pub unit: &'static str,
    /// Of what is refined.
    pub symbol: &'static str,
    pub size_unit: &'static str,
    pub levels: Vec<Level>,
    pub exact: Option<f64>,
    /// Slope of ln |error| over ln(size) by least squares, for three levels or more with an error.
    pub rate_of_errors: Option<f64>,
    #[serde(flatten)]
    pub verdict: Verdict,
    /// The verdict in words.
    pub text: String,
}

/// All ladders of all quantities.
pub(super) fn all(draws: Draws, case: &Case, quantities: &[Quantity], scheme: &Scheme, rows: &[Row]) -> Vec<Ladder> {
    let of = |(q, quantity): (usize, &Quantity)| -> Vec<Ladder> {
        let one = |(axis, places): &(Axis, Vec<usize>)| {
            let levels = places.iter().filter_map(|k| Some((scheme.variants.get(*k)?, rows.get(*k)?)));
            let levels = levels.map(|((_, case), row)| (axis.size(case), row)).collect::<Vec<_>>();
            ladder(draws, case, *axis, quantity, q, &levels)
        };
        scheme.ladders.iter().map(one).collect()
    };
    quantities.iter().enumerate().flat_map(of).collect()
}

fn ladder(draws: Draws, case: &Case, axis: Axis, quantity: &Quantity, q: usize, rows: &[(f64, &Row)]) -> Ladder {
    let values = values(draws, q, rows);
    let found: Vec<usize> = (0..rows.len()).filter(|k| !values[*k].is_empty()).collect();
    let samples = Samples {
        sizes: found.iter().map(|k| rows[*k].0).collect(),
        values: found.iter().map(|k| values[*k].clone()).collect(),
        paired: draws.is_paired(),
    };
    let judgement = judge(&samples);
    let exact = quantity.exact(case).map(|(value, _)| value);
    let level = |(k, ((size, row), values)): (usize, (&(f64, &Row), Vec<f64>))| {
        let place = found.iter().position(|f| *f == k);
        let value = place.and_then(|p| judgement.values.get(p)).copied();
        Level {
            variant: row.variant.clone(),
            size: *size,
            runs: values.len(),
            value,
            difference: place.and_then(|p| judgement.differences.get(p)).copied(),
            error: value.zip(exact).map(|(value, exact)| value - exact),
            values,
        }
    };
    let levels: Vec<Level> = rows.iter().zip(values).enumerate().map(level).collect();
    let (symbol, size_unit) = axis.symbol(case);
    let mut ladder = Ladder {
        axis,
        quantity: quantity.name().to_owned(),
        unit: quantity.unit(),
        symbol,
        size_unit,
        rate_of_errors: rate_of_errors(&levels),
        levels,
        exact,
        verdict: judgement.verdict,
        text: String::new(),
    };
    ladder.text = text::verdict(&ladder, &judgement, case);
    ladder
}

/// The values of each level; of realisations those that all levels have which have any.
fn values(draws: Draws, q: usize, rows: &[(f64, &Row)]) -> Vec<Vec<f64>> {
    let value = |row: &Row, k: usize| -> Option<f64> {
        let run = row.runs.get(k).filter(|run| run.status.is_sound())?;
        run.values.get(q).copied().flatten()
    };
    let any = |row: &Row| (0..draws.runs()).any(|k| value(row, k).is_some());
    let complete = |k: usize| rows.iter().all(|(_, row)| !any(row) || value(row, k).is_some());
    let kept: Vec<usize> = (0..draws.runs()).filter(|k| !draws.is_paired() || complete(*k)).collect();
    rows.iter().map(|(_, row)| kept.iter().filter_map(|k| value(row, *k)).collect()).collect()
}

fn rate_of_errors(levels: &[Level]) -> Option<f64> {
    let errors = levels.iter().filter_map(|l| Some((l.size, l.error?.abs())));
    let (sizes, errors): (Vec<f64>, Vec<f64>) = errors.filter(|(_, error)| *error > 0.0).unzip();
    (sizes.len() > 2).then(|| log_slope(&sizes, &errors)).filter(|rate| rate.is_finite())
}
