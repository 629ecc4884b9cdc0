//! The measures of a realisation: one list, in the order of the columns.

use crate::{
    case::Case,
    run::{Outcome, Status, residual_strain},
};

/// A number of a run.
pub struct Measure {
    /// Its column in `ensemble.csv` and its name in `summary.json`.
    pub name: String,
    /// Unit; empty for counts and shares.
    pub unit: &'static str,
    of: Reader,
}

enum Reader {
    Fixed(fn(&Outcome) -> Option<f64>),
    /// r by another threshold, by its name in the record.
    SlideAt(String),
}

impl Measure {
    /// Its value in a run; `None` where it is not defined there or no finite number.
    pub fn of(&self, outcome: &Outcome) -> Option<f64> {
        let value = match &self.of {
            Reader::Fixed(of) => of(outcome),
            Reader::SlideAt(key) => outcome.measures.sliding_distance_at.get(key).copied(),
        };
        value.filter(|v| v.is_finite())
    }
}

/// Name, unit and value of a measure that every case has.
type Fixed = (&'static str, &'static str, fn(&Outcome) -> Option<f64>);

/// The name of the first measure: r.
pub const SLIDING_DISTANCE: &str = "sliding_distance_m";
/// 1 where r has reached the wall, 0 elsewhere.
pub const CENSORED: &str = "sliding_distance_censored";

const FIXED: &[Fixed] = &[
    (SLIDING_DISTANCE, "m", |o| o.measures.sliding_distance_m),
    (CENSORED, "", |o| {
        o.measures.sliding_distance_m.map(|_| f64::from(u8::from(o.measures.sliding_distance_censored)))
    }),
    ("blocks", "", |o| o.measures.blocks.map(|b| b as f64)),
    ("first_block_m", "m", |o| o.measures.plateaus.first().map(|p| p.sliding_distance_m)),
    ("slide_volume_m3_per_m", "m3/m", |o| o.measures.slide_volume_m3_per_m),
    ("runout_m", "m", |o| Some(o.measures.runout_m)),
    ("end_time_s", "s", |o| Some(o.time)),
    ("rest_time_s", "s", |o| (o.status == Status::AtRest).then_some(o.time)),
    ("external_kj_per_m", "kJ/m", |o| Some(o.measures.energy_kj_per_m.external)),
    ("dissipated_kj_per_m", "kJ/m", |o| Some(o.measures.energy_kj_per_m.dissipated)),
    ("plastic_kj_per_m", "kJ/m", |o| Some(o.measures.energy_kj_per_m.plastic)),
    ("friction_kj_per_m", "kJ/m", |o| Some(o.measures.energy_kj_per_m.friction)),
    ("strain_kj_per_m", "kJ/m", |o| Some(o.measures.energy_kj_per_m.strain)),
    ("kinetic_kj_per_m", "kJ/m", |o| Some(o.measures.energy_kj_per_m.kinetic)),
    ("numerical_kj_per_m", "kJ/m", |o| Some(o.measures.energy_kj_per_m.numerical)),
    ("numerical_energy_share", "", |o| {
        let e = &o.measures.energy_kj_per_m;
        (e.external != 0.0).then(|| e.numerical / e.external.abs())
    }),
];

/// All measures of a case.
pub fn list(case: &Case) -> Vec<Measure> {
    let fixed = FIXED.iter().map(|&(name, unit, of)| Measure { name: name.to_owned(), unit, of: Reader::Fixed(of) });
    let slide_at =
        |key: String| Measure { name: format!("{SLIDING_DISTANCE}_at_{key}"), unit: "m", of: Reader::SlideAt(key) };
    fixed.chain(further_thresholds(case).into_iter().map(slide_at)).collect()
}

/// Names, in the record, of the other thresholds of r.
fn further_thresholds(case: &Case) -> Vec<String> {
    let Some(slide) = &case.slide else { return Vec::new() };
    let mut names: Vec<String> = slide.also.iter().map(|t| format!("{t}")).collect();
    names.extend(residual_strain(case).map(|_| "residual_strength".to_owned()));
    names.dedup();
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_thresholds_have_their_own() {
        let text = include_str!("../../../cases/clay-slope.toml");
        let (case, _) = crate::case::read("slope", text, &[]).unwrap_or_else(|e| panic!("{e}"));
        let names: Vec<String> = list(&case).into_iter().map(|m| m.name).collect();
        for name in ["sliding_distance_m", "sliding_distance_m_at_0.5", "sliding_distance_m_at_residual_strength"] {
            assert_eq!(names.iter().filter(|n| *n == name).count(), 1, "{name}");
        }
        let mut unique = names.clone();
        unique.sort();
        unique.dedup();
        assert_eq!(unique.len(), names.len());
    }
}
