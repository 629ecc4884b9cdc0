//! What a study looks at: one number of a finished run.

use serde::Serialize;

use crate::{
    case::Case,
    run::{Outcome, Status},
};

/// One number of a finished run.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Quantity {
    /// What a probe of the case reads, by its name.
    Probe {
        name: String,
        unit: &'static str,
    },
    Measure {
        name: &'static str,
        unit: &'static str,
    },
}

/// A measure of every run, or of those that have it.
struct Measure {
    word: &'static str,
    unit: &'static str,
    of: fn(&Outcome) -> Option<f64>,
}

const fn measure(word: &'static str, unit: &'static str, of: fn(&Outcome) -> Option<f64>) -> Measure {
    Measure { word, unit, of }
}

const MEASURES: [Measure; 12] = [
    measure("sliding_distance", "m", |o| o.measures.sliding_distance_m),
    measure("runout", "m", |o| Some(o.measures.runout_m)),
    measure("slide_volume", "m3/m", |o| o.measures.slide_volume_m3_per_m),
    measure("max_displacement", "m", |o| Some(o.measures.max_displacement_m)),
    measure("kinetic", "kJ/m", |o| Some(o.measures.energy_kj_per_m.kinetic)),
    measure("strain_energy", "kJ/m", |o| Some(o.measures.energy_kj_per_m.strain)),
    measure("external", "kJ/m", |o| Some(o.measures.energy_kj_per_m.external)),
    measure("dissipated", "kJ/m", |o| Some(o.measures.energy_kj_per_m.dissipated)),
    measure("plastic", "kJ/m", |o| Some(o.measures.energy_kj_per_m.plastic)),
    measure("numerical_share", "", numerical_share),
    measure("onset_time", "s", |o| o.measures.onset_time_s),
    measure("rest_time", "s", |o| (o.status == Status::AtRest).then_some(o.time)),
];

/// Energy that the scheme has taken or made over what was supplied; none where nothing was.
fn numerical_share(outcome: &Outcome) -> Option<f64> {
    let e = &outcome.measures.energy_kj_per_m;
    Some(e.numerical / e.external.abs()).filter(|share| share.is_finite())
}

impl Quantity {
    /// A quantity by the name of a probe or of a measure.
    ///
    /// # Errors
    /// No such name, with those there are; a name that both a probe and a measure have.
    pub fn named(word: &str, case: &Case) -> Result<Self, String> {
        if let Some(probe) = case.probe.iter().find(|probe| probe.name == word) {
            if Self::measure(word).is_some() {
                return Err(format!(
                    "'{word}' is a probe of the case and a measure of every run; give the probe another name"
                ));
            }
            return Ok(Quantity::Probe { name: probe.name.clone(), unit: probe.quantity.unit() });
        }
        let probes = case.probe.iter().map(|probe| probe.name.as_str());
        let known: Vec<&str> = probes.chain(MEASURES.iter().map(|m| m.word)).collect();
        Self::measure(word).ok_or_else(|| format!("unknown quantity '{word}'; there are {}", known.join(", ")))
    }

    /// What a case is about: its first probe, else the sliding distance where it has a crest, else the largest
    /// displacement.
    pub fn of(case: &Case) -> Self {
        if let Some(probe) = case.probe.first() {
            return Quantity::Probe { name: probe.name.clone(), unit: probe.quantity.unit() };
        }
        let name = if case.slide.is_some() { "sliding_distance" } else { "max_displacement" };
        Quantity::Measure { name, unit: "m" }
    }

    fn measure(word: &str) -> Option<Self> {
        MEASURES.iter().find(|m| m.word == word).map(|m| Quantity::Measure { name: m.word, unit: m.unit })
    }

    /// The finite value in a run; `None` where the run has none.
    pub fn value(&self, outcome: &Outcome) -> Option<f64> {
        let value = match self {
            Quantity::Probe { name, .. } => outcome.measures.probes.iter().find(|p| p.name == *name)?.value,
            Quantity::Measure { name, .. } => MEASURES.iter().find(|m| m.word == *name).and_then(|m| (m.of)(outcome)),
        };
        value.filter(|value| value.is_finite())
    }

    /// The exact value of a probe and where it comes from, where the case gives one.
    pub fn exact(&self, case: &Case) -> Option<(f64, String)> {
        let Quantity::Probe { name, .. } = self else { return None };
        let probe = case.probe.iter().find(|probe| probe.name == *name)?;
        probe.exact.zip(probe.source.clone())
    }

    pub fn name(&self) -> &str {
        match self {
            Quantity::Probe { name, .. } => name,
            Quantity::Measure { name, .. } => name,
        }
    }

    /// Unit; empty for a pure number.
    pub fn unit(&self) -> &'static str {
        match self {
            Quantity::Probe { unit, .. } | Quantity::Measure { unit, .. } => unit,
        }
    }

    /// Whether single runs are draws of chance: r and the volume of a slide jump by columns of points and by whole
    /// blocks when strengths change by a hair.
    pub fn is_statistical(&self) -> bool {
        matches!(self.name(), "sliding_distance" | "slide_volume") && matches!(self, Quantity::Measure { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case;

    fn bar(sets: &[&str]) -> Case {
        let sets: Vec<String> = sets.iter().map(|s| (*s).to_owned()).collect();
        case::read("bar", case::template("bar").unwrap(), &sets).unwrap().0
    }

    #[test]
    fn the_first_probe_is_what_a_case_is_about() {
        let probe = "probe=[{name='mid', at=[1.0, 0.1], quantity='stress_xx', exact=2.0, source='by hand'}]";
        assert_eq!(Quantity::of(&bar(&[])).name(), "max_displacement");
        let case = bar(&[probe]);
        let quantity = Quantity::of(&case);
        assert_eq!((quantity.name(), quantity.unit()), ("mid", "kPa"));
        assert_eq!(quantity.exact(&case), Some((2.0, "by hand".to_owned())));
    }

    #[test]
    fn names_are_those_of_probes_and_measures() {
        let case = bar(&[]);
        for m in &MEASURES {
            assert_eq!(Quantity::named(m.word, &case).unwrap().unit(), m.unit);
        }
        let twice = bar(&["probe=[{name='runout', at=[1.0, 0.1], quantity='stress_xx'}]"]);
        assert!(Quantity::named("runout", &twice).unwrap_err().contains("another name"));
        assert!(Quantity::named("sliding", &case).unwrap_err().contains("sliding_distance, runout"));
        assert!(Quantity::named("sliding_distance", &case).unwrap().is_statistical());
    }
}
