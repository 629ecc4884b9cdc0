//! The tree of a case file: TOML values, each with its place.

use std::collections::BTreeMap;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::source::Span;

/// Keys of a table, by name.
pub(super) type Table = BTreeMap<String, Entry>;

/// A key with its value.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// Where the key stands.
    pub key: Span,
    /// What it is set to.
    pub node: Node,
}

/// A value with its place.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// Where the value stands; for a table, its header.
    pub span: Span,
    /// The value.
    pub value: Value,
}

/// A TOML value.
#[derive(Clone, Debug)]
pub(super) enum Value {
    /// Text in quotes.
    Text(String),
    /// A whole number.
    Integer(i64),
    /// A number with a point or an exponent, or a whole one too large for 64 bits.
    Number(f64),
    /// true or false.
    Flag(bool),
    /// A date or a time, which no key takes.
    Date,
    /// Values in brackets, or tables in double brackets.
    Array(Vec<Node>),
    /// Keys and values.
    Table(Table),
}

impl Value {
    /// What the value is, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Text(_) => "text",
            Value::Integer(_) => "a whole number",
            Value::Number(_) => "a number",
            Value::Flag(_) => "true or false",
            Value::Date => "a date",
            Value::Array(_) => "a list",
            Value::Table(_) => "a table",
        }
    }
}

/// The tree of a parsed table, with `offset` added to its places.
pub(super) fn table(parsed: &DeTable<'_>, source: usize, offset: usize) -> Table {
    let entry = |(key, value): (&Spanned<_>, &Spanned<_>)| {
        let at = Span::new(source, key.span().start + offset..key.span().end + offset);
        let name: &std::borrow::Cow<'_, str> = key.get_ref();
        (name.to_string(), Entry { key: at, node: node(value, source, offset) })
    };
    parsed.iter().map(entry).collect()
}

/// The tree of a parsed value, with `offset` added to its places.
pub(super) fn node(parsed: &Spanned<DeValue<'_>>, source: usize, offset: usize) -> Node {
    let span = parsed.span();
    let span = Span::new(source, span.start + offset..span.end + offset);
    let value = match parsed.get_ref() {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(digits) => integer(digits.as_str(), digits.radix()),
        DeValue::Float(digits) => Value::Number(digits.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(list) => Value::Array(list.iter().map(|item| node(item, source, offset)).collect()),
        DeValue::Table(keys) => Value::Table(table(keys, source, offset)),
    };
    Node { span, value }
}

fn integer(digits: &str, radix: u32) -> Value {
    match i64::from_str_radix(digits, radix) {
        Ok(value) => Value::Integer(value),
        Err(_) => Value::Number(digits.parse().unwrap_or(f64::INFINITY)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_beyond_64_bits_become_numbers() {
        assert!(matches!(integer("ff", 16), Value::Integer(255)));
        assert!(matches!(integer("99999999999999999999", 10), Value::Number(x) if x == 1e20));
    }
}
