//! `[ensemble]`.

use crate::case::cursor::Cursor;
use crate::case::keys::Keys;
use crate::case::limits::positive;
use crate::case::random::{Ensemble, Statistic, Until};

/// Most realisations of an ensemble.
const MOST: u64 = 1_000_000_000;

/// Reads `[ensemble]`.
pub(super) fn ensemble(root: &mut Keys<'_>) -> Option<Ensemble> {
    let mut keys = root.section("ensemble")?;
    let realisation = keys.or("realisation", 0, |c| c.whole(0, i64::MAX as u64));
    let realisations = keys.or("realisations", 100, |c| c.whole(1, MOST));
    let antithetic = keys.or("antithetic", false, |c| c.flag());
    let until = keys.optional("until", until);
    keys.finish();
    Some(Ensemble { realisation: realisation?, realisations: realisations?, antithetic: antithetic?, until: until? })
}

fn until(cursor: &Cursor<'_>) -> Option<Until> {
    let mut keys = cursor.table()?;
    let measure = keys.or("measure", "sliding_distance_m".to_owned(), |c| c.text().map(str::to_owned));
    let statistic = keys.or("statistic", Statistic::Mean, statistic);
    let standard_error = keys.required("standard_error", |c| c.number(positive("")));
    let at_least = keys.or("at_least", 30, |c| c.whole(3, MOST));
    keys.finish();
    Some(Until { measure: measure?, statistic: statistic?, standard_error: standard_error?, at_least: at_least? })
}

fn statistic(cursor: &Cursor<'_>) -> Option<Statistic> {
    match cursor.word(&["mean", "sd"])? {
        "sd" => Some(Statistic::Sd),
        _ => Some(Statistic::Mean),
    }
}
