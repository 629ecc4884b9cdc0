//! Reading a case from the command line.

use std::{
    io::{IsTerminal, Read},
    path::PathBuf,
};

use super::Failure;
use crate::{
    case::{self, Case},
    output::record::Source,
    scene::{self, Fields, Scene},
};

/// Largest case file that is read (bytes).
const LARGEST: u64 = 1 << 20;

/// The case and what changes it.
#[derive(Debug, clap::Args)]
pub struct CaseArgs {
    /// Case file (TOML)
    pub case: PathBuf,
    /// Change a key for this run, e.g. --set material.clay.cohesion=18 (repeatable)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Integrator, short for --set solver.scheme=SCHEME: explicit or implicit
    #[arg(long)]
    pub scheme: Option<String>,
    /// Most memory a run may take, e.g. 500MB or 4GiB
    #[arg(long, value_name = "SIZE", default_value = "8GiB", value_parser = size)]
    pub max_memory: u64,
}

impl CaseArgs {
    /// Reads and checks the case; warnings go to standard error.
    pub fn read(&self) -> Result<(Case, Source), Failure> {
        let path = self.case.display().to_string();
        let text = read_text(&self.case)?;
        let color = std::io::stderr().is_terminal();
        let overrides = self.overrides();
        let (case, warnings) =
            case::read(&path, &text, &overrides).map_err(|errors| Failure::Input(errors.render(color)))?;
        for warning in &warnings {
            eprintln!("{}\n", warning.render(color));
        }
        Ok((case, Source { path, text, overrides, warnings }))
    }

    /// What the options change, `--scheme` last.
    pub fn overrides(&self) -> Vec<String> {
        let scheme = self.scheme.iter().map(|s| format!("solver.scheme={s}"));
        self.set.iter().cloned().chain(scheme).collect()
    }

    /// Builds the scene of a case.
    pub fn build(&self, case: &Case) -> Result<Scene, Failure> {
        self.build_reduced(case, 1.0)
    }

    /// The same with all strengths divided by `factor`.
    pub fn build_reduced(&self, case: &Case, factor: f64) -> Result<Scene, Failure> {
        let built = Fields::of(case).and_then(|fields| scene::build_reduced(case, self.max_memory, &fields, factor));
        built.map_err(|e| {
            let text = e.to_string();
            if e.too_large { Failure::Cap(text) } else { Failure::Input(text) }
        })
    }
}

pub fn read_text(path: &std::path::Path) -> Result<String, Failure> {
    let name = path.display().to_string();
    let fail = |e: std::io::Error| match e.kind() {
        std::io::ErrorKind::InvalidData => Failure::Input(format!("{name}: not a text file (UTF-8)")),
        _ => Failure::io(&name, &e),
    };
    let meta = std::fs::metadata(path).map_err(fail)?;
    if !meta.is_file() {
        return Err(Failure::Input(format!("{name}: not a regular file")));
    }
    if meta.len() > LARGEST {
        return Err(Failure::Input(format!("{name}: larger than 1 MiB; a case file is a few kB")));
    }
    let mut text = String::new();
    std::fs::File::open(path).and_then(|f| f.take(LARGEST).read_to_string(&mut text)).map_err(fail)?;
    Ok(text)
}

/// A size with an optional unit: B, kB, MB, GB, KiB, MiB, GiB.
pub fn size(text: &str) -> Result<u64, String> {
    let digits = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let number: f64 = number.trim().parse().map_err(|_| format!("'{text}' is no size; try 4GiB"))?;
    let factor = match unit.trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "kib" => 1024.0,
        "mib" => 1024.0 * 1024.0,
        "gib" => 1024.0 * 1024.0 * 1024.0,
        _ => return Err(format!("unknown unit '{unit}'; use B, kB, MB, GB, KiB, MiB or GiB")),
    };
    let bytes = number * factor;
    if bytes.is_finite() && bytes >= 0.0 { Ok(bytes as u64) } else { Err(format!("'{text}' is no size")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("4GiB"), Ok(4 << 30));
        assert_eq!(size("1.5 MB"), Ok(1_500_000));
        assert_eq!(size("100"), Ok(100));
        assert!(size("much").is_err() && size("3 apples").is_err() && size("-1").is_err());
    }
}
