//! The validation study: problems with known answers, run through the program as it stands.
//!
//! Each problem is one file here, one line in [`problems`], and a folder `validation/NAME/` with
//! `case.toml` (what is run) and `reference.toml` (the answers with source, tolerance and the
//! reason for the tolerance). Both files are embedded, so the installed program needs no folder.

mod block_collapse;
mod cantilever;
mod column;
mod column_collapse;
mod cook;
mod courant;
mod cut_cell;
mod factor_of_safety;
mod field;
mod figure;
mod hard_cases;
mod in_situ;
mod incline;
mod incompressible;
mod light_node;
mod limit;
mod long_run;
mod manufactured;
mod measure;
mod newton;
mod operator;
mod page;
mod patch;
mod perfect_correlation;
mod prandtl;
mod random_scenes;
mod reference;
mod remedy;
mod report;
mod rigid;
mod setup;
mod shear_layer;
mod table;
mod thick_cylinder;
mod time_order;
mod two_discs;
mod undrained_slopes;
mod vibrating_bar;

pub use figure::Figure;
pub use page::page;
pub use remedy::Remedy;
pub use report::{Cost, Report, Row};
pub use table::{header, section, total};

use crate::output::record::cpu_seconds;
use reference::Reference;

/// How much is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Seconds in all: coarse grids, few sizes. Same rows, same tolerances.
    Short,
    /// Minutes: fine grids, all sizes.
    Full,
}

/// The files of a problem.
#[derive(Clone, Copy, Debug)]
pub struct Files {
    pub case: &'static str,
    pub reference: &'static str,
}

/// A problem with known answers.
pub trait Problem: Sync {
    /// Name of its folder in `validation/`.
    fn name(&self) -> &'static str;

    /// Its case and its answers.
    fn files(&self) -> Files;

    /// Runs it and fills the rows of the report.
    ///
    /// # Errors
    /// A sentence, where a run ended with a fault or a file could not be read.
    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String>;

    /// One line on what is shown.
    fn about(&self) -> String {
        Reference::read(self.files().reference).map(|r| r.about).unwrap_or_default()
    }

    /// Where the answers come from.
    fn source(&self) -> String {
        Reference::read(self.files().reference).map(|r| r.source).unwrap_or_default()
    }

    /// Runs it as far as it goes.
    ///
    /// # Errors
    /// A reference that cannot be read.
    fn run(&self, effort: Effort) -> Result<Report, String> {
        let reference = Reference::read(self.files().reference).map_err(|e| format!("{}: {e}", self.name()))?;
        let mut report = Report::new(self.name(), &reference);
        let before = cpu_seconds();
        report.fault = self.fill(effort, &reference, &mut report).err();
        report.cost.cpu_s = cpu_seconds().zip(before).map(|(after, before)| after - before);
        Ok(report)
    }
}

/// All problems, in the order of the table.
pub fn problems() -> &'static [&'static dyn Problem] {
    &[
        &vibrating_bar::VibratingBar,
        &long_run::LongRun,
        &two_discs::TwoDiscs,
        &incline::Incline,
        &manufactured::Manufactured,
        &time_order::TimeOrder,
        &courant::Courant,
        &rigid::Rigid,
        &patch::Patch,
        &in_situ::InSitu,
        &light_node::LightNode,
        &cut_cell::CutCell,
        &newton::Newton,
        &incompressible::Incompressible,
        &cook::Cook,
        &prandtl::Prandtl,
        &thick_cylinder::ThickCylinder,
        &undrained_slopes::UndrainedSlopes,
        &factor_of_safety::FactorOfSafety,
        &perfect_correlation::PerfectCorrelation,
        &column::Column,
        &cantilever::Cantilever,
        &block_collapse::BlockCollapse,
        &column_collapse::ColumnCollapse,
        &hard_cases::HardCases,
        &shear_layer::ShearLayer,
        &random_scenes::RandomScenes,
        &field::Field,
    ]
}

/// The problems with these names, or all where no name is given.
///
/// # Errors
/// An unknown name, with the list of names.
pub fn choose(names: &[String]) -> Result<Vec<&'static dyn Problem>, String> {
    if names.is_empty() { Ok(problems().to_vec()) } else { names.iter().map(|name| find(name)).collect() }
}

fn find(name: &str) -> Result<&'static dyn Problem, String> {
    problems().iter().find(|p| p.name() == name).copied().ok_or_else(|| unknown(name))
}

fn unknown(name: &str) -> String {
    let names: Vec<_> = problems().iter().map(|p| p.name()).collect();
    let score = |known: &&str| strsim::normalized_damerau_levenshtein(name, known);
    let closest = names.iter().copied().max_by(|a, b| score(a).total_cmp(&score(b)));
    let hint = closest.filter(|known| score(known) > 0.4).map(|known| format!("; did you mean `{known}`?"));
    format!("there is no problem `{name}`{}\nthe problems are: {}", hint.unwrap_or_default(), names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_name_lists_the_problems_and_suggests_one() {
        let message = choose(&["inclin".to_owned()]).err().unwrap_or_default();
        assert!(message.contains("did you mean `incline`?") && message.contains("two-discs"), "{message}");
    }

    #[test]
    fn every_problem_reads_its_own_files_and_says_where_its_answers_come_from() {
        for p in problems() {
            let (case, _) = crate::case::read(p.name(), p.files().case, &[]).expect("a sound case");
            assert!(!case.title.is_empty());
            assert!(!p.about().is_empty() && !p.source().is_empty(), "{}", p.name());
        }
    }
}
