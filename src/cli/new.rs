//! `rmpm new`.

use std::{io::Write, path::PathBuf};

use super::{Failure, exit::print};
use crate::case;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Which case
    #[arg(value_parser = clap::builder::PossibleValuesParser::new(case::TEMPLATES))]
    template: String,
    /// File to write; printed on standard output without it
    #[arg(long, short)]
    out: Option<PathBuf>,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let text = case::template(&args.template).unwrap_or_default();
    let Some(path) = &args.out else {
        return print(text);
    };
    let mut options = std::fs::File::options();
    let file = options.write(true).create_new(true).open(path);
    file.and_then(|mut f| f.write_all(text.as_bytes())).map_err(|e| Failure::io(&path.display().to_string(), &e))?;
    eprintln!("wrote {}; run it with: rmpm solve {}", path.display(), path.display());
    Ok(())
}
