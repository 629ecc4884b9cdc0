//! When an ensemble is large enough: a standard error that is small enough.
//!
//! The rule looks at the realisations in their order and not in that in which they were done, so what
//! it decides does not depend on threads.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{realise::Draw, row::Done};
use crate::{
    case::{Statistic, Until},
    math::stats::{Rule, Target, running},
};

/// What the rule has come to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decision {
    #[serde(flatten)]
    pub rule: Until,
    pub reached: bool,
    /// Realisations it has looked at: the n of the stop where it is reached.
    pub n: usize,
    /// The standard error at n; `None` for too few values.
    pub value: Option<f64>,
}

/// Looks at the realisations from `first` on, up to the first that is not done yet. One that has no value
/// (it failed) has its place in the order and counts for nothing else.
pub fn decide(until: &Until, first: u64, done: &BTreeMap<Draw, Done>) -> Decision {
    let prefix = (first..).zip(done.range(Some(first)..)).take_while(|(k, (draw, _))| **draw == Some(*k));
    let values: Vec<f64> = prefix.map(|(_, (_, done))| done.row.measure(&until.measure).unwrap_or(f64::NAN)).collect();
    let target = match until.statistic {
        Statistic::Mean => Target::Mean,
        Statistic::Sd => Target::Sd,
    };
    let at_least = usize::try_from(until.at_least).unwrap_or(usize::MAX);
    let reached = Rule { target, standard_error: until.standard_error, at_least }.first(&values);
    let last = || running(&values).last().map(|p| if target == Target::Sd { p.sd_se } else { p.mean_se });
    Decision {
        rule: until.clone(),
        reached: reached.is_some(),
        n: reached.map_or(values.len(), |r| r.len),
        value: reached.map(|r| r.standard_error).or_else(last).filter(|se| se.is_finite()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::ensemble::row::tests::done_with;

    fn rule(statistic: Statistic, standard_error: f64, at_least: u64) -> Until {
        Until { measure: "x".to_owned(), statistic, standard_error, at_least }
    }

    /// Realisations 3, 4, ... with these values.
    fn rows(values: &[f64]) -> BTreeMap<Draw, Done> {
        (3..).zip(values).map(|(k, v)| (Some(k), done_with(k, "x", *v))).collect()
    }

    #[test]
    fn it_stops_at_the_first_n_that_satisfies() {
        // 0, 2, 0, 2, ...: for even n the sd is sqrt(n / (n - 1)), so se(mean) = 1 / sqrt(n - 1)
        let all = rows(&[0.0, 2.0].repeat(30));
        let found = decide(&rule(Statistic::Mean, 0.2001, 2), 3, &all);
        assert_eq!((found.reached, found.n), (true, 26));
        assert!((found.value.unwrap() - 0.2).abs() < 1e-12);
        let late = decide(&rule(Statistic::Mean, 0.2001, 40), 3, &all);
        assert_eq!((late.reached, late.n), (true, 40));
        let never = decide(&rule(Statistic::Sd, 1e-3, 2), 3, &all);
        assert_eq!((never.reached, never.n), (false, 60));
    }

    #[test]
    fn a_realisation_that_is_not_done_ends_the_prefix() {
        let mut all = rows(&[0.0, 2.0].repeat(30));
        all.remove(&Some(10));
        let found = decide(&rule(Statistic::Mean, 0.2001, 2), 3, &all);
        assert_eq!((found.reached, found.n), (false, 7));
    }
}
