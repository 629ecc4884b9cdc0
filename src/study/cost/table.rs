//! The study as text: a table for people, one for programs, and what the figures are worth.

use std::fmt::Write;

use super::{
    Basis, Plan, Row, SHORT, Skipped, Study,
    answer::{figure_of_two, seconds},
    setting::{is_numerical, merged},
};
use crate::{
    case::Scheme,
    run::Status,
    study::digits::{digits, figure},
};

/// The table for people.
pub fn table(study: &Study) -> String {
    let width = study.rows.iter().map(|r| r.setting.chars().count()).fold(7, usize::max);
    let mut text = String::new();
    // writing to a string does not fail
    let _ = heading(&mut text, study);
    let error = if study.is_relative() { "error (%)" } else { "error" };
    let _ = writeln!(
        text,
        "{:<width$} {:>12} {:>10} {:>9} {:>9} {:>14} {:>8} {:>11}  front",
        "setting", "value", error, "CPU (s)", "steps", "particle-steps", "Newton", "law blocks"
    );
    study.rows.iter().for_each(|row| text += &line(row, width, study));
    skipped(&mut text, &study.skipped);
    ladders(&mut text, study);
    study.remarks.iter().for_each(|remark| text += &format!("note: {remark}\n"));
    study.answers.iter().for_each(|answer| text += &format!("{}\n", answer.text));
    text
}

fn heading(text: &mut String, study: &Study) -> std::fmt::Result {
    let unit = study.quantity.unit();
    let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
    writeln!(text, "{}: what accuracy costs in {}{unit}", study.title, study.quantity.name())?;
    match &study.reference {
        Some(r) => {
            let known = r.uncertainty.filter(|u| *u > 0.0).map(|u| format!(", known to {}", figure_of_two(u)));
            writeln!(text, "errors against {}{}: {}", digits(r.value, 7), known.unwrap_or_default(), r.source)
        }
        None => writeln!(text, "no run gave a value: there is nothing to measure errors against"),
    }
}

fn line(row: &Row, width: usize, study: &Study) -> String {
    let number = |v: Option<f64>, f: fn(f64) -> String| v.map_or("-".to_owned(), f);
    let error = row.error.map(|e| if study.is_relative() { 100.0 * e } else { e });
    let spread = row.runs.map(|r| format!("  {} runs from {:.2} to {:.2}", r.n, r.min, r.max)).unwrap_or_default();
    let mut marks = if row.on_front { "*" } else { "" }.to_owned();
    if row.is_reference {
        marks += "reference";
    }
    format!(
        "{:<width$} {:>12} {:>10} {:>9} {:>9} {:>14} {:>8} {:>11}  {}{}{}\n",
        row.setting,
        number(row.value, |v| digits(v, 6)),
        if row.is_reference { "-".to_owned() } else { number(error, figure_of_two) },
        number(row.cpu_s, figure_of_two),
        row.work.steps,
        row.work.particle_steps,
        row.work.newton_iterations,
        row.work.law_blocks,
        marks,
        spread,
        row.fault.as_ref().map(|f| format!(" FAILED: {f}")).unwrap_or_default(),
    )
}

/// The settings that were not run, those with one reason together.
fn skipped(text: &mut String, skipped: &[Skipped]) {
    let mut told: Vec<&str> = Vec::new();
    for why in skipped.iter().map(|s| s.why.as_str()) {
        if told.contains(&why) {
            continue;
        }
        told.push(why);
        let alike: Vec<&Skipped> = skipped.iter().filter(|s| s.why == why).collect();
        *text += &format!("not run, {why} ({}):\n", alike.len());
        for s in alike {
            let predicted = s.predicted_s.map(|p| format!(", expected to take {}", seconds(p))).unwrap_or_default();
            *text += &format!("  {}{predicted}\n", s.setting);
        }
    }
}

/// Rates of the ladders of meshes, where one shows.
fn ladders(text: &mut String, study: &Study) {
    for ladder in study.ladders.iter().filter(|l| l.cells_m.len() > 2) {
        let order = ladder.order.map_or("no rate".to_owned(), |p| format!("order {p:.2}"));
        let limit = ladder.limit.map(|v| format!(", limit {}", digits(v, 7))).unwrap_or_default();
        *text += &format!("meshes of {}: {order}{limit}\n", ladder.setting);
    }
}

/// What a reader must know before using the table.
pub fn remarks(study: &Study, plan: &Plan) -> Vec<String> {
    let mut text = vec![format!(
        "times are CPU seconds on this machine, {} at a time; runs below {SHORT} s are repeated in batches and the least counts; good as ratios, not to the second digit",
        super::workers::count(plan.threads)
    )];
    text.extend(reference(study));
    if !study.is_relative() {
        text.push(
            "the reference is 0: there are no shares, so errors are differences and no setting is named for a share"
                .to_owned(),
        );
    }
    if study.statistical {
        text.push(format!(
            "{} is a draw of chance: values are medians of {} runs whose strengths differ by +-{} %. The error is statistical; differences below the spread of the runs mean nothing, and no rate of convergence is looked for",
            study.quantity.name(), plan.runs, 100.0 * plan.jitter
        ));
    }
    let keys = merged(&plan.vary).into_iter().map(|axis| axis.key);
    let physical: Vec<String> = keys.filter(|key| !is_numerical(key)).collect();
    if !physical.is_empty() {
        text.push(format!(
            "{} may change the problem itself: its values have one reference all the same",
            physical.join(", ")
        ));
    }
    let count = |status: Status| study.rows.iter().filter(|r| r.status == status).count();
    if count(Status::Failed) > 0 {
        text.push(format!("settings that failed: {}; the table gives each its reason", count(Status::Failed)));
    }
    if count(Status::ResourceCap) > 0 {
        text.push(format!(
            "settings cut short, being dearer than predicted: {}; raise --budget",
            count(Status::ResourceCap)
        ));
    }
    text.extend(dynamics(study));
    text
}

fn reference(study: &Study) -> Option<String> {
    let reference = study.reference.as_ref()?;
    match reference.basis {
        Basis::Exact => None,
        Basis::Richardson => Some(
            "the reference is extrapolated from the runs themselves (Richardson), not exact: an error common to all runs does not show"
                .to_owned(),
        ),
        Basis::FinestRun => Some(finest_run(study)),
    }
}

fn finest_run(study: &Study) -> String {
    let why = match study.ladders.iter().any(|l| l.limit.is_some()) {
        _ if study.statistical => "no limit is looked for",
        true => "a clean rate shows only where the time steps are not the finest",
        false => "no ladder of three meshes shows a clean rate",
    };
    format!("the reference is the finest run, as {why}: errors near its own are too small")
}

/// Where one scheme answers with inertia and the other without.
fn dynamics(study: &Study) -> Option<String> {
    let without = |row: &Row| row.at.as_ref().is_some_and(|s| s.case.implicit.regime.inertia().is_none());
    let explicit = study.rows.iter().any(|r| r.scheme == Scheme::Explicit);
    let still = study.rows.iter().any(|r| r.scheme == Scheme::Implicit && without(r));
    (explicit && still).then(|| {
        "the explicit scheme has inertia, the implicit one (regime quasi_static) has none: the error of the explicit one holds the waves that the loading leaves behind"
            .to_owned()
    })
}

/// The table for programs (CSV).
pub fn csv(study: &Study) -> String {
    let mut text = "setting,scheme,shape,cell_m,points_per_axis,status,value,error,cpu_s,repeats,steps,rejected_steps,\
        particle_steps,newton_iterations,factorisations,law_blocks,on_front,on_work_front,is_reference,fault\n"
        .to_owned();
    for r in &study.rows {
        let number = |v: Option<f64>| v.map(|v| format!("{v:?}")).unwrap_or_default();
        let status = serde_json::to_value(r.status).ok().and_then(|v| v.as_str().map(str::to_owned));
        let cells = [
            quoted(&r.setting),
            super::setting::word_of(r.scheme).to_owned(),
            r.shape.word().to_owned(),
            format!("{:?}", r.cell_m),
            r.points_per_axis.to_string(),
            status.unwrap_or_default(),
            number(r.value),
            number(r.error),
            number(r.cpu_s),
            r.repeats.to_string(),
            r.work.steps.to_string(),
            r.work.rejected_steps.to_string(),
            r.work.particle_steps.to_string(),
            r.work.newton_iterations.to_string(),
            r.work.factorisations.to_string(),
            r.work.law_blocks.to_string(),
            r.on_front.to_string(),
            r.on_work_front.to_string(),
            r.is_reference.to_string(),
            r.fault.as_deref().map(quoted).unwrap_or_default(),
        ];
        text += &(cells.join(",") + "\n");
    }
    text
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// The quantity with its reference, for titles.
pub fn caption(study: &Study) -> String {
    let against = match study.reference.as_ref().map(|r| r.basis) {
        Some(Basis::Exact) => "the exact value",
        Some(Basis::Richardson) => "a Richardson limit",
        Some(Basis::FinestRun) => "the finest run",
        None => "nothing",
    };
    let value = study.reference.as_ref().map(|r| format!(", {}", figure(r.value))).unwrap_or_default();
    let text = format!("{}: error against {against}{value} {}", study.quantity.name(), study.quantity.unit());
    let failed = study.rows.iter().filter(|r| r.fault.is_some()).count();
    let failed = if failed > 0 { format!("; {failed} failed, see cost.csv") } else { String::new() };
    format!("{}{failed}", text.trim_end())
}
