//! The one-way order of the modules: a module imports only what stands before it.
//!
//! The list below is the architecture; a new module is placed in it in the commit that adds it.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Top modules, lowest first. `measure` stands above `case` and reads its `Slide` keys.
const ORDER: [&str; 26] = [
    "fault",
    "work",
    "math",
    "case",
    "material",
    "kinematics",
    "space",
    "field",
    "block",
    "snapshot",
    "body",
    "domain",
    "nodes",
    "seed",
    "system",
    "assembly",
    "transfer",
    "effect",
    "step",
    "sim",
    "scene",
    "measure",
    "run",
    "output",
    "study",
    "cli",
];

/// Modules above this one may read a case; those below it, `case` itself apart, may not.
const FIRST_THAT_READS_CASES: &str = "scene";

/// One `crate::x` in a file.
#[derive(Debug)]
struct Import {
    line: usize,
    module: String,
}

fn rank(module: &str) -> Option<usize> {
    ORDER.iter().position(|m| *m == module)
}

/// What is wrong with the imports of a file of `module`.
fn violations(module: &str, file: &str, text: &str) -> Vec<String> {
    let Some(own) = rank(module) else {
        return vec![format!("{file}: module `{module}` has no place in ORDER of tests/floors.rs")];
    };
    let reads_cases = rank(FIRST_THAT_READS_CASES).is_some_and(|r| own >= r) || module == "case";
    let mut found = Vec::new();
    for import in imports(text) {
        let place = format!("{file}:{}: `{module}` imports `{}`", import.line, import.module);
        match rank(&import.module) {
            Some(r) if r > own => found.push(format!("{place}, which stands above it")),
            Some(_) if import.module == "case" && !reads_cases => {
                found.push(format!("{place}: nothing below `{FIRST_THAT_READS_CASES}` knows a case file"));
            }
            Some(_) => {}
            None => found.push(format!("{place}, which has no place in ORDER")),
        }
    }
    found
}

/// Every `crate::x`, and every branch of `crate::{x, y::z}`, outside comments and test modules.
fn imports(text: &str) -> Vec<Import> {
    let code = without_tests(&without_comments(text));
    let mut found = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        // `$crate::` and `my_crate::` are no paths of ours
        if code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '$') {
            continue;
        }
        let rest = &code[at + "crate::".len()..];
        for (offset, name) in heads(rest) {
            let line = 1 + code[..at + "crate::".len() + offset].matches('\n').count();
            found.push(Import { line, module: name });
        }
    }
    found
}

/// First names of a path or of the branches of a group, with their places.
fn heads(rest: &str) -> Vec<(usize, String)> {
    if !rest.starts_with('{') {
        return name_at(rest, 0).into_iter().collect();
    }
    let (mut depth, mut found, mut expect) = (0, Vec::new(), false);
    for (i, c) in rest.char_indices() {
        match c {
            '{' => {
                depth += 1;
                expect = depth == 1;
            }
            '}' => {
                depth -= 1;
                if depth == 0 {
                    break;
                }
            }
            ',' => expect = depth == 1,
            c if c.is_whitespace() => {}
            _ if expect => {
                found.extend(name_at(rest, i));
                expect = false;
            }
            _ => {}
        }
    }
    found
}

fn name_at(text: &str, at: usize) -> Option<(usize, String)> {
    let name: String = text[at..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    // an upper case head is an item of the crate root, and there is none
    (!name.is_empty()).then_some((at, name))
}

/// The text with comments and literals blanked, lines kept.
fn without_comments(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut chars = text.chars().peekable();
    let (mut in_line, mut in_block, mut in_text) = (false, false, false);
    while let Some(c) = chars.next() {
        let next = chars.peek().copied();
        match c {
            '\n' => in_line = false,
            '*' if in_block && next == Some('/') => {
                chars.next();
                in_block = false;
                continue;
            }
            _ if in_line || in_block => continue,
            '\\' if in_text => {
                out.extend(chars.next().filter(|&c| c == '\n'));
                continue;
            }
            '"' => {
                in_text = !in_text;
                continue;
            }
            _ if in_text => continue,
            // the character literals that would look like the start of a text
            '\'' if next == Some('"') || (next == Some('\\')) => {
                let body = chars.next();
                let last = if body == Some('\\') { chars.nth(1) } else { chars.next() };
                debug_assert!(last.is_some());
                continue;
            }
            '/' if next == Some('/') => {
                in_line = true;
                continue;
            }
            '/' if next == Some('*') => {
                in_block = true;
                continue;
            }
            _ => {}
        }
        out.push(c);
    }
    out
}

/// The text with what stands behind `#[cfg(test)]` blanked: an item in braces or up to `;`.
fn without_tests(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find("#[cfg(test)]") {
        out.push_str(&rest[..at]);
        let item = &rest[at..];
        let end = item_end(item);
        out.extend(item[..end].chars().filter(|&c| c == '\n'));
        rest = &item[end..];
    }
    out + rest
}

fn item_end(item: &str) -> usize {
    let mut depth = 0;
    for (i, c) in item.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 1 => return i + 1,
            '}' => depth -= 1,
            ';' if depth == 0 => return i + 1,
            _ => {}
        }
    }
    item.len()
}

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The top module of a file; `None` for the roots of library and binary.
fn module_of(path: &Path) -> Option<String> {
    let top = path.strip_prefix(source()).unwrap().components().next().unwrap();
    let name = Path::new(top.as_os_str()).file_stem().unwrap().to_string_lossy().into_owned();
    (!matches!(name.as_str(), "lib" | "main")).then_some(name)
}

#[test]
fn modules_import_only_what_stands_before_them() {
    let mut paths = Vec::new();
    files(&source(), &mut paths);
    assert!(paths.len() > 20, "only {} files in src", paths.len());
    let (mut found, mut seen) = (Vec::new(), 0);
    for path in &paths {
        let Some(module) = module_of(path) else { continue };
        let text = fs::read_to_string(path).unwrap();
        let name = path.strip_prefix(env!("CARGO_MANIFEST_DIR")).unwrap().display().to_string();
        seen += imports(&text).len();
        found.extend(violations(&module, &name, &text));
    }
    assert!(seen > 80, "only {seen} imports found: the parser is blind");
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn a_violation_is_found_with_its_line() {
    let text = "//! crate::scene is only spoken of.\nuse crate::{\n    body::Body,\n    step::{Books, control::Control},\n};\n";
    let found = violations("assembly", "src/assembly.rs", text);
    assert_eq!(found, ["src/assembly.rs:4: `assembly` imports `step`, which stands above it"]);
}

#[test]
fn a_path_inside_a_function_counts_and_a_test_module_does_not() {
    let text =
        "fn f() { let x = crate::sim::X; }\n#[cfg(test)]\nmod tests {\n    use crate::cli::Y;\n}\nuse crate::run::Z;\n";
    let found = violations("body", "src/body.rs", text);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].starts_with("src/body.rs:1:") && found[1].starts_with("src/body.rs:6:"));
}

#[test]
fn a_case_below_the_scene_is_found() {
    let found = violations("step", "src/step/mod.rs", "use crate::case::Case;\n");
    assert_eq!(found, ["src/step/mod.rs:1: `step` imports `case`: nothing below `scene` knows a case file"]);
    assert!(violations("measure", "src/measure/mod.rs", "use crate::case::Slide;\n").is_empty());
}

#[test]
fn a_module_without_a_place_is_found() {
    assert_eq!(violations("water", "src/water.rs", "").len(), 1);
    assert_eq!(violations("run", "src/run/mod.rs", "use crate::water::Level;\n").len(), 1);
}

#[test]
fn texts_and_comments_are_no_imports() {
    let text = "let a = \"use crate::cli\"; let q = '\"'; /* crate::cli */ // crate::cli\nuse crate::fault::Fault;\n";
    let found = imports(text);
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].line, found[0].module.as_str()), (2, "fault"));
}
