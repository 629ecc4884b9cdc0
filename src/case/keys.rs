//! The keys of one table: each is asked for by name, and what nobody asked for is an error.

use super::cursor::Cursor;
use super::log::{Log, Problem};
use super::not_modelled;
use super::source::Span;
use super::suggest;
use super::tree::{Entry, Table};

/// One choice of a tagged table, with the keys that belong to it alone or to it and a few others.
pub(super) struct Variant {
    /// Value of the tag.
    pub word: &'static str,
    /// Keys that this choice takes.
    pub keys: &'static [&'static str],
}

/// What a tag was set to.
struct Tag {
    name: &'static str,
    chosen: Option<&'static str>,
    /// Whether an override chose: keys of the file that belong to another choice then lapse.
    overridden: bool,
    variants: &'static [Variant],
}

/// A table being read.
pub(super) struct Keys<'a> {
    log: &'a Log,
    path: String,
    header: Span,
    entries: Option<&'a Table>,
    known: Vec<&'static str>,
    tag: Option<Tag>,
}

impl<'a> Keys<'a> {
    /// A table by its path; `None` for one that the file leaves out.
    pub fn new(log: &'a Log, path: String, header: Span, entries: Option<&'a Table>) -> Self {
        Self { log, path, header, entries, known: Vec::new(), tag: None }
    }

    /// Path of a key of this table.
    pub fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// The names of all keys, for tables whose keys are the user's own names.
    pub fn names(&self) -> impl Iterator<Item = &'a String> {
        self.entries.into_iter().flat_map(|table| table.keys())
    }

    /// A value by a name of the user's own.
    pub fn named(&self, name: &str) -> Option<Cursor<'a>> {
        let entry = self.entries?.get(name)?;
        Some(self.cursor(name, entry))
    }

    fn cursor(&self, key: &str, entry: &'a Entry) -> Cursor<'a> {
        Cursor { log: self.log, path: self.path_of(key), key: entry.key, node: &entry.node }
    }

    /// The value of a key, if it is set.
    pub fn get(&mut self, key: &'static str) -> Option<Cursor<'a>> {
        self.known.push(key);
        self.named(key)
    }

    /// A key that must be set.
    pub fn required<T>(&mut self, key: &'static str, read: impl FnOnce(&Cursor<'a>) -> Option<T>) -> Option<T> {
        match self.get(key) {
            Some(cursor) => read(&cursor),
            None => self.missing(key),
        }
    }

    /// A key with a default.
    pub fn or<T>(&mut self, key: &'static str, default: T, read: impl FnOnce(&Cursor<'a>) -> Option<T>) -> Option<T> {
        self.get(key).map_or(Some(default), |cursor| read(&cursor))
    }

    /// A key that may be left out.
    pub fn optional<T>(&mut self, key: &'static str, read: impl FnOnce(&Cursor<'a>) -> Option<T>) -> Option<Option<T>> {
        self.get(key).map_or(Some(None), |cursor| read(&cursor).map(Some))
    }

    /// A table that may be left out: its keys then have their defaults.
    pub fn section(&mut self, key: &'static str) -> Option<Keys<'a>> {
        match self.get(key) {
            Some(cursor) => cursor.table(),
            None => Some(Keys::new(self.log, self.path_of(key), self.header, None)),
        }
    }

    /// The key that chooses between variants; `default` where it may be left out.
    pub fn tag(
        &mut self,
        name: &'static str,
        default: Option<&'static str>,
        variants: &'static [Variant],
    ) -> Option<&'static str> {
        let words: Vec<_> = variants.iter().map(|variant| variant.word).collect();
        let found = self.get(name);
        let overridden = found.as_ref().is_some_and(|cursor| !cursor.node.span.in_file());
        let chosen = match (&found, default) {
            (Some(cursor), _) => cursor.word(&words),
            (None, Some(default)) => Some(default),
            (None, None) => self.missing_tag(name, &words),
        };
        self.tag = Some(Tag { name, chosen, overridden, variants });
        chosen
    }

    /// Two keys of which exactly one must be set; an override of one lapses the other's file value.
    pub fn either(&mut self, first: &'static str, second: &'static str) -> Option<Cursor<'a>> {
        match (self.get(first), self.get(second)) {
            (Some(one), None) | (None, Some(one)) => Some(one),
            (Some(one), Some(two)) if one.key.in_file() == two.key.in_file() => {
                let message = format!("`{}` and `{}` are both set", one.path, two.path);
                two.key_error(Problem::new(message, "only one of the two may be set"));
                None
            }
            (Some(one), Some(two)) => Some(if two.key.in_file() { one } else { two }),
            (None, None) => self.missing_either(first, second),
        }
    }

    /// Notes an error at the table's header.
    pub fn header_error<T>(&self, key: &str, problem: Problem) -> Option<T> {
        self.log.error(self.header, &self.path_of(key), problem);
        None
    }

    fn missing<T>(&self, key: &str) -> Option<T> {
        let path = self.path_of(key);
        let message = format!("`{path}` is missing");
        self.header_error(key, Problem::new(message, format!("{} needs the key `{key}`", self.name())))
    }

    fn missing_tag<T>(&self, name: &str, words: &[&str]) -> Option<T> {
        let message = format!("`{}` is missing", self.path_of(name));
        let label = format!("{} needs the key `{name}`", self.name());
        let help = format!("`{name}` is one of {}", suggest::list(words.iter().copied()));
        self.header_error(name, Problem::new(message, label).help(help))
    }

    fn missing_either<T>(&self, first: &str, second: &str) -> Option<T> {
        let message = format!("`{}` is missing", self.path_of(first));
        let label = format!("{} needs `{first}` or `{second}`", self.name());
        self.header_error(first, Problem::new(message, label))
    }

    fn name(&self) -> String {
        if self.path.is_empty() { "the case".to_owned() } else { format!("`{}`", self.path) }
    }

    /// Notes an error for each key that nobody asked for.
    pub fn finish(self) {
        for (key, entry) in self.entries.into_iter().flatten() {
            if !self.known.contains(&key.as_str()) {
                self.unknown(key, entry);
            }
        }
    }

    fn unknown(&self, key: &str, entry: &Entry) {
        let path = self.path_of(key);
        let owners = self.owners(key);
        let problem = match &self.tag {
            Some(tag) if !owners.is_empty() => self.foreign(tag, key, entry, &owners),
            _ => not_modelled::problem(key).or_else(|| Some(self.stray(key))),
        };
        if let Some(problem) = problem {
            self.log.error(entry.key, &path, problem);
        }
    }

    /// The variants that take a key.
    fn owners(&self, key: &str) -> Vec<&'static str> {
        let variants = self.tag.as_ref().map_or(&[][..], |tag| tag.variants);
        let owners = variants.iter().filter(|variant| variant.keys.contains(&key));
        owners.map(|variant| variant.word).collect()
    }

    /// A key of another variant than the chosen one.
    fn foreign(&self, tag: &Tag, key: &str, entry: &Entry, owners: &[&str]) -> Option<Problem> {
        let chosen = tag.chosen?;
        if tag.overridden && entry.key.in_file() {
            return None;
        }
        let message = format!("`{}` has no meaning with {} = \"{chosen}\"", self.path_of(key), tag.name);
        let label = format!("a key of {} {}", tag.name, suggest::list(owners.iter().copied()));
        let help = format!("leave `{key}` out or change `{}`", self.path_of(tag.name));
        Some(Problem::new(message, label).help(help))
    }

    fn stray(&self, key: &str) -> Problem {
        let chosen = self.tag.as_ref().and_then(|tag| tag.chosen);
        let with = chosen.map(|word| format!(" with \"{word}\"")).unwrap_or_default();
        let label = format!("{}{with} takes {}", self.name(), self.known.join(", "));
        let help = suggest::did_you_mean(key, self.known.iter().copied());
        Problem::new(format!("unknown key `{}`", self.path_of(key)), label).help_if(help)
    }
}
