//! `rmpm merge`.

use std::path::PathBuf;

use super::{
    Failure,
    ensemble::{failure, failures, note, say},
};
use crate::{
    output::folder,
    study::ensemble::{Start, merge},
};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folders of the shards
    #[arg(required = true, value_name = "DIR")]
    shards: Vec<PathBuf>,
    /// Folder for the whole
    #[arg(long, short)]
    out: PathBuf,
    /// Write over an ensemble that is not finished
    #[arg(long)]
    fresh: bool,
    /// Print {summary, timing} as JSON on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let place = args.out.display().to_string();
    let real = |path: &PathBuf| path.canonicalize().ok();
    if real(&args.out).is_some_and(|out| args.shards.iter().any(|shard| real(shard).as_ref() == Some(&out))) {
        return Err(Failure::Input(format!("--out: '{place}' is one of the shards; choose a folder of its own")));
    }
    let shards = merge::read(&args.shards).map_err(|e| failure("the shards", e))?;
    shards.notes.iter().for_each(|text| note(text));
    let _lock = folder::claim(&args.out).map_err(|e| Failure::io(&place, &e))?;
    let start = if args.fresh { Start::Fresh } else { Start::New };
    let ended = merge::write(&shards, &args.out, start).map_err(|e| failure(&place, e))?;
    say(&ended, args.json, &place)?;
    failures(ended.results.failed())
}
