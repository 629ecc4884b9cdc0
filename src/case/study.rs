//! A study file: several ensembles of one case, each with some keys changed, side by side.

use std::collections::BTreeSet;

use serde::Serialize;

use super::cursor::Cursor;
use super::diagnostic::{Diagnostic, Diagnostics};
use super::keys::Keys;
use super::limits::{not_negative, signed};
use super::log::{Log, Problem};
use super::parse;
use super::source::Span;

/// Most arms of a study.
const MOST: usize = 100;

/// What is run side by side.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Study {
    pub title: String,
    /// The case file, as seen from the folder of the study file.
    pub case: String,
    /// Realisations of each arm. Default: those of the case.
    pub realisations: Option<u64>,
    /// Changes for all arms, `KEY=VALUE`.
    pub set: Vec<String>,
    pub arms: Vec<Arm>,
}

/// One ensemble of a study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Arm {
    /// Also the name of its folder.
    pub name: String,
    /// Arms of one group share their pictures. Default "".
    pub group: String,
    /// Changes, `KEY=VALUE`.
    pub set: Vec<String>,
    /// Realisations. Default: those of the study.
    pub realisations: Option<u64>,
    /// Whether RFEM runs on the same fields beside it. Default false.
    pub rfem: bool,
    /// What a source gives for the sliding distance (m).
    pub expect: Option<Expectation>,
}

/// A figure of a source.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Expectation {
    /// Mean of r (m).
    pub mean: Option<f64>,
    /// Standard deviation of r (m).
    pub sd: Option<f64>,
    pub source: String,
}

/// Reads a study file; `sets` change all arms, after the file's own changes.
///
/// # Errors
/// All errors of the file, sorted by position. The case and the changes are not read here.
pub fn read_study(name: &str, text: &str, sets: &[String]) -> Result<(Study, Vec<Diagnostic>), Diagnostics> {
    let log = Log::new(name, text, &[]);
    let study = parse::parse(&log, text, &[]).and_then(|root| {
        let mut keys = Keys::new(&log, String::new(), Span::new(0, 0..0), Some(&root));
        let study = study(&mut keys, sets);
        keys.finish();
        study
    });
    log.finish(study)
}

fn study(keys: &mut Keys<'_>, sets: &[String]) -> Option<Study> {
    let title = keys.or("title", "untitled".to_owned(), |c| c.text().map(str::to_owned));
    let case = keys.required("case", |c| c.text().map(str::to_owned));
    let realisations = keys.optional("realisations", |c| c.whole(2, 1_000_000));
    let set = keys.or("set", Vec::new(), texts);
    let arms = keys.required("arm", arms);
    let set = set?.into_iter().chain(sets.iter().cloned()).collect();
    Some(Study { title: title?, case: case?, realisations: realisations?, set, arms: arms? })
}

fn arms(cursor: &Cursor<'_>) -> Option<Vec<Arm>> {
    let cursors = cursor.list()?;
    if cursors.is_empty() || cursors.len() > MOST {
        let message = format!("there are {} arms", cursors.len());
        cursor.error(Problem::new(message, format!("must be from 1 to {MOST}")));
        return None;
    }
    // every arm is read, so that every error is found
    let found: Vec<_> = cursors.iter().map(|c| arm(c.table()?)).collect();
    let found: Vec<Arm> = found.into_iter().collect::<Option<_>>()?;
    let mut folders = BTreeSet::new();
    for (cursor, arm) in cursors.iter().zip(&found) {
        let mut own = std::iter::once(arm.folder()).chain(arm.rfem.then(|| arm.rfem_folder()));
        if let Some(folder) = own.find(|folder| !folders.insert(folder.clone())) {
            let message = format!("two arms would share the folder `{folder}`");
            cursor.error(Problem::new(message, "needs a name of its own"));
            return None;
        }
    }
    Some(found)
}

fn arm(mut keys: Keys<'_>) -> Option<Arm> {
    let name = keys.required("name", name);
    let group = keys.or("group", String::new(), |c| c.text().map(str::to_owned));
    let set = keys.or("set", Vec::new(), texts);
    let realisations = keys.optional("realisations", |c| c.whole(2, 1_000_000));
    let rfem = keys.or("rfem", false, |c| c.flag());
    let expect = keys.optional("expect", expectation);
    keys.finish();
    Some(Arm { name: name?, group: group?, set: set?, realisations: realisations?, rfem: rfem?, expect: expect? })
}

fn name(cursor: &Cursor<'_>) -> Option<String> {
    let text = cursor.text()?;
    let folder = folder_name(text);
    if folder.is_empty() {
        cursor.error(Problem::new("this name has no letter and no digit", "names the folder of the arm"));
        return None;
    }
    if [".json", ".md", ".csv", ".png"].iter().any(|file| folder.ends_with(file)) {
        cursor.error(Problem::new(
            "this name is that of a file",
            "names the folder of the arm, beside the files of the study",
        ));
        return None;
    }
    Some(text.to_owned())
}

fn texts(cursor: &Cursor<'_>) -> Option<Vec<String>> {
    let found: Vec<_> = cursor.list()?.iter().map(|c| c.text().map(str::to_owned)).collect();
    found.into_iter().collect()
}

fn expectation(cursor: &Cursor<'_>) -> Option<Expectation> {
    let mut keys = cursor.table()?;
    let mean = keys.optional("mean", |c| c.number(signed("m")));
    let sd = keys.optional("sd", |c| c.number(not_negative("m")));
    let source = keys.required("source", |c| c.text().map(str::to_owned));
    keys.finish();
    Some(Expectation { mean: mean?, sd: sd?, source: source? })
}

impl Arm {
    /// The name of its folder: letters, digits and points of the name, other stretches as a dash.
    pub fn folder(&self) -> String {
        folder_name(&self.name)
    }

    /// The name of the folder of RFEM beside it.
    pub fn rfem_folder(&self) -> String {
        self.folder() + "-rfem"
    }
}

/// A name as that of a folder: letters, digits and points of it, other stretches as a dash.
pub fn folder_name(name: &str) -> String {
    let kept = |c: char| c.is_ascii_alphanumeric() || c == '.';
    let parts = name.split(|c| !kept(c)).map(|part| part.trim_matches('.')).filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join("-").to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_study_is_read_with_its_arms() {
        let text = "case = \"a.toml\"\nset = [\"grid.cell=1\"]\n[[arm]]\nname = \"theta_h = 1.5 m\"\nrfem = true\nset = [\"field.s.theta_h=1.5\"]\nexpect = { mean = 9.43, source = \"Fig. 6\" }";
        let (study, _) = read_study("s", text, &["seed=2".to_owned()]).expect("a study");
        assert_eq!(study.set, ["grid.cell=1", "seed=2"]);
        assert_eq!((study.arms[0].folder().as_str(), study.arms[0].rfem), ("theta-h-1.5-m", true));
    }

    #[test]
    fn arms_need_names_and_folders_of_their_own() {
        let twice = "case = \"a.toml\"\n[[arm]]\nname = \"a b\"\n[[arm]]\nname = \"a-b\"";
        let beside = "case = \"a.toml\"\n[[arm]]\nname = \"a\"\nrfem = true\n[[arm]]\nname = \"a RFEM\"";
        let file = "case = \"a.toml\"\n[[arm]]\nname = \"study.json\"";
        let wrong = [(beside, "share the folder `a-rfem`"), (file, "that of a file"), (twice, "share the folder")];
        for (text, word) in wrong.into_iter().chain([("case = \"a.toml\"\n[[arm]]\nname = \"..\"", "no letter")]) {
            let errors = read_study("s", text, &[]).expect_err("refused").render(false);
            assert!(errors.contains(word), "{errors}");
        }
    }
}
