//! The program from outside: commands, how they end, and what they leave.

use std::{
    fs,
    path::{Path, PathBuf},
};

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

/// The paper's slope as a file.
pub const SLOPE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/clay-slope.toml");

/// The paper's slope in cells of 0.5 m up to its first block: 1820 points, well under a second.
pub const COARSE: &[&str] =
    &["grid.cell=0.5", "end.time=6", "output.frames=1", "output.history=0.1", "output.pictures=[0,6]"];

/// `rmpm` with arguments.
pub fn rmpm(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rmpm"));
    command.args(args);
    command
}

/// `rmpm VERB CASE --set ...` on the coarse slope.
pub fn coarse(verb: &str) -> Command {
    let mut command = rmpm(&[verb, SLOPE]);
    COARSE.iter().for_each(|set| {
        command.args(["--set", set]);
    });
    command
}

/// Standard output and standard error of a command that ends with `code`.
#[track_caller]
pub fn ends(mut command: Command, code: i32) -> (String, String) {
    let assert = command.assert().code(code);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("text");
    (text(&assert.get_output().stdout), text(&assert.get_output().stderr))
}

/// A JSON file.
pub fn json(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).expect("JSON")
}

/// A folder that goes away with the first, and one in it for a run.
pub fn folder() -> (TempDir, PathBuf) {
    let root = tempfile::tempdir().expect("a folder");
    let out = root.path().join("run");
    (root, out)
}

/// Values at places of a document: numbers, texts and so on, by a letter.
#[track_caller]
pub fn has(value: &Value, keys: &[(&str, char)]) {
    for (pointer, kind) in keys {
        let found = value.pointer(pointer).unwrap_or_else(|| panic!("{pointer} is missing"));
        let fits = match kind {
            's' => found.is_string(),
            'n' => found.is_number(),
            'b' => found.is_boolean(),
            'a' => found.is_array(),
            'o' => found.is_object(),
            _ => found.is_null(),
        };
        assert!(fits, "{pointer} is {found}, not {kind}");
    }
}
