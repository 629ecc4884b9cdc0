//! `reference.toml`: answers, where they come from, and how close is close enough.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// The answers of a problem.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// One line on what is shown.
    pub about: String,
    /// Where the answers come from.
    pub source: String,
    /// Answers by key.
    pub answer: BTreeMap<String, Answer>,
    /// Numbers of the set-up that are not in the case file, by name.
    #[serde(default)]
    pub given: BTreeMap<String, f64>,
}

/// One answer.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    /// What, with its unit.
    pub quantity: String,
    /// The value; left out where it is worked out for each set-up.
    pub exact: Option<f64>,
    pub measure: Measure,
    /// Largest error that passes; left out where a number is only reported.
    pub tolerance: Option<f64>,
    /// Where the tolerance comes from.
    pub why: String,
}

/// What counts as the error of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// |ours - exact| / |exact|.
    Relative,
    /// |ours - exact|.
    Absolute,
    /// How far ours lies above the bound, 0 below it.
    AtMost,
    /// How far ours lies below the bound, 0 above it.
    AtLeast,
    /// None: the number is reported, not judged.
    Reported,
}

impl Measure {
    /// The error; `None` where there is none.
    pub fn error(self, exact: f64, ours: f64) -> Option<f64> {
        let above = ours - exact;
        match self {
            Measure::Relative => Some((above / exact).abs()),
            Measure::Absolute => Some(above.abs()),
            // `max` would turn a NaN into 0
            Measure::AtMost => Some(if above < 0.0 { 0.0 } else { above }),
            Measure::AtLeast => Some(if above > 0.0 { 0.0 } else { -above }),
            Measure::Reported => None,
        }
    }
}

impl Reference {
    /// Reads the text of a `reference.toml`.
    ///
    /// # Errors
    /// What the parser says.
    pub fn read(text: &str) -> Result<Self, String> {
        toml::from_str(text).map_err(|e| format!("reference.toml: {e}"))
    }

    /// The answer with a key.
    pub(super) fn answer(&self, key: &str) -> Result<&Answer, String> {
        self.answer.get(key).ok_or_else(|| format!("reference.toml has no answer `{key}`"))
    }

    /// The exact value of an answer.
    pub(super) fn exact(&self, key: &str) -> Result<f64, String> {
        self.answer(key)?.exact.ok_or_else(|| format!("answer `{key}` has no exact value"))
    }

    /// A number of the set-up.
    pub(super) fn given(&self, key: &str) -> Result<f64, String> {
        self.given.get(key).copied().ok_or_else(|| format!("reference.toml gives no `{key}`"))
    }
}
