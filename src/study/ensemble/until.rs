//! When an ensemble is large enough: a standard error that is small enough.
//!
//! The rule looks at the realisations in their order and not in that in which they were done, so what
//! it decides does not depend on threads.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{realise::Draw, row::Done};

/// Which statistic is to be known well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    Mean,
    Sd,
}

/// Stop at the first n, not below `at_least`, at which the standard error of the statistic of the
/// measure over the first n realisations is at most `standard_error`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rule {
    pub measure: String,
    pub statistic: Statistic,
    /// In the unit of the measure.
    pub standard_error: f64,
    pub at_least: u64,
}

/// What the rule has come to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decision {
    #[serde(flatten)]
    pub rule: Rule,
    pub reached: bool,
    /// Realisations it has looked at: the n of the stop where it is reached.
    pub n: u64,
    /// The standard error at n; `None` below two values.
    pub value: Option<f64>,
}

/// Looks at the realisations from `first` on, up to the first that is not done yet. One that has no value
/// (it failed) counts in n and not in the statistic.
pub fn decide(rule: &Rule, first: u64, done: &BTreeMap<Draw, Done>) -> Decision {
    let mut spread = Spread::default();
    let mut decision = Decision { rule: rule.clone(), reached: false, n: 0, value: None };
    for (k, (draw, done)) in (first..).zip(done.range(Some(first)..)) {
        if *draw != Some(k) {
            break;
        }
        done.row.measure(&rule.measure).into_iter().for_each(|v| spread.add(v));
        decision.n += 1;
        decision.value = spread.standard_error(rule.statistic);
        decision.reached = decision.n >= rule.at_least && decision.value.is_some_and(|se| se <= rule.standard_error);
        if decision.reached {
            break;
        }
    }
    decision
}

/// Mean and squares of a growing sample (Welford 1962).
#[derive(Default)]
struct Spread {
    n: f64,
    mean: f64,
    squares: f64,
}

impl Spread {
    fn add(&mut self, value: f64) {
        self.n += 1.0;
        let gap = value - self.mean;
        self.mean += gap / self.n;
        self.squares += gap * (value - self.mean);
    }

    /// se(mean) = sd / sqrt(n); se(sd) = sd / sqrt(2 (n - 1)), that of a normal sample.
    fn standard_error(&self, statistic: Statistic) -> Option<f64> {
        if self.n < 2.0 {
            return None;
        }
        let sd = (self.squares / (self.n - 1.0)).sqrt();
        Some(match statistic {
            Statistic::Mean => sd / self.n.sqrt(),
            Statistic::Sd => sd / (2.0 * (self.n - 1.0)).sqrt(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::ensemble::row::tests::done_with;

    fn rule(statistic: Statistic, standard_error: f64, at_least: u64) -> Rule {
        Rule { measure: "x".to_owned(), statistic, standard_error, at_least }
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
