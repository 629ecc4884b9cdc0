//! Collects what is found wrong while a case is read.

use std::cell::{Cell, RefCell};
use std::sync::Arc;

use super::diagnostic::{Diagnostic, Diagnostics, Severity};
use super::source::{Source, Span};

/// Findings beyond this number are only counted.
const KEPT: usize = 1000;

/// What is wrong and what to do, before it is tied to a place.
pub(super) struct Problem {
    message: String,
    label: String,
    help: Option<String>,
}

impl Problem {
    /// A problem by its message; the label at the caret says what is allowed.
    pub fn new(message: impl Into<String>, label: impl Into<String>) -> Self {
        Self { message: message.into(), label: label.into(), help: None }
    }

    /// Adds what to change.
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    /// Adds what to change, where there is something to say.
    pub fn help_if(self, help: Option<String>) -> Self {
        Self { help: help.or(self.help), ..self }
    }
}

/// Findings of one severity, each with its place.
#[derive(Default)]
struct Findings {
    kept: RefCell<Vec<(Span, Diagnostic)>>,
    dropped: Cell<usize>,
}

impl Findings {
    fn sorted(self) -> Vec<Diagnostic> {
        let mut kept = self.kept.into_inner();
        kept.sort_by_key(|(at, _)| *at);
        kept.into_iter().map(|(_, diagnostic)| diagnostic).collect()
    }
}

/// The texts of a case and the findings about them.
pub(super) struct Log {
    sources: Vec<Arc<Source>>,
    errors: Findings,
    warnings: Findings,
}

impl Log {
    /// A log for a case file and its overrides.
    pub fn new(name: &str, text: &str, overrides: &[String]) -> Self {
        let file = std::iter::once(Source::new(name, text));
        let sets = overrides.iter().map(|text| Source::new("--set", text));
        let sources = file.chain(sets).map(Arc::new).collect();
        Self { sources, errors: Findings::default(), warnings: Findings::default() }
    }

    /// Notes an error at a place, about a key.
    pub fn error(&self, at: Span, key: &str, problem: Problem) {
        self.note(Severity::Error, at, key, problem);
    }

    /// Notes a warning at a place, about a key.
    pub fn warning(&self, at: Span, key: &str, problem: Problem) {
        self.note(Severity::Warning, at, key, problem);
    }

    fn note(&self, severity: Severity, at: Span, key: &str, problem: Problem) {
        let findings = match severity {
            Severity::Error => &self.errors,
            Severity::Warning => &self.warnings,
        };
        let mut kept = findings.kept.borrow_mut();
        match self.sources.get(at.source) {
            Some(source) if kept.len() < KEPT => {
                kept.push((at, diagnostic(severity, source, at, key, problem)));
            }
            _ => findings.dropped.set(findings.dropped.get() + 1),
        }
    }

    /// The value with the warnings, or the errors.
    pub fn finish<T>(self, value: Option<T>) -> Result<(T, Vec<Diagnostic>), Diagnostics> {
        let dropped = self.errors.dropped.get();
        let errors = self.errors.sorted();
        match value {
            Some(value) if errors.is_empty() => Ok((value, self.warnings.sorted())),
            _ => Err(Diagnostics::new(errors, dropped)),
        }
    }
}

fn diagnostic(severity: Severity, source: &Arc<Source>, at: Span, key: &str, problem: Problem) -> Diagnostic {
    let place = source.place(at.start..at.end);
    Diagnostic {
        severity,
        file: source.name.clone(),
        line: place.line,
        column: place.column,
        key: key.to_owned(),
        message: problem.message,
        label: problem.label,
        help: problem.help,
        source: Arc::clone(source),
        span: at.start..at.end,
    }
}
