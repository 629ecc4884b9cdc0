//! The study in words: table, ladders, and what the figures are worth.

use super::{
    Axis, Draws, Ladder, Level, Row, Study,
    judge::{Difference, FEWEST, Judgement, Rate, Verdict, WIDEST},
};
use crate::{
    case::{Case, Material, Scheme},
    math::stats::{Summary, richardson::RATES},
    study::digits::{digits, figure},
};

/// A limit that is as many of its uncertainties away from the exact value is not that of the problem.
const FAR: f64 = 10.0;

/// The table for people: all variants, then each ladder with its verdict.
pub fn table(study: &Study) -> String {
    let name = study.quantities.first().map_or("", |q| q.name());
    let name = if name == "sliding_distance" { "median r".to_owned() } else { name.to_owned() };
    let mut text = format!(
        "{:<28} {:>6} {:>7} {:>5} {:>9} {:>17} {:>17} {:>18} {:>7} {:>11} {:>8}\n",
        "variant",
        "cells",
        "points",
        "runs",
        name,
        "quartiles",
        "min to max",
        "mean +- se",
        "blocks",
        "first block",
        "rest (s)"
    );
    study.rows.iter().for_each(|row| text += &line(row));
    study.ladders.iter().for_each(|ladder| text += &ladder_table(ladder, study.draws));
    for remark in &study.remarks {
        text += &format!("note: {remark}\n");
    }
    text
}

fn line(row: &Row) -> String {
    let median = |s: &Option<Summary>| s.map_or("-".to_owned(), |s| figure(s.median));
    let r = row.quantities.first().copied().flatten();
    let of = |f: &dyn Fn(Summary) -> String| r.map_or("-".to_owned(), f);
    let flags = [
        (row.failed, "failed"),
        (row.cut_short, "cut short"),
        (row.censored, "censored"),
        (row.not_at_rest, "not at rest"),
    ];
    let flags: Vec<String> = flags.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
    format!(
        "{:<28} {:>6} {:>7} {:>5} {:>9} {:>17} {:>17} {:>18} {:>7} {:>11} {:>8} {}\n",
        row.variant,
        row.cells,
        row.points,
        row.runs.len(),
        of(&|s| figure(s.median)),
        of(&|s| format!("{} to {}", figure(s.lower_quartile), figure(s.upper_quartile))),
        of(&|s| format!("{} to {}", figure(s.min), figure(s.max))),
        of(&|s| format!("{} +- {}", figure(s.mean), digits(s.standard_error, 2))),
        median(&row.blocks),
        median(&row.first_block_m),
        median(&row.rest_time_s),
        flags.join(", "),
    )
}

/// A ladder for people.
fn ladder_table(ladder: &Ladder, draws: Draws) -> String {
    let in_unit = |name: &str, unit: &str| if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") };
    let what = match draws {
        Draws::Single => "single runs".to_owned(),
        Draws::Jittered { runs, .. } => format!("medians of {runs} jittered runs"),
        Draws::Realisations { runs } => format!("means over {runs} realisations, differences of pairs"),
    };
    let mut text = format!("\n{} by {}, {what}\n", in_unit(&ladder.quantity, ladder.unit), ladder.axis.words());
    text += &format!(
        "{:>14} {:>14} {:>5} {:>24}",
        in_unit(ladder.symbol, ladder.size_unit),
        "value",
        "runs",
        "to the next finer"
    );
    text += if ladder.exact.is_some() { "          error\n" } else { "\n" };
    ladder.levels.iter().for_each(|level| text += &level_line(level));
    text + &format!("  {}\n", ladder.text)
}

fn level_line(level: &Level) -> String {
    let number = |v: Option<f64>, count: usize| v.map_or("-".to_owned(), |v| digits(v, count));
    let error = level.error.map(|e| format!(" {:>14}", digits(e, 3))).unwrap_or_default();
    let difference = level.difference.map(|d| told(&d)).unwrap_or_default();
    let line = format!(
        "{:>14} {:>14} {:>5} {:>24}{error}",
        figure(level.size),
        number(level.value, 6),
        level.runs,
        difference
    );
    line.trim_end().to_owned() + "\n"
}

/// A difference with its interval.
fn told(d: &Difference) -> String {
    let interval = d.interval.map(|i| format!(" {}", range(i))).unwrap_or_default();
    format!("{}{interval}", digits(d.value, 3))
}

fn range([low, high]: [f64; 2]) -> String {
    format!("({} to {})", digits(low, 2), digits(high, 2))
}

/// The verdict in words; where a mesh gives no rate, what the case has to do with it.
pub(super) fn verdict(ladder: &Ladder, judgement: &Judgement, case: &Case) -> String {
    let mut text = plain(ladder, judgement);
    let no_length = case.material.values().any(Material::softens_without_length);
    let told = matches!(
        ladder.verdict,
        Verdict::NoValues | Verdict::Same | Verdict::Unresolved { .. } | Verdict::Clean { .. }
    );
    if ladder.axis == Axis::Mesh && no_length && !told {
        text += "; linear softening has no length scale (`regularisation` of the material gives it one)";
    }
    if let Some(rate) = ladder.rate_of_errors {
        text += &errors(rate);
    }
    if let (Verdict::Clean { limit, uncertainty, .. }, Some(exact)) = (ladder.verdict, ladder.exact)
        && (limit - exact).abs() > FAR * uncertainty
    {
        text += &format!("; but the exact value is {} away from this limit", digits((limit - exact).abs(), 3));
    }
    text
}

/// How errors against the exact value change with the size.
fn errors(rate: f64) -> String {
    if rate > 0.0 {
        format!("; errors against the exact value fall at the rate {}", digits(rate, 3))
    } else {
        "; errors against the exact value do not fall".to_owned()
    }
}

fn plain(ladder: &Ladder, judgement: &Judgement) -> String {
    let unit = if ladder.unit.is_empty() { String::new() } else { format!(" {}", ladder.unit) };
    let differences = list(&judgement.differences);
    let scatters = judgement.differences.iter().any(|d| d.interval.is_some());
    match ladder.verdict {
        Verdict::NoValues => "fewer than two levels have a value".to_owned(),
        Verdict::Same => "the same at all levels, to rounding".to_owned(),
        Verdict::Unresolved { last, bound } => format!(
            "the last difference, {}{unit}, is not told from the scatter of the runs: it is at most {}{unit}, and no rate is looked for",
            digits(last, 2),
            digits(bound, 2)
        ),
        Verdict::TwoLevels => {
            format!("one difference, {differences}{unit}: a rate needs three levels")
        }
        Verdict::SignChange => format!("does not converge: differences {differences}{unit} change sign"),
        Verdict::NoDecay { .. } => format!("does not converge: differences {differences}{unit} do not fall"),
        Verdict::FewRuns { runs } => format!(
            "differences {differences}{unit}; {runs} runs a level do not tell how far they scatter, a rate needs {FEWEST}"
        ),
        Verdict::OddRate { rate } => {
            format!("no clean rate: {}, not within {} to {}", rated(&rate, scatters), RATES[0], RATES[1])
        }
        Verdict::Uncertain { rate } if rate.defined < 0.95 => format!(
            "no clean rate: {}, and only {} % of the resamples have differences of one sign",
            rated(&rate, scatters),
            digits(100.0 * rate.defined, 2)
        ),
        Verdict::Uncertain { rate } => format!("no clean rate: {}, wider than {WIDEST}", rated(&rate, scatters)),
        Verdict::Clean { rate, limit, uncertainty } => format!(
            "converges at the rate {}; limit {} +- {}{unit} ({})",
            rated(&rate, scatters),
            digits(limit, 6),
            digits(uncertainty, 2),
            known(&rate, scatters),
        ),
    }
}

/// Where the uncertainty of a limit comes from.
fn known(rate: &Rate, scatters: bool) -> &'static str {
    match (scatters, rate.interval) {
        (true, _) => "half of its 95 % interval",
        (false, Some(_)) => "the limits of each three levels in a row",
        (false, None) => "its distance from the finest level",
    }
}

/// A rate and how well it is known.
fn rated(rate: &Rate, scatters: bool) -> String {
    let value = digits(rate.value, 3);
    match rate.interval {
        None => format!("{value} (of three levels, so without an interval)"),
        Some(interval) if scatters => format!("{value}, 95 % interval {}", range(interval)),
        Some(interval) => format!("{value} {} of each three levels in a row", range(interval)),
    }
}

fn list(differences: &[Difference]) -> String {
    let all: Vec<String> = differences.iter().map(|d| digits(d.value, 2)).collect();
    match all.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => all.concat(),
    }
}

/// What a reader must know before using the table.
pub(super) fn remarks(draws: Draws, case: &Case, rows: &[Row]) -> Vec<String> {
    let mut text = vec![spread(draws, case)];
    let sd = rows.iter().filter_map(|r| r.sliding_distance_m).map(|s| s.sd).fold(0.0, f64::max);
    let change = rows.iter().filter_map(|r| r.median_change_m).map(f64::abs).fold(0.0, f64::max);
    if change > sd.max(0.5) {
        text.push(format!(
            "Medians of r differ by up to {change:.1} m, more than the spread of the runs ({sd:.1} m): the variants do not give the same answer."
        ));
    }
    if case.solver.scheme == Scheme::Implicit && case.implicit.tolerance.is_some() {
        text.push(
            "implicit.tolerance chooses the time step: refine it with --vary implicit.tolerance=V1,V2.".to_owned(),
        );
    }
    let failed: usize = rows.iter().map(|r| r.failed).sum();
    if failed > 0 {
        text.push(format!("{failed} runs failed and are left out of the statistics; converge.json holds the faults."));
    }
    text
}

fn spread(draws: Draws, case: &Case) -> String {
    match draws {
        Draws::Single if case.material.values().any(Material::yields) => "One run a level: after failure a slope is chaotic, and one run cannot be told from chance; --runs 6 jitters the strength.",
        Draws::Single => "One run a level.",
        Draws::Jittered { .. } => "Spread is over jittered strengths only: it is the chance part of one run, not the effect of soil variability.",
        Draws::Realisations { .. } => "Spread is over realisations of the random fields, the same at every level; values of a ladder are means over those that all its levels have.",
    }
    .to_owned()
}
