//! Errors and warnings about a case file, each with its place, and how they are shown.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::source::Source;

/// How many errors are shown at once.
const SHOWN: usize = 20;

/// Whether a case can be run in spite of the finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The case cannot be run.
    Error,
    /// The case can be run, but probably does not say what was meant.
    Warning,
}

/// One finding about a case, with its place.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// Name of the text: the case file, or `--set` for an override.
    pub file: String,
    /// Line from 1.
    pub line: usize,
    /// Column from 1, in characters.
    pub column: usize,
    /// Path of the key, such as `material.clay.cohesion`; empty for the file as a whole.
    pub key: String,
    /// What is wrong.
    pub message: String,
    /// What stands at the caret: what is allowed there.
    pub label: String,
    /// What to change.
    pub help: Option<String>,
    pub(super) source: Arc<Source>,
    pub(super) span: Range<usize>,
}

impl Diagnostic {
    /// The finding with the line it is about and a caret, with terminal colours if asked for.
    pub fn render(&self, color: bool) -> String {
        let place = self.source.place(self.span.clone());
        let caret = AnnotationKind::Primary.span(place.range).label(self.label.as_str());
        let snippet = Snippet::source(place.text).line_start(place.line).path(self.file.as_str()).annotation(caret);
        let help = self.help.as_deref().map(|text| Level::HELP.message(text));
        let group = self.level().primary_title(self.message.as_str()).element(snippet);
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        renderer.render(&[group.elements(help)])
    }

    fn level(&self) -> Level<'static> {
        match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        }
    }
}

/// Everything that is wrong with a case, in the order of the file, overrides last.
#[derive(Clone, Debug)]
pub struct Diagnostics {
    errors: Vec<Diagnostic>,
    dropped: usize,
}

impl Diagnostics {
    pub(super) fn new(errors: Vec<Diagnostic>, dropped: usize) -> Self {
        Self { errors, dropped }
    }

    /// The errors, sorted by position; only the first thousand of a file are kept.
    pub fn errors(&self) -> &[Diagnostic] {
        &self.errors
    }

    /// The first twenty errors, each with its line and caret, and how many more there are.
    pub fn render(&self, color: bool) -> String {
        let mut parts: Vec<_> = self.errors.iter().take(SHOWN).map(|e| e.render(color)).collect();
        let more = self.errors.len().saturating_sub(SHOWN) + self.dropped;
        if more > 0 {
            parts.push(format!("... and {more} more"));
        }
        parts.join("\n\n")
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for Diagnostics {}
