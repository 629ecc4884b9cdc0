//! Texts that a case is read from, and places in them.

use std::ops::Range;

/// A place in one of the texts: the case file is source 0, the overrides follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Span {
    /// Which text.
    pub source: usize,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// A place in the text number `source`.
    pub fn new(source: usize, range: Range<usize>) -> Self {
        Self { source, start: range.start, end: range.end }
    }

    /// Whether the place lies in the case file, not in an override.
    pub fn in_file(self) -> bool {
        self.source == 0
    }
}

/// One text with a name, and where its lines start.
#[derive(Debug)]
pub(super) struct Source {
    /// Name in messages.
    pub name: String,
    text: String,
    line_starts: Vec<usize>,
}

/// A place within one line: what a message shows.
pub(super) struct Place<'a> {
    /// Line number from 1.
    pub line: usize,
    /// Column in characters from 1.
    pub column: usize,
    /// The whole line, without its end.
    pub text: &'a str,
    /// Bytes within the line, on character boundaries.
    pub range: Range<usize>,
}

impl Source {
    /// A text by its name.
    pub fn new(name: &str, text: &str) -> Self {
        let breaks = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n');
        let line_starts = std::iter::once(0).chain(breaks.map(|(at, _)| at + 1)).collect();
        Self { name: name.to_owned(), text: text.to_owned(), line_starts }
    }

    /// The first line of a range of bytes.
    pub fn place(&self, range: Range<usize>) -> Place<'_> {
        let line = self.line_starts.partition_point(|&at| at <= range.start).max(1);
        let first = self.line_starts.get(line - 1).copied().unwrap_or(0);
        let text = self.line_from(first);
        let start = boundary(text, range.start.saturating_sub(first));
        let end = boundary(text, range.end.saturating_sub(first)).max(start);
        let column = text.get(..start).map_or(0, |before| before.chars().count()) + 1;
        Place { line, column, text, range: start..end }
    }

    fn line_from(&self, first: usize) -> &str {
        let rest = self.text.get(first..).unwrap_or("");
        rest.lines().next().unwrap_or("")
    }
}

/// The nearest character boundary at or before a byte, inside the text.
fn boundary(text: &str, at: usize) -> usize {
    let at = at.min(text.len());
    (0..=at).rev().find(|&k| text.is_char_boundary(k)).unwrap_or(0)
}
