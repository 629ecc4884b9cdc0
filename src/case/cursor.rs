//! One value of the tree, and its conversions: each notes its own error.

use super::keys::Keys;
use super::limits::{Limits, figure};
use super::log::{Log, Problem};
use super::not_modelled;
use super::source::Span;
use super::suggest;
use super::tree::{Node, Value};

/// Most numbers in a list, such as the times of pictures: a picture has room for 64 panels.
const MOST_NUMBERS: usize = 64;

/// A value, where it stands, and where to note what is wrong with it.
pub(super) struct Cursor<'a> {
    /// Where errors go.
    pub log: &'a Log,
    /// Path of the value, such as `grid.cell` or `region.0.polygon.2`.
    pub path: String,
    /// Where the key stands.
    pub key: Span,
    /// The value.
    pub node: &'a Node,
}

impl<'a> Cursor<'a> {
    /// Notes an error at the value.
    pub fn error(&self, problem: Problem) {
        self.log.error(self.node.span, &self.path, problem);
    }

    /// Notes an error at the key.
    pub fn key_error(&self, problem: Problem) {
        self.log.error(self.key, &self.path, problem);
    }

    /// Notes a wrong type.
    pub fn wrong_type<T>(&self, wanted: &str) -> Option<T> {
        let message = format!("`{}` is {}", self.path, self.node.value.kind());
        self.error(Problem::new(message, format!("must be {wanted}")));
        None
    }

    /// A finite number within limits.
    pub fn number(&self, limits: Limits) -> Option<f64> {
        match self.node.value {
            Value::Integer(value) => self.checked(value as f64, limits),
            Value::Number(value) => self.checked(value, limits),
            _ => self.wrong_type("a number"),
        }
    }

    /// A number, or a short formula as text: "5/29", "sqrt(3)", "pi/50".
    pub fn formula(&self, limits: Limits) -> Option<f64> {
        let Value::Text(text) = &self.node.value else { return self.number(limits) };
        let Some(value) = evaluate(text) else {
            let message = format!("`{}` is \"{text}\"", self.path);
            let label = "must be a number or a formula such as \"5/29\" or \"sqrt(3)\"";
            self.error(Problem::new(message, label));
            return None;
        };
        self.checked(value, limits)
    }

    fn checked(&self, value: f64, limits: Limits) -> Option<f64> {
        if limits.allow(value) {
            return Some(value + 0.0);
        }
        let message = match value.is_finite() {
            true => format!("`{}` = {} is out of range", self.path, figure(value)),
            false => format!("`{}` is not a finite number", self.path),
        };
        self.error(Problem::new(message, format!("must be {limits}")));
        None
    }

    /// A whole number from `low` to `high`.
    pub fn whole(&self, low: u64, high: u64) -> Option<u64> {
        let Value::Integer(value) = self.node.value else {
            return self.wrong_type(&format!("a whole number from {low} to {high}"));
        };
        let found = u64::try_from(value).ok().filter(|value| (low..=high).contains(value));
        if found.is_none() {
            let message = format!("`{}` = {value} is out of range", self.path);
            self.error(Problem::new(message, format!("must be from {low} to {high}")));
        }
        found
    }

    /// true or false.
    pub fn flag(&self) -> Option<bool> {
        match self.node.value {
            Value::Flag(flag) => Some(flag),
            _ => self.wrong_type("true or false"),
        }
    }

    /// Text.
    pub fn text(&self) -> Option<&'a str> {
        match &self.node.value {
            Value::Text(text) => Some(text),
            _ => self.wrong_type("text in quotes"),
        }
    }

    /// One of a few words.
    pub fn word(&self, words: &[&'static str]) -> Option<&'static str> {
        let Value::Text(text) = &self.node.value else {
            return self.wrong_type(&format!("one of {}", suggest::list(words.iter().copied())));
        };
        let found = words.iter().copied().find(|word| word == text);
        if found.is_none() {
            self.wrong_word(text, words);
        }
        found
    }

    fn wrong_word(&self, text: &str, words: &[&'static str]) {
        let help = suggest::did_you_mean(text, words.iter().copied());
        if let Some(problem) = not_modelled::problem(text).filter(|_| help.is_none()) {
            return self.error(problem);
        }
        let message = format!("`{}` cannot be \"{text}\"", self.path);
        let label = format!("must be {}", suggest::list(words.iter().copied()));
        self.error(Problem::new(message, label).help_if(help));
    }

    /// The values of a list.
    pub fn list(&self) -> Option<Vec<Cursor<'a>>> {
        let Value::Array(nodes) = &self.node.value else { return self.wrong_type("a list") };
        Some(nodes.iter().enumerate().map(|(index, node)| self.item(index, node)).collect())
    }

    fn item(&self, index: usize, node: &'a Node) -> Cursor<'a> {
        Cursor { log: self.log, path: format!("{}.{index}", self.path), key: node.span, node }
    }

    /// Two numbers in brackets.
    pub fn pair(&self, limits: Limits) -> Option<[f64; 2]> {
        self.pair_by(|number| number.number(limits))
    }

    /// Two values in brackets, each read by `read`.
    pub fn pair_by(&self, read: impl Fn(&Cursor<'a>) -> Option<f64>) -> Option<[f64; 2]> {
        let wanted = "two numbers in brackets: [x, y]";
        let Value::Array(nodes) = &self.node.value else { return self.wrong_type(wanted) };
        let [x, y] = nodes.as_slice() else {
            let message = format!("`{}` has {} values", self.path, nodes.len());
            self.error(Problem::new(message, format!("must be {wanted}")));
            return None;
        };
        let (x, y) = (read(&self.item(0, x)), read(&self.item(1, y)));
        Some([x?, y?])
    }

    /// A list of at most `MOST_NUMBERS` numbers, each within limits.
    pub fn numbers(&self, limits: Limits) -> Option<Vec<f64>> {
        let list = self.list()?;
        if list.len() > MOST_NUMBERS {
            let message = format!("`{}` has {} numbers", self.path, list.len());
            self.error(Problem::new(message, format!("must have at most {MOST_NUMBERS}")));
            return None;
        }
        let found: Vec<_> = list.iter().map(|item| item.number(limits)).collect();
        found.into_iter().collect()
    }

    /// The keys of a table.
    pub fn table(&self) -> Option<Keys<'a>> {
        let Value::Table(table) = &self.node.value else { return self.wrong_type("a table") };
        Some(Keys::new(self.log, self.path.clone(), self.node.span, Some(table)))
    }
}

/// A number, `pi`, `sqrt(number)`, or the quotient of two of these.
fn evaluate(text: &str) -> Option<f64> {
    match text.split_once('/') {
        Some((above, below)) => Some(factor(above)? / factor(below)?),
        None => factor(text),
    }
}

fn factor(text: &str) -> Option<f64> {
    let text = text.trim();
    let root = text.strip_prefix("sqrt(").and_then(|rest| rest.strip_suffix(')'));
    match root {
        Some(inner) => inner.trim().parse::<f64>().ok().map(f64::sqrt),
        None if text == "pi" => Some(std::f64::consts::PI),
        None => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::evaluate;

    #[test]
    fn formulas_are_quotients_and_roots() {
        assert_eq!(evaluate("5/29"), Some(5.0 / 29.0));
        assert_eq!(evaluate("sqrt(3)"), Some(3f64.sqrt()));
        assert_eq!(evaluate("pi / 50"), Some(std::f64::consts::PI / 50.0));
        assert_eq!(evaluate("5/29/2"), None);
        assert_eq!(evaluate("five"), None);
    }
}
