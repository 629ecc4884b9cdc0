//! `rmpm plot`.

use std::{io, path::{Path, PathBuf}};

use super::Failure;
use crate::{
    case::{self, Case},
    output::{
        history, pictures,
        plot::{self, FieldKind},
        vtk,
    },
    snapshot::Snapshot,
};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder of a run
    dir: PathBuf,
    /// Draw this field; all pictures of the run without it
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(FieldKind::names()))]
    field: Option<String>,
    /// Times (s), the nearest frames are drawn; six over the run without it
    #[arg(long, value_delimiter = ',', value_name = "S,S,...")]
    time: Vec<f64>,
    /// Ends of the colour scale
    #[arg(long, value_delimiter = ',', num_args = 1, value_name = "LOW,HIGH", allow_hyphen_values = true)]
    range: Vec<f64>,
    /// Picture to write; DIR/pictures/FIELD.png without it
    #[arg(long, short, requires = "field")]
    out: Option<PathBuf>,
    /// Width of the picture (pixels)
    #[arg(long, default_value_t = 1600, value_parser = clap::value_parser!(u32).range(200..=8000))]
    width: u32,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let read = |e: io::Error| Failure::io(&args.dir.display().to_string(), &e);
    let mut case = resolved(&args.dir)?;
    if !args.time.is_empty() {
        case.output.pictures = args.time.clone();
    }
    let frames = vtk::read_pvd(&args.dir.join("run.pvd")).map_err(read)?;
    let rows = history::read(&args.dir.join("history.csv")).map_err(read)?;
    let Some(kind) = args.field.as_deref().and_then(FieldKind::parse) else {
        std::fs::create_dir_all(args.dir.join("pictures")).map_err(read)?;
        return pictures::draw(&args.dir, &case, &rows, &frames).map_err(read);
    };
    let chosen = pictures::choose(&frames, &case.output.pictures, pictures::onset(&rows));
    let snapshots = pictures::load(&args.dir, &frames, &chosen).map_err(read)?;
    let views: Vec<&Snapshot> = snapshots.iter().collect();
    let mut options = pictures::options(&case, kind);
    options.range = range(&args.range)?.or_else(|| pictures::range(&case, kind));
    options.width = args.width;
    let name = args.out.clone().unwrap_or_else(|| args.dir.join("pictures").join(format!("{}.png", kind.name())));
    plot::field(&name, &views, &options).map_err(|e| Failure::io(&name.display().to_string(), &e))?;
    eprintln!("wrote {}", name.display());
    Ok(())
}

/// The case that a run left in its folder.
fn resolved(dir: &Path) -> Result<Case, Failure> {
    let path = dir.join("case.toml");
    let name = path.display().to_string();
    let text = std::fs::read_to_string(&path).map_err(|e| Failure::io(&name, &e))?;
    case::read(&name, &text, &[]).map(|(case, _)| case).map_err(|e| Failure::Input(e.render(false)))
}

fn range(ends: &[f64]) -> Result<Option<(f64, f64)>, Failure> {
    match *ends {
        [] => Ok(None),
        [low, high] if low < high => Ok(Some((low, high))),
        _ => Err(Failure::Input("--range takes two numbers, low and high, e.g. --range 0,0.32".to_owned())),
    }
}
