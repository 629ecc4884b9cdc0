//! The ensemble as a table for people.

use std::fmt::{self, Write};

use super::{
    Report,
    measures::{self, SLIDING_DISTANCE},
    results::Results,
    slide::SlideStatistics,
    summary::Summary,
    timing::Timing,
};
use crate::math::stats::{Moments, Share};

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

/// Counts, statistics, what is said about r, the cost.
pub fn text(results: &Results, report: &Report) -> String {
    let mut s = format!("{}: {}\n", report.summary.title, counts(&report.summary));
    // writing to a string does not fail
    let _ = table(&mut s, results, &report.summary);
    let _ = report.summary.sliding_distance.as_ref().map(|r| slide(&mut s, r));
    let _ = ending(&mut s, results, &report.summary);
    let _ = cost(&mut s, &report.timing);
    s
}

fn table(s: &mut String, results: &Results, summary: &Summary) -> fmt::Result {
    writeln!(
        s,
        "  {:<26} {:>5} {:>16} {:>14} {:>8} {:>8} {:>8} {:>8} {:>8}",
        "measure", "n", "mean +- se", "sd +- se", "5 %", "50 %", "95 %", "largest", "at mean"
    )?;
    for m in measures::list(&results.case).iter().filter(|m| SHOWN.contains(&m.name.as_str())) {
        let Some(moments) = summary.statistics.get(&m.name) else { continue };
        let at_mean = summary.deterministic.as_ref().and_then(|row| row.measure(&m.name));
        let unit = if m.unit.is_empty() { String::new() } else { format!(" ({})", m.unit) };
        writeln!(s, "  {:<26} {}", format!("{}{unit}", words(&m.name)), line(moments, at_mean))?;
    }
    Ok(())
}

fn slide(s: &mut String, r: &SlideStatistics) -> fmt::Result {
    let percent = |p: &Share| format!("{:.0} % ({:.0} to {:.0})", 100.0 * p.share, 100.0 * p.low, 100.0 * p.high);
    if let Some((none, wall)) = r.no_slide.as_ref().zip(r.censored.as_ref()) {
        writeln!(s, "  shares      r = 0: {}; at the wall: {}; with 95 % intervals", percent(none), percent(wall))?;
    }
    if let Some(fit) = &r.censored_normal {
        let (below, above) = (fit.below, fit.above);
        let what = format!("normal with {below} values at 0 and {above} at the wall taken as bounds");
        writeln!(
            s,
            "  fit         {:.2} +- {:.2} m, sd {:.2} +- {:.2} m: {what}",
            fit.mean, fit.mean_se, fit.sd, fit.sd_se
        )?;
    }
    if let Some(g) = &r.goodness {
        let (ks, ad) = (g.kolmogorov_smirnov_p, g.anderson_darling_p);
        writeln!(s, "              p = {ks:.3} (Kolmogorov-Smirnov), {ad:.3} (Anderson-Darling) that it is one")?;
    }
    let step = r.exceedance.len().div_ceil(8).max(1);
    let shown = r.exceedance.iter().step_by(step).filter(|e| e.above > 0.0);
    let beyond: Vec<String> = shown.map(|e| format!("{} m: {:.2}", e.above, e.share)).collect();
    if !beyond.is_empty() {
        writeln!(s, "  P(r > R)    {}", beyond.join(", "))?;
    }
    r.remarks.iter().try_for_each(|text| writeln!(s, "  note        {text}"))
}

fn ending(s: &mut String, results: &Results, summary: &Summary) -> fmt::Result {
    if let Some(d) = &summary.until {
        let value = d.value.map_or("-".to_owned(), |v| format!("{v:.3}"));
        let reached = if d.reached { "reached" } else { "not reached" };
        writeln!(s, "  rule        {reached} at n = {}: standard error {value} of {}", d.n, d.rule.measure)?;
    }
    for done in results.all().filter(|d| d.row.fault.is_some()).take(5) {
        let name = super::journal::name(done.row.realisation);
        writeln!(s, "  failed      {name}: {}", done.row.fault.as_deref().unwrap_or_default())?;
    }
    Ok(())
}

fn cost(s: &mut String, timing: &Timing) -> fmt::Result {
    let rate = timing.particle_steps_per_cpu_s.map_or("-".to_owned(), |r| format!("{:.1}", r / 1e6));
    let idle = timing.idle_share.map_or(String::new(), |i| format!(", idle {:.1} %", 100.0 * i));
    let threads = if timing.threads > 0 { format!(" on {} threads{idle}", timing.threads) } else { String::new() };
    writeln!(
        s,
        "  cost        {:.1} s{threads}; all rows {:.1} CPU s, {rate} M particle-steps per CPU second",
        timing.wall_s, timing.rows_cpu_s
    )
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

fn line(m: &Moments, at_mean: Option<f64>) -> String {
    let at = |k: usize| m.quantiles.get(k).map_or("-".to_owned(), |q| format!("{:.2}", q.value));
    let at_mean = at_mean.map_or("-".to_owned(), |v| format!("{v:.2}"));
    format!(
        "{:>5} {:>16} {:>14} {:>8} {:>8} {:>8} {:>8.2} {at_mean:>8}",
        m.n,
        format!("{:.2} +- {:.2}", m.mean, m.mean_se),
        format!("{:.2} +- {:.2}", m.sd, m.sd_se),
        at(0),
        at(2),
        at(4),
        m.max
    )
}
