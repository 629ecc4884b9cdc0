//! What comes out of a problem: rows of numbers, figures, and what it took.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{
    Figure, Remedy,
    reference::{Answer, Measure, Reference},
};
use crate::{sim::Simulation, work::Work};

/// One quantity: the exact value, ours, and whether they agree.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What, with its unit.
    pub quantity: String,
    /// The exact or published value, or the bound; `None` where a number is only reported.
    pub exact: Option<f64>,
    pub ours: f64,
    /// Error in the sense of `measure`.
    pub error: Option<f64>,
    pub measure: Measure,
    /// Largest error that passes; `None` where a number is only reported.
    pub tolerance: Option<f64>,
    pub pass: bool,
    /// Where the tolerance comes from, or why the number is only reported.
    pub why_tolerance: String,
}

/// What came out of a problem.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    pub name: String,
    pub about: String,
    pub source: String,
    pub rows: Vec<Row>,
    /// Material points moved, summed over all steps of all runs.
    pub particle_steps: u64,
    pub cost: Cost,
    pub figures: Vec<Figure>,
    /// Hard cases without and with their remedies.
    pub remedies: Vec<Remedy>,
    /// What a reader should know beside the numbers.
    pub notes: Vec<String>,
    /// Why it could not be run to its end; the rows are those it came to.
    pub fault: Option<String>,
    /// Case files to be run again, by name: written beside the report.
    #[serde(skip)]
    pub files: BTreeMap<String, String>,
}

/// What the runs of a problem took.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Cost {
    /// Steps of the explicit scheme, and of the implicit one.
    pub explicit_steps: u64,
    pub implicit_steps: u64,
    pub newton_iterations: u64,
    /// CPU time of the process (s). Not in `validate.json`, which is the same twice.
    #[serde(skip)]
    pub cpu_s: Option<f64>,
}

impl Cost {
    /// A step of the implicit scheme iterates at least once, one of the explicit scheme never.
    fn add(&mut self, work: &Work) {
        let steps = if work.newton_iterations > 0 { &mut self.implicit_steps } else { &mut self.explicit_steps };
        *steps += work.steps;
        self.newton_iterations += work.newton_iterations;
    }

    /// Names of the schemes that ran.
    pub fn schemes(&self) -> Vec<&'static str> {
        let ran = [("explicit", self.explicit_steps), ("implicit", self.implicit_steps)];
        ran.into_iter().filter(|(_, steps)| *steps > 0).map(|(name, _)| name).collect()
    }
}

impl Report {
    /// An empty report.
    pub(super) fn new(name: &str, reference: &Reference) -> Self {
        Report {
            name: name.to_owned(),
            about: reference.about.clone(),
            source: reference.source.clone(),
            rows: Vec::new(),
            particle_steps: 0,
            cost: Cost::default(),
            figures: Vec::new(),
            remedies: Vec::new(),
            notes: Vec::new(),
            fault: None,
            files: BTreeMap::new(),
        }
    }

    /// Whether it ran to its end and every row passes.
    pub fn pass(&self) -> bool {
        self.failed() == 0
    }

    /// Rows that fail, and one more if it did not run to its end.
    pub fn failed(&self) -> usize {
        self.rows.iter().filter(|row| !row.pass).count() + usize::from(self.fault.is_some())
    }

    /// Adds a row against the answer `key` of the reference.
    pub(super) fn row(&mut self, reference: &Reference, key: &str, ours: f64) -> Result<(), String> {
        let answer = reference.answer(key)?;
        self.push(answer, answer.quantity.clone(), answer.exact, ours);
        Ok(())
    }

    /// As [`Report::row`] for one of several set-ups, with an exact value worked out for it
    /// where there is one.
    pub(super) fn row_of(
        &mut self,
        reference: &Reference,
        key: &str,
        setup: &str,
        exact: Option<f64>,
        ours: f64,
    ) -> Result<(), String> {
        let answer = reference.answer(key)?;
        self.push(answer, format!("{}, {setup}", answer.quantity), exact.or(answer.exact), ours);
        Ok(())
    }

    fn push(&mut self, answer: &Answer, quantity: String, exact: Option<f64>, ours: f64) {
        let error = exact.and_then(|exact| answer.measure.error(exact, ours));
        let tolerance = answer.tolerance.filter(|_| answer.measure != Measure::Reported);
        // a NaN is no pass
        let pass = match (error, tolerance) {
            (Some(error), Some(tolerance)) => error <= tolerance,
            _ => answer.measure == Measure::Reported,
        };
        let why_tolerance = answer.why.clone();
        self.rows.push(Row { quantity, exact, ours, error, measure: answer.measure, tolerance, pass, why_tolerance });
    }

    /// Books the work of a run that is over.
    pub(super) fn count(&mut self, simulation: &Simulation) {
        self.count_work(&simulation.work);
    }

    /// As [`Report::count`], from the counters alone.
    pub(super) fn count_work(&mut self, work: &Work) {
        self.particle_steps += work.particle_steps;
        self.cost.add(work);
    }

    /// Books what the runs of another report took.
    pub(super) fn take_cost(&mut self, other: &Report) {
        self.particle_steps += other.particle_steps;
        self.cost.explicit_steps += other.cost.explicit_steps;
        self.cost.implicit_steps += other.cost.implicit_steps;
        self.cost.newton_iterations += other.cost.newton_iterations;
    }

    /// Adds a picture.
    pub(super) fn figure(&mut self, figure: Figure) {
        self.figures.push(figure);
    }

    /// Adds a note.
    pub(super) fn note(&mut self, text: impl Into<String>) {
        self.notes.push(text.into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::validate::{section, total};

    #[test]
    fn a_row_passes_within_its_tolerance_and_not_a_number_never_does() {
        let text = "about = \"a\"\nsource = \"s\"\n[answer.x]\nquantity = \"x\"\nexact = 2.0\nmeasure = \"relative\"\ntolerance = 0.01\nwhy = \"w\"\n";
        let reference = Reference::read(text).unwrap();
        let mut report = Report::new("n", &reference);
        for ours in [2.01, 2.03, f64::NAN] {
            report.row(&reference, "x", ours).unwrap();
        }
        assert_eq!(report.rows.iter().map(|r| r.pass).collect::<Vec<_>>(), [true, false, false]);
        report.fault = Some("no end".to_owned());
        assert!(section(&report).contains("STOPPED: no end") && !report.pass());
        assert!(total(&[report]).contains("3 rows, 3 failed"));
    }
}
