//! What the documents promise is there.

use std::{fs, path::Path};

fn read(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    fs::read_to_string(&path).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn the_architecture_lists_the_modules_in_their_order() {
    let library = read("src/lib.rs");
    let modules: Vec<&str> = library.lines().filter_map(|l| l.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
    let page = read("ARCHITECTURE.md");
    let floors = page.split("## ").find(|part| part.starts_with("Floors")).expect("the floors");
    let listed: Vec<&str> = floors.lines().filter_map(|l| l.strip_prefix("| `")?.split('`').next()).collect();
    assert_eq!(listed, modules);
}

#[test]
fn links_lead_somewhere() {
    for page in ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"] {
        let text = read(page);
        let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        for link in links.filter(|link| !link.starts_with("http")) {
            assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join(link).exists(), "{page}: {link}");
        }
    }
}

/// Names of files in backquotes, such as `scene/effects.rs`, in the page that says where things go.
#[test]
fn the_architecture_names_files_that_exist() {
    let page = read("ARCHITECTURE.md");
    let named = page.split('`').skip(1).step_by(2).filter(|name| name.ends_with(".rs") && !name.contains("NAME"));
    for name in named {
        let name = name.strip_prefix("src/").unwrap_or(name);
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        assert!(root.join("src").join(name).exists() || root.join(name).exists(), "{name}");
    }
}
