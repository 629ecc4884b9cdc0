//! When an ensemble is large enough: a standard error that is small enough.
//!
//! The rule looks at the realisations in their order and not in that in which they were done, so what
//! it decides does not depend on threads.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{
    realise::Draw,
    row::{Done, Row},
};
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
/// (it failed) has its place in the order and counts for nothing else. Opposite realisations are not
/// independent: the mean is looked at pair by pair.
pub fn decide(until: &Until, first: u64, done: &BTreeMap<Draw, Done>) -> Decision {
    let prefix = (first..).zip(done.range(Some(first)..)).take_while(|(k, (draw, _))| **draw == Some(*k));
    let rows: Vec<&Row> = prefix.map(|(_, (_, done))| &done.row).collect();
    let all: Vec<f64> = rows.iter().map(|row| row.measure(&until.measure).unwrap_or(f64::NAN)).collect();
    let target = match until.statistic {
        Statistic::Mean => Target::Mean,
        Statistic::Sd => Target::Sd,
    };
    let paired = target == Target::Mean && rows.iter().any(|row| row.antithetic.is_some());
    // realisations 2k and 2k + 1 are a pair: an odd first one stands alone
    let (skipped, step) = if paired { ((first % 2) as usize, 2) } else { (0, 1) };
    let values: Vec<f64> =
        all.get(skipped..).unwrap_or(&[]).chunks_exact(step).map(|v| v.iter().sum::<f64>() / step as f64).collect();
    let at_least = usize::try_from(until.at_least).unwrap_or(usize::MAX).div_ceil(step);
    let reached = Rule { target, standard_error: until.standard_error, at_least }.first(&values);
    let last = || running(&values).last().map(|p| if target == Target::Sd { p.sd_se } else { p.mean_se });
    Decision {
        rule: until.clone(),
        reached: reached.is_some(),
        n: reached.map_or(all.len(), |r| skipped + step * r.len),
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
    fn the_mean_of_opposite_realisations_is_known_by_their_pairs() {
        // 3 | 4, 5 | 6, 7 | ...: the pairs from 4 on have means 1.1, 0.9, 1.1, 0.9, ... though values spread by 1
        let mut all = rows(&[&[7.0][..], &[0.1, 2.1, -0.1, 1.9].repeat(10)].concat());
        for (draw, done) in &mut all {
            done.row.antithetic = draw.map(|k| k ^ 1);
        }
        // se of n pairs, n even: 0.1 / sqrt(n - 1); 0.0334 from 10 on
        let found = decide(&rule(Statistic::Mean, 0.0334, 3), 3, &all);
        assert_eq!((found.reached, found.n), (true, 21));
        assert!((found.value.unwrap() - 0.1 / 3.0).abs() < 1e-12);
        // the single values would need some 1000
        all.values_mut().for_each(|done| done.row.antithetic = None);
        assert!(!decide(&rule(Statistic::Mean, 0.0334, 3), 3, &all).reached);
    }

    #[test]
    fn a_realisation_that_is_not_done_ends_the_prefix() {
        let mut all = rows(&[0.0, 2.0].repeat(30));
        all.remove(&Some(10));
        let found = decide(&rule(Statistic::Mean, 0.2001, 2), 3, &all);
        assert_eq!((found.reached, found.n), (false, 7));
    }
}
