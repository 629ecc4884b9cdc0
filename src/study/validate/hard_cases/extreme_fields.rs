//! Strengths that vary as much as their mean: every realisation comes to an end that is told.

use super::{
    super::remedy::Bench,
    super::setup::{MEMORY, keys},
    played::Played,
};
use crate::{
    case,
    scene::{self, Fields},
    study::{ensemble::realise, workers},
    work::Work,
};

const SLOPE: &str = include_str!("../../../../validation/hard-cases/fields.toml");

/// Realisations.
const MANY: u64 = 100;

/// Normal strengths: what becomes of values below a tenth of the mean, or of none.
const LOW: [&str; 2] = ["floor", "resample"];

pub(super) fn play(bench: &mut Bench<'_>) -> Result<(), String> {
    for scheme in ["explicit", "implicit"] {
        let scheme_key = ("solver.scheme", scheme.to_owned());
        let lognormal = [scheme_key.clone(), ("field.strength.distribution", "lognormal".to_owned())];
        let lognormal = count(bench, &format!("lognormal, {scheme}"), &lognormal)?;
        let mut normal = |rule: &str| {
            let set = [scheme_key.clone(), ("field.strength.low_values", rule.to_owned())];
            count(bench, &format!("normal, {rule}, {scheme}"), &set)
        };
        let none = normal("none")?;
        let ruled = LOW.iter().map(|rule| normal(rule)).collect::<Result<Vec<_>, _>>()?;
        let figure = format!("realisations of {MANY} without a result");
        for (rule, ours) in LOW.iter().zip(ruled) {
            bench.line(["extreme fields, V = 1", &format!("low_values = {rule}"), scheme, &figure], none, ours);
        }
        bench.line(["extreme fields, V = 1", "lognormal", scheme, &figure], none, lognormal);
    }
    Ok(())
}

/// Realisations that were refused, or ended with a fault; rows on all of them.
fn count(bench: &mut Bench<'_>, name: &str, set: &[(&str, String)]) -> Result<f64, String> {
    let (case, _) = case::read("fields.toml", SLOPE, &keys(set)).map_err(|e| e.to_string())?;
    let fields = Fields::of(&case).map_err(|e| e.to_string())?;
    let jobs: Vec<u64> = (0..MANY).collect();
    let ends = workers::all(0, &jobs, &|_, _| {}, &|k| end_of(&realise(&case, Some(*k)), &fields))?;
    ends.iter().for_each(|end| bench.report.count_work(&end.work));
    let number = |test: fn(&End) -> bool| ends.iter().filter(|end| test(end)).count() as f64;
    let (refused, faults, completed) =
        (number(|e| e.refused), number(|e| e.fault && !e.refused), number(|e| !e.fault && !e.refused));
    bench.judge("accounted", name, number(|e| e.refused || e.clear))?;
    bench.judge("wrong", name, ends.iter().map(|e| e.wrong as f64).sum())?;
    bench
        .report
        .note(format!("{name}: {completed} completed, {faults} ended with a fault, {refused} refused before the run"));
    Ok(refused + faults)
}

/// What became of a realisation.
#[derive(Default)]
struct End {
    /// Its field was refused, in words.
    refused: bool,
    fault: bool,
    clear: bool,
    wrong: usize,
    work: Work,
}

fn end_of(case: &case::Case, fields: &Fields) -> Result<End, String> {
    let Ok(scene) = scene::build_with(case, MEMORY, fields) else {
        return Ok(End { refused: true, ..End::default() });
    };
    let end = Played::to_the_end(case, scene)?;
    let fault = end.outcome.fault.is_some();
    Ok(End { refused: false, fault, clear: end.is_clear(), wrong: end.wrong(), work: end.work })
}
