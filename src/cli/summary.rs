//! The summary of a run for people.

use std::fmt::Write;

use crate::case::Scheme;
use crate::measure::Measures;
use crate::output::record::{Record, Timing};

/// A few lines: what happened, the measures, the balances, the cost, the warnings.
pub fn text(record: &Record, timing: &Timing, out: &str) -> String {
    let mut s = String::new();
    // writing to a string does not fail
    let _ = header(&mut s, record);
    let _ = safety(&mut s, record);
    let _ = slide(&mut s, record);
    let _ = probes(&mut s, record);
    let _ = balances(&mut s, record);
    let _ = cost(&mut s, record, timing);
    let _ = solution(&mut s, record);
    for w in &record.warnings {
        let _ = writeln!(s, "  note        {} (key `{}`)", w.text, w.key);
    }
    let _ = writeln!(s, "  left in     {out}");
    s
}

fn header(s: &mut String, r: &Record) -> std::fmt::Result {
    writeln!(s, "{}: {}", r.title, r.outcome.message)?;
    let [elastic, unloading, softening, residual] = r.measures.stage_points;
    writeln!(
        s,
        "  points      {} ({elastic} elastic, {unloading} unloading, {softening} softening, {residual} residual)",
        r.work.points
    )
}

/// The factor of safety, where one was asked for.
fn safety(s: &mut String, r: &Record) -> std::fmt::Result {
    let Some(found) = &r.strength_reduction else { return Ok(()) };
    let number = |pointer: &str| found.pointer(pointer).and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN);
    let trials = found.get("trials").and_then(serde_json::Value::as_array).map_or(0, Vec::len);
    writeln!(
        s,
        "  safety      factor of safety {:.3}: stands with {:.4}, fails with {:.4}; {trials} runs; what follows is the one that failed",
        number("/factor_of_safety"),
        number("/bracket/0"),
        number("/bracket/1")
    )
}

fn slide(s: &mut String, r: &Record) -> std::fmt::Result {
    let m = &r.measures;
    let Some(distance) = m.sliding_distance_m else { return writeln!(s, "  run-out     {:.3} m", m.runout_m) };
    let censored = if m.sliding_distance_censored { ", censored by the wall" } else { "" };
    let plateaus: Vec<String> =
        m.plateaus.iter().map(|p| format!("{:.2} m at {:.1} s", p.sliding_distance_m, p.from_s)).collect();
    let colon = if plateaus.is_empty() { "" } else { ": " };
    writeln!(
        s,
        "  slide       r = {distance:.2} m{censored}; {} blocks{colon}{}",
        plateaus.len(),
        plateaus.join(", ")
    )?;
    let others: Vec<String> = m.sliding_distance_at.iter().map(|(k, v)| format!("{k}: {v:.2} m")).collect();
    writeln!(s, "              r by threshold  {}", others.join(", "))?;
    let volume = m.slide_volume_m3_per_m.unwrap_or(0.0);
    writeln!(s, "              volume {volume:.1} m3/m, run-out {:.2} m", m.runout_m)?;
    initial_failure(s, m)
}

/// The onset, and the first slide at each level.
fn initial_failure(s: &mut String, m: &Measures) -> std::fmt::Result {
    let Some(time) = m.onset_time_s else { return Ok(()) };
    writeln!(s, "  onset       {time:.2} s; the first slide by displacement since then:")?;
    m.initial_failure.iter().try_for_each(|f| {
        let (c, t) = (&f.by_clusters, &f.by_threshold);
        writeln!(
            s,
            "              {} m at {:.2} s: r = {:.2} m, volume {:.1} m3/m (split at {:.2} m); by half of the largest {:.2} m, {:.1} m3/m",
            f.level_m, f.time_s, c.sliding_distance_m, c.volume_m3_per_m, c.split_m, t.sliding_distance_m, t.volume_m3_per_m
        )
    })
}

fn probes(s: &mut String, r: &Record) -> std::fmt::Result {
    r.measures.probes.iter().try_for_each(|p| {
        let value = p.value.map_or("no value".to_owned(), |v| format!("{} {}", seven(v), p.quantity.unit()));
        let error = p.exact.zip(p.error).map(|(exact, error)| format!("; exact {}, error {error:.2e}", seven(exact)));
        let near = if p.points == 1 { " (that of the nearest point)" } else { "" };
        let (name, quantity) = (&p.name, p.quantity.word());
        writeln!(s, "  probe       {name}: {quantity} = {}{near}{}", value.trim_end(), error.unwrap_or_default())
    })
}

/// Seven digits, with an exponent where the number is far from 1.
fn seven(value: f64) -> String {
    if (1e-2..1e5).contains(&value.abs()) { format!("{value:.6}") } else { format!("{value:.6e}") }
}

fn balances(s: &mut String, r: &Record) -> std::fmt::Result {
    let e = &r.measures.energy_kj_per_m;
    // a tenth of a kJ/m is enough for a slope, four digits for a bar
    let digits = if e.external.abs() < 10.0 { 4 } else { 1 };
    writeln!(
        s,
        "  energy      external {:.*} = kinetic {:.*} + elastic {:.*} + dissipated {:.*} + numerical {:.*} kJ/m",
        digits, e.external, digits, e.kinetic, digits, e.strain, digits, e.dissipated, digits, e.numerical
    )?;
    let [x, y] = r.measures.momentum_error;
    writeln!(s, "  balances    mass {:.1e} relative; momentum {x:.1e}, {y:.1e} of weight x time", r.measures.mass_error)
}

fn cost(s: &mut String, r: &Record, t: &Timing) -> std::fmt::Result {
    // a run shorter than a tick of the CPU clock has no rate
    let rate = t.particle_steps_per_cpu_s.map_or("-".to_owned(), |rate| format!("{:.1}", rate / 1e6));
    let dt = r.dt_s.get("mean").and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN);
    writeln!(
        s,
        "  cost        {} steps of {:.2} ms, {} rejected; {:.1} s, {rate} M particle-steps per CPU second, {:.0} bytes a point",
        r.work.steps,
        1e3 * dt,
        r.work.rejected_steps,
        t.wall_s,
        t.bytes_per_point
    )
}

/// What the iterations took, and what happened once.
fn solution(s: &mut String, r: &Record) -> std::fmt::Result {
    if r.scheme == Scheme::Implicit {
        let (w, steps) = (&r.work, r.work.steps.max(1) as f64);
        writeln!(
            s,
            "  solution    {:.1} iterations a step, {} factorisations ({} unsymmetric), {} shortened iterations",
            w.newton_iterations as f64 / steps,
            w.factorisations,
            w.lu_factorisations,
            w.line_searches
        )?;
    }
    r.events.iter().try_for_each(|e| writeln!(s, "  event       {:.2} s: {} ({})", e.time_s, e.words(), e.why))
}
