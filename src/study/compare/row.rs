//! One variant with its runs: the median and the spread of each figure.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{figures::FIGURES, single::Run, variants::Entry};
use crate::{math::stats::Summary, run::Status};

/// A variant with its runs.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    #[serde(flatten)]
    pub entry: Entry,
    /// Median and spread by the name of the figure; absent where no run has it.
    pub figures: BTreeMap<&'static str, Summary>,
    pub failed: usize,
    pub censored: usize,
    pub not_at_rest: usize,
    pub runs: Vec<Run>,
}

impl Row {
    /// The runs of an entry, those that failed set apart.
    pub fn new(entry: Entry, runs: Vec<Run>) -> Self {
        let sound: Vec<&Run> = runs.iter().filter(|r| r.fault.is_none()).collect();
        let summary = |of: fn(&Run) -> Option<f64>| {
            let values: Vec<f64> = sound.iter().filter_map(|r| of(r)).collect();
            Summary::of(&values)
        };
        Row {
            figures: FIGURES.iter().filter_map(|f| Some((f.name, summary(f.of)?))).collect(),
            failed: runs.len() - sound.len(),
            censored: runs.iter().filter(|r| r.censored).count(),
            not_at_rest: runs.iter().filter(|r| matches!(r.status, Status::EndTime | Status::Interrupted)).count(),
            entry,
            runs,
        }
    }

    /// Median of a figure.
    pub fn median(&self, name: &str) -> Option<f64> {
        self.figures.get(name).map(|s| s.median)
    }

    /// The run whose r is nearest to the median.
    pub fn typical(&self) -> Option<&Run> {
        let median = self.median("sliding_distance_m").unwrap_or(0.0);
        let gap = |r: &Run| (r.sliding_distance_m.unwrap_or(0.0) - median).abs();
        self.runs.iter().filter(|r| r.fault.is_none()).min_by(|a, b| gap(a).total_cmp(&gap(b)))
    }
}
