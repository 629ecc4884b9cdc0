//! Text to tree: the case file as TOML, with the overrides laid over it.

use toml::de::DeTable;

use super::log::{Log, Problem};
use super::overrides;
use super::source::Span;
use super::tree::{self, Table};

/// Longest case file, in bytes.
const LONGEST: usize = 1 << 20;

/// Most parts of a dotted key.
const DEEPEST: usize = 32;

/// The tree of a case file; `None` (with an error noted) where it is no TOML.
pub(super) fn parse(log: &Log, text: &str, sets: &[String]) -> Option<Table> {
    let problem = too_long(text).or_else(|| too_deep(text));
    if let Some((at, problem)) = problem {
        log.error(Span::new(0, at..at + 1), "", problem);
        return None;
    }
    let mut root = match DeTable::parse(text) {
        Ok(parsed) => tree::table(parsed.get_ref(), 0, 0),
        Err(error) => return syntax_error(log, text, &error),
    };
    for (index, set) in sets.iter().enumerate() {
        overrides::apply(log, &mut root, index + 1, set);
    }
    Some(root)
}

fn syntax_error(log: &Log, text: &str, error: &toml::de::Error) -> Option<Table> {
    let span = error.span().unwrap_or(text.len()..text.len());
    let message = error.message().replace('\n', " ");
    log.error(Span::new(0, span), "", Problem::new("this is not valid TOML", message));
    None
}

fn too_long(text: &str) -> Option<(usize, Problem)> {
    let message = format!("the case file has {} bytes", text.len());
    let problem = Problem::new(message, format!("at most {LONGEST} bytes are read"));
    (text.len() > LONGEST).then_some((0, problem))
}

/// Where a dotted key has too many parts: the parser would nest one table in another for each.
fn too_deep(text: &str) -> Option<(usize, Problem)> {
    let at = text.lines().zip(line_starts(text)).find_map(|(line, start)| deep_key(line).map(|at| start + at))?;
    Some((at, Problem::new("a dotted key has too many parts", format!("at most {DEEPEST}"))))
}

fn line_starts(text: &str) -> impl Iterator<Item = usize> + '_ {
    let breaks = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n');
    std::iter::once(0).chain(breaks.map(|(at, _)| at + 1))
}

/// Where in a line the dots of one key, outside quotes, become too many.
fn deep_key(line: &str) -> Option<usize> {
    let (mut dots, mut quote) = (0, None);
    for (at, byte) in line.bytes().enumerate() {
        match (quote, byte) {
            (Some(open), _) if open == byte => quote = None,
            (Some(_), _) => {}
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'.') => dots += 1,
            (None, b'#') => return None,
            (None, b',' | b'=' | b'[' | b'{') => dots = 0,
            _ => {}
        }
        if dots >= DEEPEST {
            return Some(at);
        }
    }
    None
}
