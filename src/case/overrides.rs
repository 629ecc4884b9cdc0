//! `--set path=value`: keys laid over those of the case file.

use std::ops::Range;

use toml::de::DeValue;

use super::log::{Log, Problem};
use super::source::Span;
use super::suggest;
use super::tree::{self, Entry, Node, Table, Value};

/// Most parts of a path.
const DEEPEST: usize = 16;

/// One part of a path with its place in the override.
struct Part {
    name: String,
    at: Span,
}

/// What stopped a path, and where.
type Stop = (Span, Problem);

/// Sets one key of the tree; notes an error where the path leads nowhere.
pub(super) fn apply(log: &Log, root: &mut Table, source: usize, text: &str) {
    let done = split(source, text).and_then(|(parts, value)| set(root, &parts, value));
    if let Err((at, problem)) = done {
        log.error(at, text.split('=').next().unwrap_or("").trim(), problem);
    }
}

/// Path and value of `path=value`.
fn split(source: usize, text: &str) -> Result<(Vec<Part>, Node), Stop> {
    let whole = Span::new(source, 0..text.len());
    let usage =
        || Problem::new("this sets nothing", "must be path=value").help("for example --set material.clay.cohesion=18");
    let Some(equals) = outside_quotes(text, '=').into_iter().next() else {
        return Err((whole, usage()));
    };
    let (Some(path), Some(typed)) = (text.get(..equals), text.get(equals + 1..)) else {
        return Err((whole, usage()));
    };
    let parts = parts(source, path)?;
    Ok((parts, value(source, typed, equals + 1)?))
}

/// Bytes at which a character stands outside double quotes.
fn outside_quotes(text: &str, wanted: char) -> Vec<usize> {
    let mut quoted = false;
    let mut found = Vec::new();
    for (at, character) in text.char_indices() {
        quoted ^= character == '"';
        if !quoted && character == wanted {
            found.push(at);
        }
    }
    found
}

fn parts(source: usize, path: &str) -> Result<Vec<Part>, Stop> {
    let dots = outside_quotes(path, '.');
    let starts = std::iter::once(0).chain(dots.iter().map(|dot| dot + 1));
    let ends = dots.iter().copied().chain([path.len()]);
    let whole = Span::new(source, 0..path.len());
    if dots.len() >= DEEPEST {
        return Err((whole, Problem::new("this path has too many parts", "no key is so deep")));
    }
    starts.zip(ends).map(|(start, end)| part(source, path, start..end)).collect()
}

fn part(source: usize, path: &str, range: Range<usize>) -> Result<Part, Stop> {
    let at = Span::new(source, range.clone());
    let name = path.get(range).unwrap_or("").trim().trim_matches('"').to_owned();
    if name.is_empty() {
        let label = "a name is missing here";
        return Err((at, Problem::new("a part of this path is empty", label)));
    }
    Ok(Part { name, at })
}

/// The value as TOML; what is no TOML but a plain word is text.
fn value(source: usize, typed: &str, offset: usize) -> Result<Node, Stop> {
    let plain = typed.trim();
    let offset = offset + typed.len() - typed.trim_start().len();
    let at = Span::new(source, offset..offset + plain.len());
    match DeValue::parse(plain) {
        Ok(parsed) => Ok(tree::node(&parsed, source, offset)),
        Err(error) if plain.is_empty() || plain.starts_with(['[', '{', '"', '\'']) => {
            let message = error.message().replace('\n', " ");
            Err((at, Problem::new("this value is not valid TOML", message)))
        }
        Err(_) => Ok(Node { span: at, value: Value::Text(plain.to_owned()) }),
    }
}

fn set(table: &mut Table, parts: &[Part], value: Node) -> Result<(), Stop> {
    let Some((first, rest)) = parts.split_first() else { return Ok(()) };
    let Some(next) = rest.first() else {
        table.insert(first.name.clone(), Entry { key: first.at, node: value });
        return Ok(());
    };
    let empty = || Node { span: next.at, value: Value::Table(Table::new()) };
    let entry = table.entry(first.name.clone());
    let entry = entry.or_insert_with(|| Entry { key: first.at, node: empty() });
    descend(&mut entry.node, first, rest, value)
}

/// Goes on below a value that `above` leads to.
fn descend(node: &mut Node, above: &Part, rest: &[Part], value: Node) -> Result<(), Stop> {
    if let Value::Text(_) = node.value {
        unfold(node);
        node.span = rest.first().map_or(node.span, |part| part.at);
    }
    match &mut node.value {
        Value::Table(table) => set(table, rest, value),
        Value::Array(items) => set_item(items, above, rest, value),
        _ => {
            let message = format!("`{}` is {}, not a table", above.name, node.value.kind());
            Err((above.at, Problem::new(message, "has no keys below it")))
        }
    }
}

/// A bare word such as `base = "roller"` is short for a table with that `kind`.
fn unfold(node: &mut Node) {
    let word = Node { span: node.span, value: node.value.clone() };
    let kind = Entry { key: node.span, node: word };
    node.value = Value::Table(Table::from([("kind".to_owned(), kind)]));
}

fn set_item(items: &mut [Node], above: &Part, rest: &[Part], value: Node) -> Result<(), Stop> {
    let Some((first, below)) = rest.split_first() else { return Ok(()) };
    let names: Vec<_> = items.iter().enumerate().map(|(k, item)| item_name(&above.name, item, k)).collect();
    let index = match first.name.parse::<usize>() {
        Ok(index) => Some(index),
        Err(_) => names.iter().position(|name| *name == first.name),
    };
    let Some(item) = index.and_then(|index| items.get_mut(index)) else {
        return Err((first.at, no_item(above, first, &names)));
    };
    if below.is_empty() {
        *item = value;
        return Ok(());
    }
    descend(item, first, below, value)
}

fn no_item(above: &Part, wanted: &Part, names: &[String]) -> Problem {
    let message = format!("`{}` has no item `{}`", above.name, wanted.name);
    let label = match names.len() {
        0 => "it is empty".to_owned(),
        n => format!("it has the items 0 to {}", n - 1),
    };
    let help = suggest::did_you_mean(&wanted.name, names.iter().map(String::as_str));
    Problem::new(message, label).help_if(help)
}

/// The name of a region, a load, a drive or a probe: its key `name`, or its number.
fn item_name(list: &str, item: &Node, index: usize) -> String {
    let Value::Table(table) = &item.value else { return String::new() };
    match table.get("name").map(|entry| &entry.node.value) {
        Some(Value::Text(name)) => name.clone(),
        _ => super::section::default_name(list, index),
    }
}
