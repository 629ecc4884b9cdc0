//! `rmpm field`.

use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
};

use serde_json::{Value, json};

use super::{Failure, exit::print, input::CaseArgs};
use crate::{
    case::{Case, Parameter},
    field::model::Drawn,
    output::{
        field::{CellField, write_csv, write_npy, write_vti},
        folder,
        plot::{self, CellsOptions},
        record::{Build, SCHEMA_VERSION, Source, sha256},
    },
    scene::{Fields, SceneError, fields::trend as trend_at},
    study::fields::{self, FieldReport},
};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    case: CaseArgs,
    /// Realisations to draw
    #[arg(short, default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    n: u64,
    /// The first of them; ensemble.realisation without it
    #[arg(long)]
    realisation: Option<u64>,
    /// Files to leave of each realisation
    #[arg(long, value_delimiter = ',', value_name = "LIST", default_value = "csv,vti,npy,png")]
    formats: Vec<Format>,
    /// Folder for the files; out/<name of the case>-field without it
    #[arg(long, short)]
    out: Option<PathBuf>,
    /// Print {record, timing} as JSON on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    Csv,
    Vti,
    Npy,
    Png,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let (mut case, source) = args.case.read()?;
    if case.field.is_empty() {
        return Err(Failure::Input(format!("{}: there is no [field.NAME] in this case", source.path)));
    }
    case.ensemble.realisation = args.realisation.unwrap_or(case.ensemble.realisation);
    let refused = |e: SceneError| Failure::Input(e.to_string());
    let made = Fields::of(&case).map_err(refused)?;
    let out = args.out.clone().unwrap_or_else(|| default_out(&args.case));
    let write = |e: io::Error| Failure::io(&out.display().to_string(), &e);
    let _lock = folder::claim(&out).map_err(write)?;
    clear(&out).map_err(write)?;
    let (mut reports, mut timing) = (Vec::new(), BTreeMap::new());
    for model in made.models() {
        fits(args, model.lattice.len())?;
        let draws = fields::draw(&case, model, case.ensemble.realisation, args.n).map_err(refused)?;
        let report = fields::report(&case, &made, &model.name, case.ensemble.realisation, &draws.drawn);
        let report =
            report.ok_or_else(|| Failure::Input(format!("field.{}: its parameter has no mean", model.name)))?;
        leave(&out, args, &case, &report, &draws.drawn).map_err(write)?;
        timing.insert(model.name.clone(), draws.ms_per_field);
        reports.push(report);
    }
    let record = record(&case, &source, &reports);
    let timing = json!({ "ms_per_field": timing });
    write_json(&out.join("field.json"), &record).map_err(write)?;
    write_json(&out.join("field_timing.json"), &timing).map_err(write)?;
    if args.json {
        return print(&format!("{}\n", json!({ "record": record, "timing": timing })));
    }
    print(&format!("{}left in {}\n", fields::table(&reports), out.display()))
}

/// # Errors
/// Realisations that take more memory than is allowed.
fn fits(args: &Args, cells: usize) -> Result<(), Failure> {
    /// Bytes a value: as drawn, as written, and sorted for the colour scale, with some room.
    const BYTES: u64 = 32;
    let need = (cells as u64).saturating_mul(args.n).saturating_mul(BYTES);
    if need <= args.case.max_memory {
        return Ok(());
    }
    let text = format!(
        "{} realisations of {cells} cells take {need} bytes, --max-memory allows {}",
        args.n, args.case.max_memory
    );
    Err(Failure::Cap(text))
}

fn default_out(input: &CaseArgs) -> PathBuf {
    let stem = input.case.file_stem().unwrap_or_default().to_string_lossy();
    PathBuf::from("out").join(format!("{stem}-field"))
}

/// Removes what an earlier `rmpm field` left, and nothing else.
fn clear(out: &Path) -> io::Result<()> {
    for entry in fs::read_dir(out)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let kind = path.extension().unwrap_or_default().to_string_lossy();
        let ours = name.starts_with("field-") && ["csv", "vti", "npy", "png"].contains(&&*kind);
        if ours || name == "field.json" || name == "field_timing.json" {
            fs::remove_file(&path)?;
        }
    }
    Ok(())
}

fn record(case: &Case, source: &Source, reports: &[FieldReport]) -> Value {
    json!({
        "schema_version": SCHEMA_VERSION,
        "build": Build::current(),
        "units": "kN, m, s, t",
        "case_hash": sha256(case.to_toml().as_bytes()),
        "inputs": [{ "path": source.path, "sha256": sha256(source.text.as_bytes()) }],
        "overrides": source.overrides,
        "title": case.title,
        "seed": case.seed,
        "fields": reports,
    })
}

fn write_json(path: &Path, value: &Value) -> io::Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(io::Error::other)?;
    folder::write_text(path, &(text + "\n"))
}

/// The files of all realisations: values of the first parameter, in one colour scale.
fn leave(out: &Path, args: &Args, case: &Case, report: &FieldReport, drawn: &[Drawn]) -> io::Result<()> {
    let Some((parameter, field)) = report.parameters.first().zip(case.field.get(&report.name)) else { return Ok(()) };
    let trend = |row: usize| trend_at(field, report.origin_m[1] + (row as f64 + 0.5) * report.cell_m[1]);
    let values = |d: &Drawn| -> Vec<f64> {
        let rows = d.factors.chunks(report.cells[0].max(1)).enumerate();
        rows.flat_map(|(j, row)| row.iter().map(move |f| report.mean * trend(j) * f)).collect()
    };
    if args.formats.contains(&Format::Png) {
        let path = out.join(format!("field-{}-profile.png", file_name(&report.name)));
        fields::profile(&path, report, &|y| trend_at(field, y), drawn)?;
    }
    let all: Vec<f64> = drawn.iter().flat_map(values).collect();
    let mut options = options(case, report, *parameter, plot::range(&all));
    for (values, k) in all.chunks(report.cells[0] * report.cells[1]).zip(&report.realisations) {
        let cells = CellField {
            name: parameter.word(),
            unit: report.unit,
            origin: report.origin_m,
            cell: report.cell_m,
            cells: report.cells,
            values,
        };
        let [th, tv] = report.theta_m;
        options.caption = format!("field {}, realisation {k}: θh = {th} m, θv = {tv} m", report.name);
        for format in &args.formats {
            let path = |kind: &str| out.join(format!("field-{}-{k}.{kind}", file_name(&report.name)));
            match format {
                Format::Csv => write_csv(&path("csv"), &cells)?,
                Format::Vti => write_vti(&path("vti"), &cells)?,
                Format::Npy => write_npy(&path("npy"), &cells)?,
                Format::Png => plot::cells(&path("png"), &cells, &options)?,
            }
        }
    }
    Ok(())
}

fn options(case: &Case, report: &FieldReport, parameter: Parameter, range: (f64, f64)) -> CellsOptions {
    let soil = case.region.iter().filter(|r| r.material == report.material);
    let unit = if report.unit.is_empty() { "-" } else { report.unit };
    CellsOptions {
        title: case.title.clone(),
        caption: String::new(),
        legend: format!("{} ({unit})", parameter.word().replace('_', " ")),
        range: Some(range),
        outlines: soil.map(|r| r.shape.corners()).collect(),
        width: 1600,
    }
}

/// The name of a field as part of a file name: what is no letter, digit, `-` or `_` becomes %XX.
fn file_name(name: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b == b'-' || b == b'_';
    name.bytes().map(|b| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_fields_stay_in_their_folder_and_apart() {
        assert_eq!(file_name("c_u-1"), "c_u-1");
        assert_eq!(file_name("../a b"), "%2E%2E%2Fa%20b");
        assert_ne!(file_name("a%2F"), file_name("a/"));
    }
}
