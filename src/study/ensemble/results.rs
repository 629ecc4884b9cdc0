//! What an ensemble has come to: its rows in order, cut where its rule says so.

use std::collections::BTreeMap;

use super::{
    journal::Session,
    realise::{Draw, Shard},
    row::Done,
    until::{Decision, decide},
};
use crate::{
    case::Case,
    math::stats::{Bootstrap, Moments, NormalFit},
    run::Status,
};

/// The draws that count.
#[derive(Clone, Debug)]
pub struct Results {
    pub case: Case,
    pub session: Session,
    /// By realisation.
    pub rows: BTreeMap<u64, Done>,
    /// The run with everything random at its mean.
    pub mean: Option<Done>,
    pub decision: Option<Decision>,
    /// Realisations that were asked for and are not done; 0 once the rule is satisfied.
    pub missing: u64,
}

impl Results {
    /// Those of a session, of all draws that are done.
    pub fn new(case: &Case, session: &Session, done: &BTreeMap<Draw, Done>) -> Self {
        let end = session.first.saturating_add(session.realisations);
        let wanted = |k: &u64| (session.first..end).contains(k) && session.shard.has(Some(*k));
        let mut rows: BTreeMap<u64, Done> =
            done.iter().filter_map(|(draw, done)| Some((draw.filter(|k| wanted(k))?, done.clone()))).collect();
        let asked = session.draws().flatten().count();
        let mut missing = asked.saturating_sub(rows.len()) as u64;
        // a part does not see the prefix that the rule looks at
        let rule = case.ensemble.until.as_ref().filter(|_| session.shard == Shard::WHOLE);
        let decision = rule.map(|rule| decide(rule, session.first, done));
        if let Some(decision) = decision.as_ref().filter(|d| d.reached) {
            rows.retain(|k, _| *k - session.first < decision.n as u64);
            missing = 0;
        }
        let mean = done.get(&None).filter(|_| session.shard.has(None)).cloned();
        Results { case: case.clone(), session: session.clone(), rows, mean, decision, missing }
    }

    /// Whether all that was asked for is there.
    pub fn complete(&self) -> bool {
        self.missing == 0 && (self.mean.is_some() || !self.session.shard.has(None))
    }

    /// All that was done and counts, the mean last.
    pub fn all(&self) -> impl Iterator<Item = &Done> {
        self.rows.values().chain(&self.mean)
    }

    /// How many realisations have failed, with the run at the mean.
    pub fn failed(&self) -> usize {
        self.all().filter(|d| d.row.status == Status::Failed).count()
    }

    /// Moments of a measure; `None` for fewer than two values. Opposite realisations are not independent, but
    /// their pairs are: the standard error of the mean is then that of the mean of the pairs. The errors of the
    /// other moments take all values as independent.
    pub fn moments(&self, measure: &str, bootstrap: &Bootstrap) -> Option<Moments> {
        let moments = Moments::of(&self.values(measure), bootstrap)?;
        let paired = NormalFit::of(&self.pair_means(measure)).map(|pairs| pairs.mean_se);
        Some(Moments { mean_se: paired.unwrap_or(moments.mean_se), ..moments })
    }

    /// Means of the opposite pairs of which both have a value; empty where realisations do not come in pairs.
    fn pair_means(&self, measure: &str) -> Vec<f64> {
        let mean = |(k, done): (&u64, &Done)| {
            let other = done.row.antithetic.filter(|other| other > k)?;
            let other = self.rows.get(&other)?.row.measure(measure)?;
            Some(0.5 * (done.row.measure(measure)? + other))
        };
        self.rows.iter().filter_map(mean).collect()
    }

    /// Values of a measure in the order of the realisations; those that failed have none.
    pub fn values(&self, measure: &str) -> Vec<f64> {
        self.rows.values().filter_map(|d| d.row.measure(measure)).collect()
    }
}
