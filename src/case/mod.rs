//! What was typed: the case file, its keys, its defaults, its errors. No physics.
//!
//! [`read`] turns text into a [`Case`]: `parse` makes a tree of values with their places and lays
//! the overrides over it, `section` reads each table with the small reader of `keys` and `cursor`,
//! `check` compares what the tables say. Every error is collected, with its place, in `log`.

mod check;
mod cursor;
mod diagnostic;
mod keys;
mod limits;
mod log;
mod not_modelled;
mod outline;
mod overrides;
mod parse;
mod probe;
mod random;
mod scheme;
mod section;
mod soil;
mod source;
mod study;
mod suggest;
mod template;
#[cfg(test)]
mod tests;
mod times;
mod tree;
mod types;

pub use diagnostic::{Diagnostic, Diagnostics, Severity};
pub use probe::{Probe, ProbeQuantity};
pub use random::{
    CorrelationFamily, Ensemble, Field, FieldGenerator, LowValues, Marginal, Parameter, Statistic, Until,
};
pub use scheme::*;
pub use soil::*;
pub use study::{Arm, Expectation, Study, folder_name, read_study};
pub use template::{TEMPLATES, template};
pub use types::*;

/// Reads a case file; gives the case with its warnings.
///
/// Each override is `path=value`, such as `material.clay.cohesion=18`, `grid.cell=5/29`,
/// `region.0.velocity=[1,0]` or, by its name, `region.slope.material=rock`. The value is TOML;
/// what is no TOML is taken as text. An override may set any key, also one that the file leaves
/// out, and is checked as the file is; the last one wins. Where an override chooses another
/// variant (`gravity.schedule`, `material.clay.law`, `boundary.base.kind`, `polygon` or `circle`,
/// `unit_weight` or `density`), keys of the *file* that belong to the other variants lapse.
///
/// # Errors
/// All errors of the file and the overrides, sorted by position; a file that is no TOML gives
/// its first error alone.
pub fn read(source_name: &str, text: &str, overrides: &[String]) -> Result<(Case, Vec<Diagnostic>), Diagnostics> {
    let log = log::Log::new(source_name, text, overrides);
    let root = parse::parse(&log, text, overrides);
    let case = root.and_then(|root| section::case(&log, &root));
    log.finish(case)
}

impl Case {
    /// The case as a case file, every default written out; it reads back as an equal case.
    pub fn to_toml(&self) -> String {
        // A case holds only finite numbers, text and tables with text keys: all are TOML.
        toml::to_string(self).unwrap_or_default()
    }
}
