//! What the figures of a comparison say, in plain words. Nothing here is known beforehand.

use super::{Group, Row, Study, single};

/// Share by which onsets may differ and still count as the same.
const SAME_ONSET: f64 = 0.03;
/// Share of the largest displacement by which the same points may be apart at the end and still count
/// as moved alike.
const SAME_END: f64 = 0.05;
/// CPU time below which two runs cannot be told apart (s).
const SHORT: f64 = 0.02;

/// All conclusions.
pub fn conclusions(study: &Study) -> Vec<String> {
    let Some([explicit, implicit]) = study.rows.get(..2) else { return Vec::new() };
    let mut text: Vec<String> = [
        onset(explicit, implicit),
        first_block(explicit, implicit, study.cell_m),
        slide(explicit, implicit),
        motion(explicit, implicit),
        numerical(explicit, implicit),
    ]
    .into_iter()
    .flatten()
    .collect();
    text.extend(steps(study, implicit));
    text.extend(inertia(study, implicit));
    text.extend(better(study, explicit, "onset_cpu_s", "to the onset", &|row| same_onset(explicit, row)));
    text.extend(better(study, explicit, "cpu_s", "to the end", &|row| same_end(explicit, row)));
    text.extend(failures(study));
    text
}

fn both(a: &Row, b: &Row, name: &str) -> Option<(f64, f64)> {
    a.median(name).zip(b.median(name))
}

fn onset(a: &Row, b: &Row) -> Option<String> {
    let (e, i) = both(a, b, "onset_kn_m3")?;
    let apart = 100.0 * (i - e).abs() / e;
    let lost = b.median("stability_lost_kn_m3");
    let lost =
        lost.map(|w| format!(" The implicit scheme found no equilibrium beyond {w:.2} kN/m3.")).unwrap_or_default();
    Some(format!(
        "Onset: the crest has moved 0.25 m at {e:.2} kN/m3 (explicit) and {i:.2} (implicit), {apart:.1} % apart.{lost}"
    ))
}

fn first_block(a: &Row, b: &Row, cell: f64) -> Option<String> {
    let (e, i) = both(a, b, "first_block_m")?;
    let apart = (e - i).abs();
    let than = if apart <= cell * (1.0 + 1e-9) { "within" } else { "more than" };
    Some(format!("First block: {e:.2} m and {i:.2} m, {apart:.2} m apart: {than} a cell ({cell:.2} m)."))
}

/// Length of a block, on average (m).
fn block(row: &Row) -> Option<f64> {
    let (r, n) = row.median("sliding_distance_m").zip(row.median("blocks"))?;
    (n > 0.0).then_some(r / n)
}

fn slide(a: &Row, b: &Row) -> Option<String> {
    let (e, i) = both(a, b, "sliding_distance_m")?;
    let apart = (e - i).abs();
    let spread = |row: &Row| row.figures.get("sliding_distance_m").map_or(0.0, |s| s.max - s.min);
    let than = match block(a) {
        Some(length) if apart <= length => format!("within a block ({length:.1} m on average)"),
        Some(length) => format!("more than a block ({length:.1} m on average)"),
        None => "with no block to measure them by".to_owned(),
    };
    Some(format!(
        "Sliding distance: medians {e:.2} m and {i:.2} m, {apart:.2} m apart, {than}; the runs of each spread over {:.2} and {:.2} m.",
        spread(a),
        spread(b)
    ))
}

/// Where no sliding distance is defined: how far the same points are apart, over the largest
/// displacement at any time.
fn apart(a: &Row, b: &Row) -> Option<f64> {
    single::distance(a.runs.first()?, b.runs.first()?)
}

fn motion(a: &Row, b: &Row) -> Option<String> {
    let (share, (e, i)) = apart(a, b).zip(both(a, b, "amplitude_m"))?;
    Some(format!(
        "Displacement: at most {e:.3e} m (explicit) and {i:.3e} m (implicit); at the end the same points are up to {:.1} % of it apart.",
        100.0 * share
    ))
}

/// Energy that the scheme has lost or made, over what was supplied (%).
fn share(row: &Row) -> Option<f64> {
    let (numerical, external) = row.median("numerical_kj_per_m").zip(row.median("external_kj_per_m"))?;
    (external.abs() > 0.0).then(|| 100.0 * numerical / external)
}

fn numerical(a: &Row, b: &Row) -> Option<String> {
    let (e, i) = share(a).zip(share(b))?;
    Some(format!("Numerical energy: {e:.1} % (explicit) and {i:.1} % (implicit) of what was supplied."))
}

/// What a variant changes against the compared implicit one.
fn change(row: &Row, base: &Row, explicit: &Row) -> String {
    let mut parts = Vec::new();
    if let Some(share) = apart(explicit, row) {
        parts.push(format!("{:.1} % away from the explicit points", 100.0 * share));
    }
    if let Some((b, r)) = both(base, row, "sliding_distance_m") {
        parts.push(format!("r {:+.2} m", r - b));
    }
    if let Some((b, r)) = both(base, row, "onset_kn_m3") {
        parts.push(format!("onset {:+.1} %", 100.0 * (r / b - 1.0)));
    }
    if let Some(s) = share(row) {
        parts.push(format!("numerical energy {s:.1} %"));
    }
    if let Some((b, r)) = both(base, row, "cpu_s") {
        parts.push(format!("{:.2} times the CPU time", r / b.max(f64::MIN_POSITIVE)));
    }
    format!("{}: {}", row.entry.variant, parts.join(", "))
}

fn group(study: &Study, group: Group, base: &Row, opening: &str) -> Option<String> {
    let rows = study.rows.iter().filter(|r| r.entry.group == group);
    let parts: Vec<String> = rows.map(|r| change(r, base, &study.rows[0])).collect();
    (!parts.is_empty()).then(|| format!("{opening} {}: {}.", base.entry.variant, parts.join("; ")))
}

fn steps(study: &Study, base: &Row) -> Option<String> {
    group(study, Group::Steps, base, "Step length, against")
}

fn inertia(study: &Study, base: &Row) -> Option<String> {
    group(study, Group::Inertia, base, "Integrator of inertia, against")
}

fn same_onset(a: &Row, b: &Row) -> bool {
    both(a, b, "onset_kn_m3").is_some_and(|(e, i)| (i / e - 1.0).abs() <= SAME_ONSET)
}

/// r within a block; where r is not defined, points that end close together.
fn same_end(a: &Row, b: &Row) -> bool {
    match both(a, b, "sliding_distance_m") {
        Some((e, i)) => (e - i).abs() <= block(a).unwrap_or(0.0),
        None => apart(a, b).is_none_or(|share| share <= SAME_END),
    }
}

/// Which scheme is cheaper, among the implicit variants that give the answer of the explicit one.
fn better(study: &Study, explicit: &Row, name: &str, what: &str, same: &dyn Fn(&Row) -> bool) -> Option<String> {
    let e = explicit.median(name)?;
    let alike = study.rows[1..].iter().filter(|r| same(r)).filter_map(|r| Some((r, r.median(name)?)));
    let Some((row, i)) = alike.min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Some(format!("Cost {what}: explicit {e:.2} CPU s; no implicit variant gives the same answer."));
    };
    if e.min(i) < SHORT {
        return Some(format!("Cost {what}: explicit {e:.3} CPU s, implicit {i:.3}: too short to compare."));
    }
    let (winner, factor) = if i < e { (row.entry.variant.as_str(), e / i) } else { ("explicit", i / e) };
    Some(format!(
        "Cost {what}: explicit {e:.2} CPU s, the cheapest implicit variant with the same answer ({}) {i:.2}: the better choice on this case is {winner}, by a factor of {factor:.1}.",
        row.entry.variant
    ))
}

fn failures(study: &Study) -> Option<String> {
    let failed = |r: &Row| (r.failed > 0).then(|| format!("{} of {} ({})", r.failed, r.runs.len(), r.entry.variant));
    let all: Vec<String> = study.rows.iter().filter_map(failed).collect();
    (!all.is_empty()).then(|| format!("Failed and left out: {}; compare.json holds the faults.", all.join(", ")))
}
