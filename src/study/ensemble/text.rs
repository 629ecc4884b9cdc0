//! The ensemble as a table for people.

use std::fmt::Write;

use super::{
    Report,
    measures::{self, SLIDING_DISTANCE},
    results::Results,
    summary::Summary,
};
use crate::math::stats::Summary as Spread;

/// Measures of the table, where the case has them.
const SHOWN: [&str; 7] = [
    SLIDING_DISTANCE,
    "blocks",
    "first_block_m",
    "slide_volume_m3_per_m",
    "runout_m",
    "end_time_s",
    "numerical_energy_share",
];

/// Counts, statistics, the run at the mean, the cost.
pub fn text(results: &Results, report: &Report) -> String {
    let (summary, timing) = (&report.summary, &report.timing);
    let mut s = format!("{}: {}\n", summary.title, counts(summary));
    // writing to a string does not fail
    let _ = writeln!(
        s,
        "  {:<26} {:>5} {:>16} {:>8} {:>9} {:>9} {:>9} {:>9}",
        "measure", "n", "mean +- se", "sd", "least", "median", "largest", "at mean"
    );
    for m in measures::list(&results.case).iter().filter(|m| SHOWN.contains(&m.name.as_str())) {
        let Some(spread) = summary.statistics.get(&m.name) else { continue };
        let at_mean = summary.deterministic.as_ref().and_then(|row| row.measure(&m.name));
        let unit = if m.unit.is_empty() { String::new() } else { format!(" ({})", m.unit) };
        let _ = writeln!(s, "  {:<26} {}", format!("{}{unit}", words(&m.name)), line(spread, at_mean));
    }
    if let Some(d) = &summary.until {
        let value = d.value.map_or("-".to_owned(), |v| format!("{v:.3}"));
        let reached = if d.reached { "reached" } else { "not reached" };
        let _ = writeln!(s, "  rule        {reached} at n = {}: standard error {value}", d.n);
    }
    for done in results.all().filter(|d| d.row.fault.is_some()).take(5) {
        let name = super::journal::name(done.row.realisation);
        let _ = writeln!(s, "  failed      {name}: {}", done.row.fault.as_deref().unwrap_or_default());
    }
    let rate = timing.particle_steps_per_cpu_s.map_or("-".to_owned(), |r| format!("{:.1}", r / 1e6));
    let idle = timing.idle_share.map_or(String::new(), |i| format!(", idle {:.1} %", 100.0 * i));
    let _ = writeln!(
        s,
        "  cost        {:.1} s on {} threads{idle}; all rows {:.1} CPU s, {rate} M particle-steps per CPU second",
        timing.wall_s, timing.threads, timing.rows_cpu_s
    );
    s
}

/// The name of a measure without its unit, in words.
fn words(name: &str) -> String {
    let name = ["_m3_per_m", "_s", "_m"].iter().find_map(|unit| name.strip_suffix(unit)).unwrap_or(name);
    name.replace('_', " ")
}

fn counts(s: &Summary) -> String {
    let c = &s.counts;
    let mut text = format!("{} realisations from {} on, seed {}", s.done, s.first, s.seed);
    let parts = [
        (s.missing as usize, "not done"),
        (c.failed, "failed"),
        (c.end_time, "not at rest"),
        (c.no_slide, "without a slide"),
        (c.censored, "at the wall"),
    ];
    for (n, what) in parts.iter().filter(|(n, _)| *n > 0) {
        text += &format!(", {n} {what}");
    }
    text
}

fn line(s: &Spread, at_mean: Option<f64>) -> String {
    let at_mean = at_mean.map_or("-".to_owned(), |v| format!("{v:.2}"));
    format!(
        "{:>5} {:>16} {:>8.2} {:>9.2} {:>9.2} {:>9.2} {at_mean:>9}",
        s.n,
        format!("{:.2} +- {:.2}", s.mean, s.standard_error),
        s.sd,
        s.min,
        s.median,
        s.max
    )
}
