//! `rmpm merge`: the shards of an ensemble put together, into the files that one machine would have left.

use std::{
    collections::{BTreeMap, BTreeSet, btree_map::Entry},
    fs, io,
    path::{Path, PathBuf},
};

use super::{
    Ended, Problem, Results, Spent, Start, folder,
    journal::{self, Contents, Session, name},
    realise::{Draw, Shard, case_hash},
    row::Done,
};
use crate::case::{self, Case};

/// Shards that fit together and leave nothing out.
#[derive(Clone, Debug)]
pub struct Shards {
    case: Case,
    session: Session,
    done: BTreeMap<Draw, Done>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// What is found while the shards are read.
#[derive(Default)]
struct Findings {
    notes: Vec<String>,
    /// What makes it impossible.
    problems: Vec<String>,
}

/// Reads the shards and checks that they are the whole of one ensemble.
///
/// # Errors
/// A list of what is missing, foreign, damaged or contradicts itself; those of the file system.
pub fn read(folders: &[PathBuf]) -> Result<Shards, Problem> {
    let mut findings = Findings::default();
    let parts: Vec<(&PathBuf, Contents)> = folders
        .iter()
        .filter_map(|path| contents(path, &mut findings).transpose())
        .map(|part| part.map_err(Problem::from))
        .collect::<Result<_, _>>()?;
    let Some(first) = parts.iter().find_map(|(_, c)| c.sessions.last()).cloned() else {
        findings.problems.push("no folder tells what was run".to_owned());
        return Err(refusal(findings));
    };
    let own: Vec<&(&PathBuf, Contents)> = parts.iter().filter(|part| belongs(part, &first, &mut findings)).collect();
    let mut done = BTreeMap::new();
    own.iter().for_each(|(path, contents)| gather(path, contents, &mut done, &mut findings));
    let session = whole(&own, &first);
    check_complete(&own, &session, &done, &mut findings);
    let case = case_of(&own, &session).map_err(|text| findings.problems.push(text)).ok();
    match case {
        Some(case) if findings.problems.is_empty() => Ok(Shards { case, session, done, notes: findings.notes }),
        _ => Err(refusal(findings)),
    }
}

fn refusal(findings: Findings) -> Problem {
    let list = findings.problems.iter().chain(&findings.notes).map(|text| format!("\n- {text}")).collect::<String>();
    Problem::Refused(format!("the shards cannot be merged:{list}"))
}

/// The journal of a folder; `None` where there is nothing sound.
fn contents<'a>(path: &'a PathBuf, findings: &mut Findings) -> io::Result<Option<(&'a PathBuf, Contents)>> {
    let place = path.display();
    let contents = match journal::read(&path.join(journal::NAME)) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            findings.problems.push(format!("{place} holds no ensemble"));
            return Ok(None);
        }
        other => other.map_err(|e| io::Error::new(e.kind(), format!("{place}: {e}")))?,
    };
    findings.notes.extend(contents.findings().into_iter().map(|text| format!("{place}: {text}")));
    findings
        .problems
        .extend(contents.differing.iter().map(|draw| format!("{place}: two rows of {} differ", name(*draw))));
    if contents.id().is_none() {
        findings.problems.push(format!("{place}: no line of its journal is sound"));
        return Ok(None);
    }
    Ok(Some((path, contents)))
}

/// Whether a shard is of the same ensemble as the first.
fn belongs((path, contents): &(&PathBuf, Contents), first: &Session, findings: &mut Findings) -> bool {
    let place = path.display();
    if contents.id() != Some(&first.id()) {
        let what = match contents.sessions.last() {
            Some(s) if s.schema_version != first.schema_version => format!("schema version {}", s.schema_version),
            Some(s) if s.seed != first.seed => format!("seed {} and not {}", s.seed, first.seed),
            _ => "another case".to_owned(),
        };
        findings.problems.push(format!("{place} is of another ensemble: {what}"));
        return false;
    }
    for session in &contents.sessions {
        if let Some(text) = folder::differences(session, first) {
            findings.notes.push(format!("{place}: {text}"));
            break;
        }
    }
    true
}

/// Adds the rows of a shard. A row that is there already is taken once if it is the same.
fn gather(path: &Path, contents: &Contents, done: &mut BTreeMap<Draw, Done>, findings: &mut Findings) {
    let mut doubled = BTreeSet::new();
    for (draw, new) in &contents.done {
        match done.entry(*draw) {
            Entry::Vacant(slot) => drop(slot.insert(new.clone())),
            Entry::Occupied(slot) if slot.get().row == new.row => drop(doubled.insert(*draw)),
            Entry::Occupied(_) => {
                findings.problems.push(format!(
                    "{}: {} differs from that of an earlier folder",
                    path.display(),
                    name(*draw)
                ));
            }
        }
    }
    if !doubled.is_empty() {
        findings.notes.push(format!("{}: {} are there twice and alike; taken once", path.display(), spoken(&doubled)));
    }
}

/// The session that one machine would have had.
fn whole(parts: &[&(&PathBuf, Contents)], first: &Session) -> Session {
    let sessions = || parts.iter().filter_map(|(_, c)| c.sessions.last());
    let begin = sessions().map(|s| s.first).min().unwrap_or(first.first);
    let end = sessions().map(|s| s.first.saturating_add(s.realisations)).max().unwrap_or(begin);
    Session { shard: Shard::WHOLE, first: begin, realisations: end - begin, ..first.clone() }
}

fn check_complete(
    parts: &[&(&PathBuf, Contents)],
    session: &Session,
    done: &BTreeMap<Draw, Done>,
    findings: &mut Findings,
) {
    let missing: BTreeSet<Draw> = session.draws().filter(|draw| !done.contains_key(draw)).collect();
    if missing.is_empty() {
        return;
    }
    let shards: BTreeSet<Shard> = parts.iter().filter_map(|(_, c)| Some(c.sessions.last()?.shard)).collect();
    findings.problems.push(format!("missing: {}", spoken(&missing)));
    for (path, contents) in parts {
        let Some(own) = contents.sessions.last() else { continue };
        let lacking = own.draws().filter(|draw| missing.contains(draw)).count();
        if lacking > 0 {
            let text =
                format!("{} (shard {}) lacks {lacking} of them: run it again with --resume", path.display(), own.shard);
            findings.problems.push(text);
        }
    }
    let of: BTreeSet<u64> = shards.iter().map(|s| s.of).collect();
    if let (Some(&of), 1) = (of.first(), of.len()) {
        let absent = (1..=of).map(|index| Shard { index, of }).filter(|s| !shards.contains(s));
        findings.problems.extend(absent.take(20).map(|s| format!("shard {s} is not among the folders")));
    }
}

/// Draws as ranges, cut short where there are many.
fn spoken(draws: &BTreeSet<Draw>) -> String {
    const MOST: usize = 12;
    let mut ranges: Vec<(u64, u64)> = Vec::new();
    for k in draws.iter().flatten() {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == *k => *last = *k,
            _ => ranges.push((*k, *k)),
        }
    }
    let mut words: Vec<String> = draws.iter().filter(|d| d.is_none()).map(|d| name(*d)).collect();
    let range = |(a, b): &(u64, u64)| if a == b { format!("{a}") } else { format!("{a} to {b}") };
    let mut text: Vec<String> = ranges.iter().take(MOST).map(range).collect();
    if ranges.len() > MOST {
        text.push("...".to_owned());
    }
    if !text.is_empty() {
        words.push(format!("realisations {}", text.join(", ")));
    }
    words.join(" and ")
}

/// The case, from the first folder whose `case.toml` is that of the ensemble.
fn case_of(parts: &[&(&PathBuf, Contents)], session: &Session) -> Result<Case, String> {
    let read = |path: &Path| {
        let file = path.join("case.toml");
        let text = fs::read_to_string(&file).ok()?;
        let (case, _) = case::read(&file.display().to_string(), &text, &[]).ok()?;
        (case_hash(&case) == session.case_hash).then_some(case)
    };
    parts
        .iter()
        .find_map(|(path, _)| read(path))
        .ok_or_else(|| "no folder has the case.toml of the ensemble: resume any of the shards".to_owned())
}

/// Writes the whole into a claimed folder.
///
/// # Errors
/// A folder that holds an ensemble that is not finished; those of the file system.
pub fn write(shards: &Shards, out: &Path, start: Start) -> Result<Ended, Problem> {
    let (mut journal, _, _) = folder::open(out, &shards.session, start)?;
    let results = Results::new(&shards.case, &shards.session, &shards.done);
    journal.rows(shards.done.values())?;
    let report = super::write(out, &results, &Spent::default())?;
    journal.finish()?;
    Ok(Ended { results, report })
}
