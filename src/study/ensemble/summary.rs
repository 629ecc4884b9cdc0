//! `summary.json`: the statistics of an ensemble. It depends on the case alone.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{
    journal::Session,
    measures::{self, CENSORED, SLIDING_DISTANCE},
    realise::Shard,
    results::Results,
    row::Row,
    slide::{self, SlideStatistics},
    until::Decision,
};
use crate::{
    math::stats::{Bootstrap, Moments},
    output::record::{Build, SCHEMA_VERSION},
    run::Status,
};

/// What the realisations say together.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    pub schema_version: u32,
    pub build: Build,
    pub title: String,
    pub case_hash: String,
    pub seed: u64,
    /// The part of the realisations that is here, where it is not the whole.
    pub shard: Option<Shard>,
    /// First realisation, how many were asked for over all shards, how many are here.
    pub first: u64,
    pub realisations: u64,
    pub done: usize,
    pub missing: u64,
    /// The rule that may end the ensemble early, and what it has come to.
    pub until: Option<Decision>,
    pub counts: Counts,
    /// The run with everything random at its mean.
    pub deterministic: Option<Row>,
    /// By the name of the measure, over the realisations that did not fail.
    pub statistics: BTreeMap<String, Moments>,
    /// More about r, where the case has a crest.
    pub sliding_distance: Option<SlideStatistics>,
}

/// How the realisations ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Counts {
    pub at_rest: usize,
    pub end_time: usize,
    pub failed: usize,
    /// r = 0.
    pub no_slide: usize,
    /// r has reached the wall.
    pub censored: usize,
}

impl Counts {
    fn of(results: &Results) -> Self {
        let ended = |status| results.rows.values().filter(|d| d.row.status == status).count();
        Counts {
            at_rest: ended(Status::AtRest),
            end_time: ended(Status::EndTime),
            failed: ended(Status::Failed),
            no_slide: results.values(SLIDING_DISTANCE).iter().filter(|r| **r == 0.0).count(),
            censored: results.values(CENSORED).iter().filter(|c| **c > 0.0).count(),
        }
    }
}

/// The summary of an ensemble, finished or not.
pub fn summary(results: &Results) -> Summary {
    let Session { case_hash, seed, build, shard, first, realisations, .. } = results.session.clone();
    let bootstrap = bootstrap(results.rows.len());
    let moments = |name: String| Some((name.clone(), results.moments(&name, &bootstrap)?));
    Summary {
        schema_version: SCHEMA_VERSION,
        build,
        title: results.case.title.clone(),
        case_hash,
        seed,
        shard: (shard != Shard::WHOLE).then_some(shard),
        first,
        realisations,
        done: results.rows.len(),
        missing: results.missing,
        until: results.decision.clone(),
        counts: Counts::of(results),
        deterministic: results.mean.as_ref().map(|d| d.row.clone()),
        statistics: measures::list(&results.case).into_iter().filter_map(|m| moments(m.name)).collect(),
        sliding_distance: slide::statistics(results),
    }
}

/// 2000 resamples, fewer of more than 10 000 values: the standard error of a standard error is then
/// still below its 7 % for 100.
fn bootstrap(n: usize) -> Bootstrap {
    Bootstrap { resamples: (20_000_000 / n.max(1)).clamp(100, 2000), ..Bootstrap::default() }
}
