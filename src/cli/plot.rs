//! `rmpm plot`.

use std::{
    io,
    path::{Path, PathBuf},
};

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
    #[arg(
        long,
        value_delimiter = ',',
        num_args = 1,
        value_name = "LOW,HIGH",
        allow_hyphen_values = true,
        requires = "field"
    )]
    range: Vec<f64>,
    /// Picture to write; DIR/pictures/FIELD.png without it
    #[arg(long, short, requires = "field")]
    out: Option<PathBuf>,
    /// Width of the picture (pixels); 1600 without it
    #[arg(long, requires = "field", value_parser = clap::value_parser!(u32).range(200..=8000))]
    width: Option<u32>,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let read = |e: io::Error| Failure::io(&args.dir.display().to_string(), &e);
    let mut case = resolved(&args.dir)?;
    if args.time.iter().any(|t| !t.is_finite()) || args.time.len() > 64 {
        return Err(Failure::Input("--time takes at most 64 numbers (s)".to_owned()));
    }
    if !args.time.is_empty() {
        case.output.pictures = args.time.clone();
    }
    let frames = vtk::read_pvd(&args.dir.join("run.pvd")).map_err(read)?;
    if frames.is_empty() {
        return Err(Failure::Io(format!("{}: run.pvd lists no frame; there is nothing to draw", args.dir.display())));
    }
    if let Some((_, name)) = frames.iter().find(|(_, name)| !local(name)) {
        return Err(Failure::Io(format!(
            "{}: run.pvd names '{name}', which is outside the folder",
            args.dir.display()
        )));
    }
    let rows = history::read(&args.dir.join("history.csv")).map_err(read)?;
    let Some(kind) = args.field.as_deref().and_then(FieldKind::parse) else {
        std::fs::create_dir_all(args.dir.join("pictures")).map_err(read)?;
        return pictures::draw(&args.dir, &case, &rows, &frames, began(&args.dir)).map_err(read);
    };
    let chosen = pictures::choose(&frames, &case.output.pictures, pictures::onset(&rows));
    let snapshots = pictures::load(&args.dir, &frames, &chosen).map_err(read)?;
    let views: Vec<&Snapshot> = snapshots.iter().collect();
    let mut options = pictures::options(&case, kind);
    options.range = range(&args.range)?.or_else(|| pictures::range(&case, kind));
    options.width = args.width.unwrap_or(options.width);
    options.dimensions = pictures::distance(&case, &rows, &views);
    let name = args.out.clone().unwrap_or_else(|| args.dir.join("pictures").join(format!("{}.png", kind.name())));
    plot::field(&name, &views, &options).map_err(|e| Failure::io(&name.display().to_string(), &e))?;
    eprintln!("wrote {}", name.display());
    Ok(())
}

/// Whether a frame's file lies inside the run's folder.
fn local(name: &str) -> bool {
    Path::new(name).components().all(|c| matches!(c, std::path::Component::Normal(_)))
}

/// The case that a run left in its folder.
fn resolved(dir: &Path) -> Result<Case, Failure> {
    let path = dir.join("case.toml");
    let name = path.display().to_string();
    let text = std::fs::read_to_string(&path).map_err(|e| Failure::io(&name, &e))?;
    case::read(&name, &text, &[]).map(|(case, _)| case).map_err(|e| Failure::Input(e.render(false)))
}

/// The onset of failure that the record of a run tells (s); a run under way or cut short has none yet.
fn began(dir: &Path) -> Option<f64> {
    let text = std::fs::read_to_string(dir.join("record.json")).ok()?;
    let record: serde_json::Value = serde_json::from_str(&text).ok()?;
    record.pointer("/measures/onset_time_s")?.as_f64()
}

fn range(ends: &[f64]) -> Result<Option<(f64, f64)>, Failure> {
    match *ends {
        [] => Ok(None),
        [low, high] if low < high && low.is_finite() && high.is_finite() => Ok(Some((low, high))),
        _ => Err(Failure::Input("--range takes two numbers, low and high, e.g. --range 0,0.32".to_owned())),
    }
}
