//! What breaks the method, without its remedy and with it.

use serde::Serialize;

use super::{Effort, Problem, Report, reference::Reference, table::number};

/// A number of a hard case, twice.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Remedy {
    pub case: String,
    pub remedy: String,
    /// `explicit` or `implicit`.
    pub scheme: String,
    /// What the numbers are, with their unit.
    pub figure: String,
    /// `None` where there is no such run, or it came to no end: the notes of the report say which.
    pub without: Option<f64>,
    pub with: Option<f64>,
}

/// Headings of [`Remedy::cells`].
pub(super) const HEAD: [&str; 6] = ["case", "remedy", "scheme", "figure", "without", "with"];

impl Remedy {
    /// Its line of the table, in words.
    pub(super) fn cells(&self) -> [String; 6] {
        let [case, remedy, scheme, figure] =
            [&self.case, &self.remedy, &self.scheme, &self.figure].map(|text| (*text).clone());
        [case, remedy, scheme, figure, number(self.without), number(self.with)]
    }
}

/// Remedies as an aligned table for a terminal; empty without one.
pub(super) fn aligned(remedies: &[Remedy]) -> String {
    let lines: Vec<[String; 6]> =
        std::iter::once(HEAD.map(str::to_owned)).chain(remedies.iter().map(Remedy::cells)).collect();
    let width = |k: usize| lines.iter().map(|cells| cells[k].chars().count()).max().unwrap_or(0);
    let widths: [usize; 6] = std::array::from_fn(width);
    let padded = |cells: &[String; 6]| -> String {
        let text = cells.iter().zip(widths).enumerate();
        text.map(|(k, (cell, w))| if k < 4 { format!("  {cell:w$}") } else { format!("  {cell:>w$}") }).collect()
    };
    if remedies.is_empty() { String::new() } else { lines.iter().map(|line| padded(line) + "\n").collect() }
}

/// Where hard cases are played: pieces of other problems come in, lines of the table and judged rows go out.
pub(super) struct Bench<'a> {
    pub effort: Effort,
    pub reference: &'a Reference,
    pub report: &'a mut Report,
}

impl Bench<'_> {
    /// A piece of another problem, with that problem's own answers. Of its report only the cost is kept.
    pub fn aside<T>(
        &mut self,
        problem: &dyn Problem,
        piece: impl FnOnce(&Reference, &mut Report) -> Result<T, String>,
    ) -> Result<T, String> {
        let reference = Reference::read(problem.files().reference)?;
        let mut report = Report::new(problem.name(), &reference);
        let found = piece(&reference, &mut report);
        self.report.take_cost(&report);
        found
    }

    /// A line of the table: case, remedy, scheme and figure, with the numbers. What is not finite is none.
    pub fn line(&mut self, what: [&str; 4], without: impl Into<Option<f64>>, with: impl Into<Option<f64>>) {
        let [case, remedy, scheme, figure] = what.map(str::to_owned);
        let (without, with) = (without.into().filter(|v| v.is_finite()), with.into().filter(|v| v.is_finite()));
        self.report.remedies.push(Remedy { case, remedy, scheme, figure, without, with });
    }

    /// As [`Bench::line`], where the number is an error that the remedy is to make smaller: judged by the answer
    /// `helps`. A run without the remedy that came to no end counts as one.
    pub fn helps(&mut self, what: [&str; 4], without: f64, with: f64) -> Result<(), String> {
        self.line(what, without, with);
        let share = if without.is_finite() { with / without } else { with * 0.0 };
        self.judge("helps", &what[..3].join(", "), share)
    }

    /// A row of the report against an answer of the hard cases.
    pub fn judge(&mut self, key: &str, setup: &str, ours: f64) -> Result<(), String> {
        self.report.row_of(self.reference, key, setup, None, ours)
    }

    /// Whether all sizes are asked for.
    pub fn is_full(&self) -> bool {
        self.effort == Effort::Full
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bench(reference: &Reference, report: &mut Report) {
        let mut bench = Bench { effort: Effort::Short, reference, report };
        bench.helps(["a", "b", "explicit", "error"], 0.5, 0.25).unwrap();
        bench.helps(["a", "b", "implicit", "error"], 0.5, 0.75).unwrap();
        bench.helps(["a", "b", "implicit", "error"], f64::INFINITY, 0.75).unwrap();
        bench.helps(["a", "b", "implicit", "error"], 0.5, f64::NAN).unwrap();
    }

    #[test]
    fn a_remedy_that_makes_it_worse_fails_and_no_end_is_no_number() {
        let text = "about = \"a\"\nsource = \"s\"\n[answer.helps]\nquantity = \"x\"\nexact = 1.0\nmeasure = \"at_most\"\ntolerance = 0.0\nwhy = \"w\"\n";
        let reference = Reference::read(text).unwrap();
        let mut report = Report::new("n", &reference);
        bench(&reference, &mut report);
        assert_eq!(report.rows.iter().map(|r| r.pass).collect::<Vec<_>>(), [true, false, true, false]);
        let table = aligned(&report.remedies);
        let ends = |line: &str| line.split_whitespace().rev().take(2).map(str::to_owned).collect::<Vec<_>>();
        let last: Vec<_> = table.lines().map(ends).collect();
        assert_eq!(last[1], ["0.250000", "0.500000"]);
        assert_eq!(
            (last[3].as_slice(), last[4].as_slice()),
            (&["0.750000".into(), "-".into()][..], &["-".into(), "0.500000".into()][..])
        );
        assert!(aligned(&[]).is_empty());
    }
}
