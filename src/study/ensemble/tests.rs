//! The journal under damage, and what is made of it.

use std::{collections::BTreeMap, fs};

use super::{
    Problem, Start, folder,
    journal::{self, Contents, Journal, Session},
    realise::{Draw, Shard},
    row::{Done, tests::done_with},
};
use crate::output::record::{Build, SCHEMA_VERSION};

fn session(seed: u64) -> Session {
    Session {
        schema_version: SCHEMA_VERSION,
        case_hash: "0123".to_owned(),
        seed,
        build: Build::current(),
        shard: Shard::WHOLE,
        first: 0,
        realisations: 4,
    }
}

/// Values whose digits are many, or few, or hard.
fn rows() -> Vec<Done> {
    [0.1 + 0.2, -0.0, 5e-324, 12.0].iter().zip(0..).map(|(v, k)| done_with(k, "x", *v)).collect()
}

/// A folder with a journal of four rows, and its bytes.
fn written() -> (tempfile::TempDir, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &Contents::default(), &session(1)).unwrap();
    journal.rows(rows().iter()).unwrap();
    journal.finish().unwrap();
    let bytes = fs::read(folder.path().join(journal::NAME)).unwrap();
    (folder, bytes)
}

fn read(folder: &tempfile::TempDir) -> Contents {
    journal::read(&folder.path().join(journal::NAME)).unwrap()
}

fn truth() -> BTreeMap<Draw, Done> {
    rows().into_iter().map(|done| (done.row.realisation, done)).collect()
}

#[test]
fn a_journal_gives_back_what_was_written_to_the_bit() {
    let (folder, _) = written();
    let contents = read(&folder);
    assert!(contents.finished && contents.findings().is_empty());
    assert_eq!(contents.sessions, [session(1)]);
    assert_eq!(contents.done, truth());
    let bits = |done: &BTreeMap<Draw, Done>| done.values().map(|d| d.row.measures["x"].to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&contents.done), bits(&truth()));
}

#[test]
fn a_journal_cut_at_any_byte_loses_its_last_line_only_and_goes_on() {
    let (folder, bytes) = written();
    let path = folder.path().join(journal::NAME);
    for cut in 0..bytes.len() {
        fs::write(&path, &bytes[..cut]).unwrap();
        let contents = read(&folder);
        let whole = bytes[..cut].iter().filter(|b| **b == b'\n').count();
        assert_eq!(contents.torn, cut > 0 && bytes[cut - 1] != b'\n', "{cut}");
        assert!(contents.damaged.is_empty(), "{cut}");
        assert_eq!(contents.done.len(), whole.saturating_sub(1).min(4), "{cut}");
        if cut % 97 != 0 {
            continue; // to go on costs two waits for the disk
        }
        let mut journal = Journal::open(folder.path(), &contents, &session(1)).unwrap();
        let missing = rows().into_iter().filter(|d| !contents.done.contains_key(&d.row.realisation));
        journal.rows(missing.collect::<Vec<_>>().iter()).unwrap();
        let after = read(&folder);
        assert!(after.findings().is_empty(), "{cut}: {:?}", after.findings());
        assert_eq!(after.done, truth(), "{cut}");
    }
}

#[test]
fn no_flipped_bit_gives_a_wrong_row() {
    let (folder, bytes) = written();
    let path = folder.path().join(journal::NAME);
    for at in 0..bytes.len() {
        let mut flipped = bytes.clone();
        flipped[at] ^= 1 << (at % 8);
        fs::write(&path, &flipped).unwrap();
        let contents = read(&folder);
        assert!(!contents.findings().is_empty(), "byte {at}");
        // a line, or two that the flip has joined, is lost; the others are as they were
        assert!(contents.done.len() >= 2, "byte {at}");
        for (draw, done) in &contents.done {
            assert_eq!(Some(done), truth().get(draw), "byte {at}");
        }
    }
}

#[test]
fn rows_that_differ_and_rows_of_another_ensemble_are_found() {
    let (folder, bytes) = written();
    let known = read(&folder);
    let mut journal = Journal::open(folder.path(), &known, &session(1)).unwrap();
    journal.rows([done_with(2, "x", 7.0), done_with(3, "x", 12.0)].iter()).unwrap();
    assert_eq!(read(&folder).differing, [Some(2)]);
    let mut other = Journal::open(folder.path(), &known, &session(2)).unwrap();
    other.rows([done_with(0, "x", 1.0)].iter()).unwrap();
    let contents = read(&folder);
    assert_eq!((contents.foreign.len(), contents.done), (2, truth()));
    assert!(fs::read(folder.path().join(journal::NAME)).unwrap().starts_with(&bytes));
}

/// Opening the folder of session 1 to go on with another one.
fn resumed(session: &Session) -> Result<Vec<String>, String> {
    let (folder, _) = written();
    match folder::open(folder.path(), session, Start::Resume) {
        Ok((_, known, notes)) => {
            assert_eq!(known.done, truth());
            Ok(notes)
        }
        Err(Problem::Refused(text)) => Err(text),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn only_the_same_ensemble_is_gone_on_with_and_another_program_is_told() {
    assert_eq!(resumed(&Session { realisations: 9, ..session(1) }), Ok(Vec::new()));
    let refused = |session: Session| resumed(&session).expect_err("refused");
    assert!(refused(session(2)).contains("seed is 1"));
    assert!(refused(Session { case_hash: "45".to_owned(), ..session(1) }).contains("another case"));
    assert!(refused(Session { schema_version: 99, ..session(1) }).contains("schema version"));
    assert!(refused(Session { shard: Shard { index: 1, of: 2 }, ..session(1) }).contains("shard 1/1"));
    let built = |build: Build| resumed(&Session { build, ..session(1) }).unwrap().join(" ");
    assert!(built(Build { fp_path: "fused".to_owned(), ..Build::current() }).contains("arithmetic"));
    assert!(built(Build { commit: "another".to_owned(), ..Build::current() }).contains("another"));
}

#[test]
fn a_folder_is_not_started_over_before_it_is_finished() {
    let (folder, bytes) = written();
    let open = |start| folder::open(folder.path(), &session(1), start).map(|(_, known, _)| known.done.len());
    assert_eq!(open(Start::New).unwrap(), 0);
    // the session that this has begun is not finished
    assert!(matches!(open(Start::New), Err(Problem::Refused(text)) if text.contains("--resume")));
    fs::write(folder.path().join(journal::NAME), &bytes).unwrap();
    assert_eq!(open(Start::Resume).unwrap(), 4);
    assert_eq!(open(Start::Fresh).unwrap(), 0);
}
