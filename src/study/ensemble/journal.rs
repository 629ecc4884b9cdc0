//! The journal of an ensemble: a line for each draw that is done, safe on the disk before the next.
//!
//! A line is `{"sum":"...","of":"...","entry":{...}}`. `sum` is the start of the SHA-256 of what
//! follows it, so that a torn or damaged line is known; `of` tells of which ensemble the line is, so
//! that a line keeps its worth when another one is damaged. Lines are only ever added.

use std::{
    collections::{BTreeMap, btree_map::Entry as Slot},
    fs::{File, OpenOptions},
    io::{self, BufRead, BufReader, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{
    realise::{Draw, Shard},
    row::Done,
};
use crate::output::record::{Build, sha256};

/// Name of the file.
pub const NAME: &str = "journal.jsonl";
/// Hexadecimal digits of a checksum.
const DIGITS: usize = 16;

/// What was started: each start and each resumption adds one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Session {
    pub schema_version: u32,
    /// Of the resolved case without the realisation.
    pub case_hash: String,
    pub seed: u64,
    pub build: Build,
    pub shard: Shard,
    /// First realisation, and how many there are over all shards.
    pub first: u64,
    pub realisations: u64,
}

impl Session {
    /// Short name of the ensemble that it belongs to.
    pub fn id(&self) -> String {
        let text = format!("{} {} {}", self.schema_version, self.case_hash, self.seed);
        sha256(text.as_bytes()).split_off(64 - DIGITS)
    }

    /// The draws of its shard, in order: the mean first.
    pub fn draws(&self) -> impl Iterator<Item = Draw> + '_ {
        let all = (self.first..self.first.saturating_add(self.realisations)).map(Some);
        std::iter::once(None).chain(all).filter(|draw| self.shard.has(*draw))
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Entry {
    Session(Session),
    Row(Box<Done>),
    /// All that was asked for is there.
    Finished,
}

#[derive(Serialize, Deserialize)]
struct Line {
    of: String,
    entry: Entry,
}

/// What a journal holds.
#[derive(Clone, Debug, Default)]
pub struct Contents {
    pub sessions: Vec<Session>,
    pub done: BTreeMap<Draw, Done>,
    /// Whether it ends with the end of the ensemble.
    pub finished: bool,
    /// Numbers of the damaged lines, from 1.
    pub damaged: Vec<usize>,
    /// Whether the last line is not whole, as a kill leaves it.
    pub torn: bool,
    /// Draws with two rows that differ.
    pub differing: Vec<Draw>,
    /// Lines of another ensemble.
    pub foreign: Vec<usize>,
    id: Option<String>,
    /// Bytes up to the end of the last whole line.
    end: u64,
}

impl Contents {
    /// Short name of the ensemble; `None` where no line is sound.
    pub fn id(&self) -> Option<&str> {
        self.id.as_deref()
    }

    /// What is not as it should be, for people.
    pub fn findings(&self) -> Vec<String> {
        let mut found = Vec::new();
        if self.torn {
            found.push("the last line is not whole: it is dropped".to_owned());
        }
        let dropped = self.damaged.iter().map(|n| format!("line {n} is damaged: it is dropped"));
        let foreign = self.foreign.iter().map(|n| format!("line {n} is of another ensemble: it is dropped"));
        let differing = self.differing.iter().map(|d| format!("two rows of {} differ", name(*d)));
        found.extend(dropped.chain(foreign).chain(differing));
        found
    }

    fn note(&mut self, number: usize, line: Line) {
        if self.id.get_or_insert_with(|| line.of.clone()) != &line.of {
            return self.foreign.push(number);
        }
        self.finished = matches!(line.entry, Entry::Finished);
        match line.entry {
            Entry::Session(session) => self.sessions.push(session),
            Entry::Row(done) => match self.done.entry(done.row.realisation) {
                Slot::Vacant(slot) => drop(slot.insert(*done)),
                Slot::Occupied(slot) if slot.get().row == done.row => {}
                Slot::Occupied(slot) => self.differing.push(*slot.key()),
            },
            Entry::Finished => {}
        }
    }
}

/// A draw in words.
pub fn name(draw: Draw) -> String {
    draw.map_or("the run at the mean".to_owned(), |k| format!("realisation {k}"))
}

/// Reads a journal, line by line.
///
/// # Errors
/// Those of the file; damage is no error but a finding.
pub fn read(path: &Path) -> io::Result<Contents> {
    let mut reader = BufReader::new(File::open(path)?);
    let (mut contents, mut line, mut number) = (Contents::default(), Vec::new(), 0);
    while reader.read_until(b'\n', &mut line)? > 0 {
        number += 1;
        if line.pop() != Some(b'\n') {
            contents.torn = true;
            break;
        }
        contents.end += line.len() as u64 + 1;
        match unseal(&line) {
            Some(sound) => contents.note(number, sound),
            None => contents.damaged.push(number),
        }
        line.clear();
    }
    Ok(contents)
}

/// A journal open for more lines.
pub struct Journal {
    file: File,
    of: String,
}

impl Journal {
    /// Opens or makes the journal of a folder, drops what stands behind the last whole line of `known`,
    /// and adds a session.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn open(folder: &Path, known: &Contents, session: &Session) -> io::Result<Self> {
        let path: PathBuf = folder.join(NAME);
        let mut file = OpenOptions::new().write(true).create(true).truncate(false).open(path)?;
        file.set_len(known.end)?;
        file.seek(SeekFrom::End(0))?;
        let mut journal = Journal { file, of: session.id() };
        journal.add(Entry::Session(session.clone()))?;
        sync_folder(folder)?;
        Ok(journal)
    }

    /// Adds rows; they are on the disk when this returns.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn rows<'a>(&mut self, mut rows: impl Iterator<Item = &'a Done>) -> io::Result<()> {
        rows.try_for_each(|done| self.write(Entry::Row(Box::new(done.clone()))))?;
        self.file.sync_data()
    }

    /// Notes that the ensemble is complete.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn finish(&mut self) -> io::Result<()> {
        self.add(Entry::Finished)
    }

    fn add(&mut self, entry: Entry) -> io::Result<()> {
        self.write(entry)?;
        self.file.sync_data()
    }

    fn write(&mut self, entry: Entry) -> io::Result<()> {
        self.file.write_all(&seal(&Line { of: self.of.clone(), entry })?)
    }
}

/// Makes the name of a new file last.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

const HEAD: &str = "{\"sum\":\"";

fn seal(line: &Line) -> io::Result<Vec<u8>> {
    let text = serde_json::to_string(line).map_err(io::Error::other)?;
    let rest = text.strip_prefix('{').unwrap_or(&text);
    Ok(format!("{HEAD}{}\",{rest}\n", checksum(rest.as_bytes())).into_bytes())
}

fn unseal(line: &[u8]) -> Option<Line> {
    let text = std::str::from_utf8(line).ok()?.strip_prefix(HEAD)?;
    let (sum, rest) = text.split_once("\",")?;
    if sum != checksum(rest.as_bytes()) {
        return None;
    }
    serde_json::from_str(&format!("{{{rest}")).ok()
}

fn checksum(bytes: &[u8]) -> String {
    let mut sum = sha256(bytes);
    sum.truncate(DIGITS);
    sum
}
