//! The folder of an ensemble: begun, or gone on with.

use std::{fs, io, path::Path};

use super::{
    Problem,
    journal::{self, Contents, Journal, Session},
    pictures,
};
use crate::output::atomic;

/// How to take a folder that holds an ensemble already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Refuse one that is not finished; start anew over a finished one.
    New,
    /// Go on with it.
    Resume,
    /// Start anew, whatever is there.
    Fresh,
}

/// What an ensemble writes.
const FILES: [&str; 6] =
    [journal::NAME, "case.toml", "ensemble.csv", "ensemble_timing.csv", "summary.json", "timing.json"];

/// What the journal of a folder knows, if the folder may be taken in this way. Nothing is changed.
///
/// # Errors
/// An ensemble that may not be started over or gone on with; those of the file system.
pub fn admit(path: &Path, session: &Session, start: Start) -> Result<Contents, Problem> {
    let known = match journal::read(&path.join(journal::NAME)) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => Contents::default(),
        other => other?,
    };
    let place = path.display();
    match start {
        Start::New if known.id().is_some() && !known.finished => Err(Problem::Refused(format!(
            "'{place}' holds an ensemble that is not finished ({} runs are done): go on with --resume, or start over with --fresh",
            known.done.len()
        ))),
        Start::Resume => match check(&known, session) {
            Err(text) => Err(Problem::Refused(format!("'{place}' cannot be resumed: {text}"))),
            Ok(()) => Ok(known),
        },
        Start::New | Start::Fresh => Ok(known),
    }
}

/// Opens the journal in a claimed folder; what it knows already comes with it, and what the user should
/// know about it.
///
/// # Errors
/// An ensemble that may not be started over or gone on with; those of the file system.
pub fn open(path: &Path, session: &Session, start: Start) -> Result<(Journal, Contents, Vec<String>), Problem> {
    let mut known = admit(path, session, start)?;
    atomic::sweep(path)?;
    let place = path.display();
    let mut notes = Vec::new();
    match start {
        Start::Resume => {
            notes.extend(known.findings().into_iter().map(|text| format!("{place}/{}: {text}", journal::NAME)));
            notes.extend(known.sessions.last().and_then(|last| differences(last, session)));
        }
        Start::New | Start::Fresh => {
            known = Contents::default();
            clear(path)?;
        }
    }
    let journal = Journal::open(path, &known, session)?;
    Ok((journal, known, notes))
}

fn clear(path: &Path) -> io::Result<()> {
    for name in FILES.iter().chain(&pictures::FILES) {
        match fs::remove_file(path.join(name)) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(e),
            _ => {}
        }
    }
    Ok(())
}

/// Whether a journal is of the same ensemble.
fn check(known: &Contents, session: &Session) -> Result<(), String> {
    if let Some(draw) = known.differing.first() {
        return Err(format!(
            "two rows of {} differ, so one of them is not of this case; start over with --fresh",
            journal::name(*draw)
        ));
    }
    for old in &known.sessions {
        if old.schema_version != session.schema_version {
            return Err(format!("it has schema version {}, this rmpm {}", old.schema_version, session.schema_version));
        }
        if old.seed != session.seed {
            return Err(format!("its seed is {}, that of the case {}", old.seed, session.seed));
        }
        if old.case_hash != session.case_hash {
            return Err("it is of another case (or other --set values); its case.toml holds it".to_owned());
        }
        if old.shard != session.shard {
            return Err(format!("it is shard {}, not {}", old.shard, session.shard));
        }
    }
    // rows whose session line is damaged still tell of which ensemble they are
    if known.id().is_some_and(|id| id != session.id()) {
        return Err("its rows are of another case".to_owned());
    }
    Ok(())
}

/// Where another program, or another arithmetic, has made the earlier rows.
pub fn differences(old: &Session, new: &Session) -> Option<String> {
    let (a, b) = (&old.build, &new.build);
    if a.fp_path != b.fp_path {
        return Some(format!(
            "the rows so far were made with the arithmetic {}, this program has {}: they need not be the same to the bit",
            a.fp_path, b.fp_path
        ));
    }
    (a != b).then(|| {
        format!(
            "the rows so far were made by rmpm {} ({}, {}), this is {} ({}, {}): they need not be the same to the bit",
            a.version, a.commit, a.rustc, b.version, b.commit, b.rustc
        )
    })
}
