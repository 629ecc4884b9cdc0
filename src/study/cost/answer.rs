//! What accuracy costs, in plain words: the cheapest setting for an error of 10 %, 1 % and 0.1 %, by scheme.
//!
//! An error may be small by chance, where two errors cancel. So a setting counts for a target only if it and every
//! run that refines one of its keys stay within the target.

use serde::Serialize;

use super::{Row, setting::word_of};
use crate::{
    case::Scheme,
    study::digits::{digits, figure},
};

/// The errors that are asked for.
pub const TARGETS: [f64; 3] = [0.1, 0.01, 0.001];

/// The cheapest setting of a scheme for a target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pick {
    pub scheme: Scheme,
    pub setting: String,
    pub error: f64,
    pub cpu_s: f64,
}

/// What a target costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    pub target: f64,
    /// By scheme, the cheaper one first; a scheme that does not reach the target is left out.
    pub picks: Vec<Pick>,
    /// CPU time of the second over that of the first.
    pub ratio: Option<f64>,
    pub text: String,
}

/// The answers for all targets. `quantity` is a name; `floor` the error up to which the reference is known.
pub fn answers(rows: &[Row], quantity: &str, floor: Option<f64>) -> Vec<Answer> {
    TARGETS.iter().map(|&target| answer(rows, quantity, floor, target)).collect()
}

fn answer(rows: &[Row], quantity: &str, floor: Option<f64>, target: f64) -> Answer {
    let mut picks: Vec<Pick> =
        [Scheme::Explicit, Scheme::Implicit].iter().filter_map(|&s| cheapest(rows, s, target)).collect();
    picks.sort_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s));
    let ratio = match picks.as_slice() {
        [first, second] if first.cpu_s > 0.0 => Some(second.cpu_s / first.cpu_s),
        _ => None,
    };
    let mut text = format!("for {} % in {quantity}: {}", figure(100.0 * target), words(rows, &picks, ratio));
    if floor.is_some_and(|floor| floor > target) {
        let known = figure(100.0 * floor.unwrap_or(f64::NAN));
        text += &format!("; the reference itself is known to {known} % only, so this is not to be relied on");
    }
    Answer { target, picks, ratio, text }
}

/// The cheapest setting of a scheme that holds a target.
fn cheapest(rows: &[Row], scheme: Scheme, target: f64) -> Option<Pick> {
    let found = rows.iter().filter(|r| r.scheme == scheme && holds(rows, r, target));
    found.filter_map(pick).min_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s))
}

fn pick(row: &Row) -> Option<Pick> {
    let (error, cpu_s) = row.error.zip(row.cpu_s)?;
    // the reference is no answer to itself
    (!row.is_reference).then(|| Pick { scheme: row.scheme, setting: row.setting.clone(), error, cpu_s })
}

/// Whether a setting, and every run with one key refined, is within a target.
fn holds(rows: &[Row], row: &Row, target: f64) -> bool {
    let within = |r: &Row| r.error.is_some_and(|e| e <= target);
    let finer = rows.iter().filter(|r| r.error.is_some() && r.refines(row));
    within(row) && finer.into_iter().all(within)
}

fn words(rows: &[Row], picks: &[Pick], ratio: Option<f64>) -> String {
    let Some(first) = picks.first() else { return nobody(rows) };
    let cheapest = format!("{}: {}", first.setting, seconds(first.cpu_s));
    match (picks.get(1), ratio) {
        (Some(other), ratio) => {
            let times = ratio.map_or(String::new(), |r| format!(" ({} times)", figure_of_two(r)));
            let scheme = word_of(other.scheme);
            format!(
                "{cheapest}; the cheapest {scheme} setting takes {}{times}: {}",
                seconds(other.cpu_s),
                other.setting
            )
        }
        (None, _) => match best(rows, |r| r.scheme != first.scheme) {
            Some(other) => {
                let scheme = word_of(other.scheme);
                format!("{cheapest}; no {scheme} setting that was run gets there for sure, the best: {}", told(&other))
            }
            None => cheapest,
        },
    }
}

fn nobody(rows: &[Row]) -> String {
    match best(rows, |_| true) {
        Some(best) => format!("no setting that was run gets there for sure; the least error: {}", told(&best)),
        None => "no run gave an error".to_owned(),
    }
}

fn told(pick: &Pick) -> String {
    format!("{} % in {} with {}", figure_of_two(100.0 * pick.error), seconds(pick.cpu_s), pick.setting)
}

/// The row of least error.
fn best(rows: &[Row], of: impl Fn(&Row) -> bool) -> Option<Pick> {
    rows.iter().filter(|r| of(r)).filter_map(pick).min_by(|a, b| a.error.total_cmp(&b.error))
}

/// Two digits: the third of a time on a machine that does other things means nothing.
pub fn figure_of_two(value: f64) -> String {
    digits(value, 2)
}

pub fn seconds(value: f64) -> String {
    format!("{} s", figure_of_two(value))
}
