//! What accuracy costs, in plain words: the cheapest setting for an error of 10 %, 1 % and 0.1 %, by scheme.
//!
//! An error may be small by chance, where two errors cancel. So a setting counts for a target only if it and every
//! run that refines one of its keys stay within the target; a finer run that failed does not. The reference tells
//! nothing about what it is the reference of: a setting that no other run refines is named as unchecked, and only
//! where its scheme has none that is checked.

use std::cmp::Ordering;

use serde::Serialize;

use super::{Row, setting::word_of};
use crate::{
    case::Scheme,
    study::digits::{digits, figure},
};

/// The errors that are asked for.
pub const TARGETS: [f64; 3] = [0.1, 0.01, 0.001];

/// Targets up to here are doubtful where it is not known how well the reference is.
const DOUBTFUL: f64 = 0.01;

/// The cheapest setting of a scheme for a target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pick {
    pub scheme: Scheme,
    pub setting: String,
    pub error: f64,
    pub cpu_s: f64,
    /// Whether a run that refines it, the reference apart, is within the target too.
    pub checked: bool,
}

/// What a target costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    pub target: f64,
    /// By scheme, what is checked first, then the cheaper one; a scheme that does not reach the target is left out.
    pub picks: Vec<Pick>,
    /// CPU time of the second over that of the first, where both are checked.
    pub ratio: Option<f64>,
    pub text: String,
}

/// The answers for all targets. `quantity` is a name; `floor` the error up to which the reference is known, `None`
/// where that is not known.
pub fn answers(rows: &[Row], quantity: &str, floor: Option<f64>) -> Vec<Answer> {
    TARGETS.iter().map(|&target| answer(rows, quantity, floor, target)).collect()
}

fn answer(rows: &[Row], quantity: &str, floor: Option<f64>, target: f64) -> Answer {
    let mut picks: Vec<Pick> =
        [Scheme::Explicit, Scheme::Implicit].iter().filter_map(|&s| cheapest(rows, s, target)).collect();
    picks.sort_by(Pick::order);
    let ratio = match picks.as_slice() {
        [first, second] if first.cpu_s > 0.0 && second.checked => Some(second.cpu_s / first.cpu_s),
        _ => None,
    };
    let told = words(rows, &picks, ratio);
    let text = format!("for {} % in {quantity}: {told}{}", figure(100.0 * target), caveat(floor, target));
    Answer { target, picks, ratio, text }
}

/// What a reference that is not known well enough does to a target.
fn caveat(floor: Option<f64>, target: f64) -> String {
    let why = match floor {
        Some(floor) if floor > target => format!("the reference itself is known to {} % only", figure(100.0 * floor)),
        None if target <= DOUBTFUL => "how well the reference itself is known is not known".to_owned(),
        _ => return String::new(),
    };
    format!("; {why}, so this is not to be relied on")
}

/// The cheapest setting of a scheme that holds a target, checked if there is one.
fn cheapest(rows: &[Row], scheme: Scheme, target: f64) -> Option<Pick> {
    let of_scheme = rows.iter().filter(|r| r.scheme == scheme);
    let held = of_scheme.filter_map(|r| Some(Pick { checked: holds(rows, r, target)?, ..pick(r)? }));
    held.min_by(Pick::order)
}

impl Pick {
    /// What is checked first, then what is cheaper.
    fn order(&self, other: &Pick) -> Ordering {
        other.checked.cmp(&self.checked).then(self.cpu_s.total_cmp(&other.cpu_s))
    }

    fn mark(&self) -> &'static str {
        if self.checked { "" } else { " (unchecked: no run refines it, or the reference alone does)" }
    }
}

fn pick(row: &Row) -> Option<Pick> {
    let (error, cpu_s) = sound_error(row).zip(row.cpu_s)?;
    let setting = row.setting.clone();
    // the reference is no answer to itself
    (!row.is_reference).then_some(Pick { scheme: row.scheme, setting, error, cpu_s, checked: false })
}

/// The error of a setting whose runs all came to their end.
fn sound_error(row: &Row) -> Option<f64> {
    row.error.filter(|_| row.fault.is_none())
}

/// Whether a setting that is within a target has been checked by runs with one key refined; `None` where it, or one
/// of these, is not within.
fn holds(rows: &[Row], row: &Row, target: f64) -> Option<bool> {
    let within = |r: &Row| sound_error(r).is_some_and(|e| e <= target);
    let mut finer = rows.iter().filter(|r| !r.is_reference && r.refines(row)).peekable();
    let checked = finer.peek().is_some();
    (within(row) && finer.all(within)).then_some(checked)
}

fn words(rows: &[Row], picks: &[Pick], ratio: Option<f64>) -> String {
    let Some(first) = picks.first() else { return nobody(rows) };
    let cheapest = format!("{}: {}{}", first.setting, seconds(first.cpu_s), first.mark());
    match (picks.get(1), ratio) {
        (Some(other), ratio) => {
            let times = ratio.map_or(String::new(), |r| format!(" ({} times)", figure_of_two(r)));
            let scheme = word_of(other.scheme);
            format!(
                "{cheapest}; the cheapest {scheme} setting takes {}{times}: {}{}",
                seconds(other.cpu_s),
                other.setting,
                other.mark()
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
