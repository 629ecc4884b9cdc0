//! Notes the commit and the compiler for the record of a run.

use std::process::Command;

fn main() {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    println!("cargo:rustc-env=RMPM_RUSTC={}", say(Command::new(rustc).arg("--version")));
    println!("cargo:rustc-env=RMPM_COMMIT={}", say(Command::new("git").args(["rev-parse", "--short=12", "HEAD"])));
    println!("cargo:rerun-if-changed=.git/HEAD");
    println!("cargo:rerun-if-changed=.git/logs/HEAD");
    println!("cargo:rerun-if-changed=build.rs");
}

/// The first line that a command prints, or "unknown".
fn say(command: &mut Command) -> String {
    let output = command.output().ok().filter(|o| o.status.success());
    let text = output.and_then(|o| String::from_utf8(o.stdout).ok()).unwrap_or_default();
    text.lines().next().filter(|l| !l.is_empty()).unwrap_or("unknown").to_owned()
}
