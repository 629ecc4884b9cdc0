//! `ensemble.csv`, which depends on the case alone, and `ensemble_timing.csv`, which does not.

use std::io;

use super::{
    measures,
    results::Results,
    row::{Done, counters},
};
use crate::work::Work;

/// A row a realisation, in order: how it ended, its measures, its work. What is not there is empty.
///
/// # Errors
/// Those of the writer.
pub fn csv(results: &Results) -> io::Result<String> {
    let measures: Vec<String> = measures::list(&results.case).into_iter().map(|m| m.name).collect();
    let work: Vec<String> = counters(&Work::default(), &[]).into_keys().collect();
    let mut writer = csv::Writer::from_writer(Vec::new());
    let head = ["realisation", "seed", "antithetic", "status", "fault"].map(str::to_owned);
    writer.write_record(head.iter().chain(&measures).chain(&work))?;
    for (k, Done { row, .. }) in &results.rows {
        let numbers = measures.iter().map(|name| row.measures.get(name));
        let numbers = numbers.chain(work.iter().map(|name| row.work.get(name)));
        let numbers: Vec<String> = numbers.map(|v| v.map(f64::to_string).unwrap_or_default()).collect();
        writer.serialize((k, results.session.seed, row.antithetic, row.status, &row.fault, numbers))?;
    }
    text(writer)
}

/// A row a realisation: CPU seconds, seconds, number of the worker.
///
/// # Errors
/// Those of the writer.
pub fn timing_csv(results: &Results) -> io::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["realisation", "cpu_s", "wall_s", "worker"])?;
    for (k, Done { cost, .. }) in &results.rows {
        writer.serialize((k, cost.cpu_s, cost.wall_s, cost.worker))?;
    }
    text(writer)
}

fn text(writer: csv::Writer<Vec<u8>>) -> io::Result<String> {
    let bytes = writer.into_inner().map_err(|e| io::Error::other(e.to_string()))?;
    String::from_utf8(bytes).map_err(io::Error::other)
}
