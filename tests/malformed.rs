//! What the program says about malformed cases: each `malformed/NAME.toml` with its message in
//! `malformed/NAME.txt`. With RMPM_REWRITE set the messages are written anew, to be read before
//! they are committed.

use std::path::{Path, PathBuf};

use proptest::prelude::*;
use rmpm::case::{read, template};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/malformed")
}

fn rendered(name: &str, text: &str, overrides: &[&str]) -> String {
    let overrides: Vec<_> = overrides.iter().map(|text| (*text).to_owned()).collect();
    match read(name, text, &overrides) {
        Ok(_) => panic!("{name} is accepted"),
        Err(errors) => format!("{}\n", errors.render(false)),
    }
}

#[test]
fn malformed_cases_have_their_messages() {
    let files = std::fs::read_dir(folder()).expect("the folder of malformed cases");
    let mut cases: Vec<_> = files.map(|file| file.expect("a file").path()).collect();
    cases.retain(|path| path.extension().is_some_and(|end| end == "toml"));
    assert!(cases.len() >= 30);
    for path in cases {
        let name = path.file_name().and_then(|name| name.to_str()).expect("a name");
        let found = rendered(name, &std::fs::read_to_string(&path).expect("a case"), &[]);
        let pinned = path.with_extension("txt");
        if std::env::var_os("RMPM_REWRITE").is_some() {
            std::fs::write(&pinned, &found).expect("a message is written");
        }
        assert_eq!(found, std::fs::read_to_string(&pinned).unwrap_or_default(), "{name}");
    }
}

const SLOPE: &str = include_str!("../cases/clay-slope.toml");

#[test]
fn overrides_are_checked_as_the_file_is() {
    assert_eq!(
        rendered("slope.toml", SLOPE, &["material.clay.cohesin=18"]),
        "\
error: unknown key `material.clay.cohesin`
 --> --set:1:15
  |
1 | material.clay.cohesin=18
  |               ^^^^^^^ `material.clay` with \"von_mises\" takes law, unit_weight, density, young_modulus, poisson_ratio, cohesion, residual_cohesion, softening_modulus, yield_constant, strength_measure, regularisation, reference_length, nonlocal_weight
  |
  = help: did you mean `cohesion`?
"
    );
}

#[test]
fn an_override_without_a_value_is_refused() {
    assert_eq!(
        rendered("slope.toml", SLOPE, &["grid.cell"]),
        "\
error: this sets nothing
 --> --set:1:1
  |
1 | grid.cell
  | ^^^^^^^^^ must be path=value
  |
  = help: for example --set material.clay.cohesion=18
"
    );
}

#[test]
fn an_override_of_no_region_or_of_a_number_is_refused() {
    let sets = ["region.slop.velocity=[1,0]", "grid.cell.x=1", "grid.size=[1,", "grid.cell=5/0"];
    assert_eq!(
        rendered("slope.toml", SLOPE, &sets),
        "\
error: `region` has no item `slop`
 --> --set:1:8
  |
1 | region.slop.velocity=[1,0]
  |        ^^^^ it has the items 0 to 0
  |
  = help: did you mean `slope`?

error: `cell` is a number, not a table
 --> --set:1:6
  |
1 | grid.cell.x=1
  |      ^^^^ has no keys below it

error: this value is not valid TOML
 --> --set:1:11
  |
1 | grid.size=[1,
  |           ^^^ unclosed array, expected `]`

error: `grid.cell` is not a finite number
 --> --set:1:11
  |
1 | grid.cell=5/0
  |           ^^^ must be between 1e-9 and 1e12 m
"
    );
}

/// Text with some of its bytes changed, dropped or doubled.
fn mutated(text: &str, changes: &[(usize, u8, u8)]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for &(at, kind, byte) in changes {
        let at = at % bytes.len().max(1);
        match kind {
            _ if bytes.is_empty() => bytes.push(byte),
            0 => bytes[at] = byte,
            1 => drop(bytes.remove(at)),
            2 => bytes.insert(at, byte),
            _ => bytes.truncate(at.max(1)),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The templates without their comments, so that most changes hit a key or a value.
fn bare(name: &str) -> String {
    let text = template(name).expect("a template");
    text.lines().map(|line| line.split('#').next().unwrap_or("").trim_end().to_owned() + "\n").collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_bytes_never_panic(
        which in 0..3usize,
        changes in prop::collection::vec((any::<usize>(), 0..40u8, any::<u8>()), 1..6))
    {
        let kinds = changes.iter().map(|&(at, kind, byte)| {
            // Truncation is rare; most bytes are those that TOML is made of.
            let byte = if byte > 140 { b"0123456789.-+e\"'[]{}=,#\n abc"[byte as usize % 28] } else { byte };
            (at, if kind == 39 { 3 } else { kind % 3 }, byte)
        });
        let text = mutated(&bare(["slope", "bar", "incline"][which]), &kinds.collect::<Vec<_>>());
        if let Err(errors) = read("mutated.toml", &text, &[]) {
            prop_assert!(!errors.errors().is_empty());
            prop_assert!(!errors.render(true).is_empty());
        }
    }

    #[test]
    fn any_override_never_panics(set in "[a-z0-9.\"=\\[\\]{} ]{0,30}", tail in "\\PC{0,10}") {
        let keys = ["", "grid.cell", "region.0.polygon", "boundary.base", "material.clay."];
        for key in keys {
            if let Err(errors) = read("slope.toml", SLOPE, &[format!("{key}{set}={tail}")]) {
                prop_assert!(!errors.render(false).is_empty() && !errors.errors().is_empty());
            }
        }
    }
}
