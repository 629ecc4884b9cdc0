//! The study as text: tables, and what they say in plain sentences.

use super::{Quantity, Study};
use crate::math::stats::Rate;

/// Tables, then sentences.
pub fn table(study: &Study) -> String {
    let mut text = String::new();
    for quantity in &study.quantities {
        text += &levels(study, quantity);
    }
    text += &split(study);
    text += &comparison(study);
    study.remarks.iter().for_each(|line| text += &format!("- {line}\n"));
    text
}

/// Name and unit of a measure, from the name of its column.
pub fn words(name: &str) -> (&str, &'static str) {
    match name {
        "sliding_distance_m" => ("sliding distance r", "m"),
        "first_block_m" => ("first block", "m"),
        "slide_volume_m3_per_m" => ("volume of the slide", "m3/m"),
        "onset_time_s" => ("onset of failure", "s"),
        "runout_m" => ("run-out", "m"),
        other => (other, ""),
    }
}

fn levels(study: &Study, q: &Quantity) -> String {
    let (name, unit) = words(&q.name);
    let mut text = format!(
        "{:<26} {:>6} {:>16} {:>8} {:>8} {:>18} {:>8} {:>12} {:>22}\n",
        format!("{name} ({unit})"),
        "runs",
        "mean",
        "sd",
        "pairs",
        "difference",
        "sd",
        "V_l / V",
        "correlation"
    );
    for (l, (level, term)) in q.levels.iter().zip(&q.terms).enumerate() {
        let label = study.settings.get(l).map_or("", |s| s.label.as_str());
        text += &format!(
            "{label:<26} {:>6} {:>16} {:>8.2}",
            level.n,
            with_error(level.mean, level.standard_error),
            level.sd
        );
        if l > 0 {
            let correlation =
                term.correlation.map_or("-".to_owned(), |c| format!("{:.2} ({:.2} to {:.2})", c.r, c.low, c.high));
            text += &format!(
                " {:>8} {:>18} {:>8.2} {:>12.2} {correlation:>22}",
                term.n,
                with_error(term.mean, term.mean_se),
                term.variance.sqrt(),
                term.variance / term.fine_variance
            );
        }
        text.push('\n');
    }
    text + "\n"
}

fn with_error(value: f64, error: f64) -> String {
    format!("{value:.2} +- {error:.2}")
}

fn split(study: &Study) -> String {
    let mut text = format!(
        "{:<26} {:>6} {:>12} {:>8} {:>16} {:>8} {:>12} {:>6}\n",
        format!("error of {}", study.target.error),
        "runs",
        "CPU s a run",
        "sd",
        "bias",
        "n",
        "CPU s",
        "sure"
    );
    for (k, o) in study.split.offers.iter().enumerate() {
        let n = o.realisations.map_or("-".to_owned(), |n| n.to_string());
        let cpu = o.cpu_s.map_or("-".to_owned(), seconds);
        let mark = if study.split.best == Some(k) { " <- cheapest" } else { "" };
        let bias = with_error(o.bias, o.bias_se);
        text += &format!(
            "{:<26} {:>6} {:>12} {:>8.2} {bias:>16} {n:>8} {cpu:>12} {:>6}{mark}\n",
            o.label,
            o.runs,
            seconds(o.run_cpu_s),
            o.sd,
            if o.sure { "yes" } else { "no" }
        );
    }
    for b in &study.split.budgets {
        text += &format!(
            "least error for {} CPU s: {:.2} with {} ({} realisations)\n",
            seconds(b.cpu_s),
            b.error,
            b.label,
            b.realisations
        );
    }
    text + "\n"
}

fn comparison(study: &Study) -> String {
    let Some(main) = study.quantities.first() else { return String::new() };
    let counts = |n: &[u64]| n.iter().map(u64::to_string).collect::<Vec<_>>().join(" + ");
    let mut text =
        format!("{:<38} {:>22} {:>12} {:>22} {:>12}\n", "", "multilevel: n", "CPU s", "plain, finest: n", "CPU s");
    for (label, f) in [("predicted from the pilot", &study.pilot), ("predicted from all runs", &study.forecast)] {
        text += &format!(
            "{label:<38} {:>22} {:>12.1} {:>22} {:>12.1}\n",
            counts(&f.realisations),
            f.cpu_s,
            f.plain_realisations,
            f.plain_cpu_s
        );
    }
    let done: Vec<u64> = main.terms.iter().map(|t| t.n as u64).collect();
    let label = format!("done: standard error {:.2}", main.mean_se);
    let plain = main.terms.last().map_or(0.0, |t| (t.fine_variance / main.mean_se.powi(2)).ceil());
    text +=
        &format!("{label:<38} {:>22} {:>12.1} {plain:>22} {:>12.1}\n\n", counts(&done), main.cpu_s, main.plain_cpu_s);
    text
}

/// A time to two or more figures (s).
pub fn seconds(s: f64) -> String {
    let decimals = if s > 0.0 { (1.0 - s.log10().floor()).clamp(0.0, 6.0) as usize } else { 0 };
    format!("{s:.decimals$}")
}

/// A rate with its interval.
pub fn rate(name: &str, rate: Option<Rate>) -> String {
    rate.map_or(format!("{name} unknown"), |r| format!("{name} = {:.2} ({:.2} to {:.2})", r.rate, r.low, r.high))
}
