//! The measures of a realisation: one list, in the order of the columns.

use crate::{
    case::Case,
    measure::onset::InitialFailure,
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

/// A value of a run.
type Reader = Box<dyn Fn(&Outcome) -> Option<f64> + Send + Sync>;

impl Measure {
    /// Its value in a run; `None` where it is not defined there or no finite number.
    pub fn of(&self, outcome: &Outcome) -> Option<f64> {
        (self.of)(outcome).filter(|v| v.is_finite())
    }
}

/// Name, unit and value of a measure that every case has.
type Fixed = (&'static str, &'static str, fn(&Outcome) -> Option<f64>);

/// The name of the first measure: r.
pub const SLIDING_DISTANCE: &str = "sliding_distance_m";
/// Volume of the slide.
pub const SLIDE_VOLUME: &str = "slide_volume_m3_per_m";
/// 1 where r has reached the wall, 0 elsewhere.
pub const CENSORED: &str = "sliding_distance_censored";

const FIXED: &[Fixed] = &[
    (SLIDING_DISTANCE, "m", |o| o.measures.sliding_distance_m),
    (CENSORED, "", |o| o.measures.sliding_distance_m.map(|_| flag(o.measures.sliding_distance_censored))),
    ("blocks", "", |o| o.measures.blocks.map(|b| b as f64)),
    ("first_block_m", "m", |o| o.measures.plateaus.first().map(|p| p.sliding_distance_m)),
    (SLIDE_VOLUME, "m3/m", |o| o.measures.slide_volume_m3_per_m),
    ("runout_m", "m", |o| Some(o.measures.runout_m)),
    ("slope_failed", "", |o| o.measures.slope_failed.map(flag)),
    ("onset_time_s", "s", |o| o.measures.onset_time_s),
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

/// Measures of the list above that need a crest.
const OF_A_SLIDE: [&str; 7] =
    [SLIDING_DISTANCE, CENSORED, "blocks", "first_block_m", SLIDE_VOLUME, "slope_failed", "onset_time_s"];

/// Whether a case without a crest has no such measure.
pub fn needs_crest(name: &str) -> bool {
    OF_A_SLIDE.contains(&name)
}

fn flag(value: bool) -> f64 {
    f64::from(u8::from(value))
}

/// All measures of a case.
pub fn list(case: &Case) -> Vec<Measure> {
    let fixed = FIXED.iter().map(|&(name, unit, of)| Measure { name: name.to_owned(), unit, of: Box::new(of) });
    fixed.chain(further_thresholds(case)).chain(first_slides(case)).collect()
}

/// r by the other thresholds, under their names in the record.
fn further_thresholds(case: &Case) -> Vec<Measure> {
    let Some(slide) = &case.slide else { return Vec::new() };
    let mut keys: Vec<String> = slide.also.iter().map(|t| format!("{t}")).collect();
    keys.extend(residual_strain(case).map(|_| "residual_strength".to_owned()));
    keys.sort();
    keys.dedup();
    let measure = |key: String| Measure {
        name: format!("{SLIDING_DISTANCE}_at_{key}"),
        unit: "m",
        of: Box::new(move |o| o.measures.sliding_distance_at.get(&key).copied()),
    };
    keys.into_iter().map(measure).collect()
}

/// The name of r of the first slide at the main level.
pub fn first_slide(case: &Case) -> Option<String> {
    case.slide.as_ref().map(|slide| format!("initial_{SLIDING_DISTANCE}_at_{}", slide.initial_level))
}

/// r and volume of the first slide at each level; 0 where the level was not reached.
fn first_slides(case: &Case) -> Vec<Measure> {
    let mut levels = case.slide.as_ref().map_or(Vec::new(), |slide| slide.initial_levels.clone());
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let at = |level: f64, name: &str, unit, of: fn(&InitialFailure) -> f64| Measure {
        name: format!("initial_{name}_at_{level}"),
        unit,
        of: Box::new(move |o| {
            let found = o.measures.initial_failure.iter().find(|f| f.level_m == level);
            o.measures.slope_failed.map(|_| found.map_or(0.0, of))
        }),
    };
    let both = |level: f64| {
        let distance = at(level, SLIDING_DISTANCE, "m", |f| f.by_clusters.sliding_distance_m);
        [distance, at(level, "volume_m3_per_m", "m3/m", |f| f.by_clusters.volume_m3_per_m)]
    };
    levels.into_iter().flat_map(both).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_thresholds_have_their_own() {
        let text = include_str!("../../../cases/clay-slope.toml");
        let (case, _) = crate::case::read("slope", text, &[]).unwrap_or_else(|e| panic!("{e}"));
        let names: Vec<String> = list(&case).into_iter().map(|m| m.name).collect();
        for name in [
            "sliding_distance_m",
            "sliding_distance_m_at_0.5",
            "sliding_distance_m_at_residual_strength",
            "initial_volume_m3_per_m_at_0.25",
        ] {
            assert_eq!(names.iter().filter(|n| *n == name).count(), 1, "{name}");
        }
        let mut unique = names.clone();
        unique.sort();
        unique.dedup();
        assert_eq!(unique.len(), names.len());
    }
}
