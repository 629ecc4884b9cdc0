//! The report of a field for people.

use std::fmt::{self, Write};

use super::{FieldReport, Lag};
use crate::case::{LowValues, Marginal};

/// The reports, one below the other.
pub fn table(reports: &[FieldReport]) -> String {
    let mut out = String::new();
    for report in reports {
        // writing to a string does not fail
        let _ = asked(&mut out, report);
        let _ = built(&mut out, report);
        let _ = correlations(&mut out, report);
        let _ = drawn(&mut out, report);
    }
    out
}

fn asked(s: &mut String, r: &FieldReport) -> fmt::Result {
    let names: Vec<_> = r.parameters.iter().map(|p| p.word()).collect();
    writeln!(s, "field {}: {} of {}", r.name, names.join(", "), r.material)?;
    let unit = if r.unit.is_empty() { String::new() } else { format!(" {}", r.unit) };
    write!(s, "  values       {}", r.parameters.first().map_or("", |p| p.word()))?;
    writeln!(s, " of mean {}{unit} and standard deviation {}{unit}, {}", r.mean, r.sd, marginal(&r.marginal))?;
    if r.depth_gradient != 0.0 {
        writeln!(s, "               the mean grows by {} of itself a metre of depth", r.depth_gradient)?;
    }
    let [th, tv] = r.theta_m;
    writeln!(s, "  correlation  {:?}, theta_h = {th} m, theta_v = {tv} m", r.correlation)?;
    let ([x, y], [dx, dy], [nx, ny]) = (r.origin_m, r.cell_m, r.cells);
    writeln!(s, "  cells        {nx} x {ny} of {dx} x {dy} m, from ({x}, {y}) m")
}

fn marginal(marginal: &Marginal) -> String {
    match marginal {
        Marginal::Lognormal => "lognormal".to_owned(),
        Marginal::Normal { low_values: LowValues::None } => "normal".to_owned(),
        Marginal::Normal { low_values: LowValues::Floor { floor } } => {
            format!("normal, values below {floor} of the mean raised to it")
        }
        Marginal::Normal { low_values: LowValues::Resample { floor } } => {
            format!("normal, drawn again while a value is below {floor} of the mean")
        }
    }
}

fn built(s: &mut String, r: &FieldReport) -> fmt::Result {
    let (Some(generator), Some(a)) = (&r.generator, &r.accuracy) else {
        return writeln!(s, "  generator    none: nothing varies");
    };
    writeln!(s, "  generator    {generator}; {} normals a field", r.normals)?;
    let how = if a.exact { "exact" } else { "sampled" };
    let [x, y] = a.at_lag_m;
    writeln!(
        s,
        "  errors       {how}: mean 0, variance {:.1e} (allowed {}), correlation {:.1e} at a lag of ({x}, {y}) m (allowed {})",
        a.variance_error, r.allowed[1], a.correlation_error, r.allowed[0]
    )?;
    writeln!(s, "  variance     {:.5} of that of the points is left in the average over a cell", r.target_variance)
}

fn correlations(s: &mut String, r: &FieldReport) -> fmt::Result {
    for (k, axis) in ["along x", "vertical"].into_iter().enumerate() {
        let lags: Vec<&Lag> = r.correlations.iter().filter(|lag| lag.lag_cells[k] > 0).collect();
        if lags.is_empty() {
            continue;
        }
        row(s, &format!("{axis}, lag (m)"), lags.iter().map(|lag| number(lag.lag_m[k])))?;
        row(s, "target correlation", lags.iter().map(|lag| fixed(lag.target)))?;
        if lags.iter().all(|lag| lag.implied[1] - lag.implied[0] < 5e-6) {
            row(s, "implied", lags.iter().map(|lag| fixed(lag.implied[0])))?;
        } else {
            row(s, "implied, lowest", lags.iter().map(|lag| fixed(lag.implied[0])))?;
            row(s, "implied, highest", lags.iter().map(|lag| fixed(lag.implied[1])))?;
        }
    }
    Ok(())
}

fn row(s: &mut String, name: &str, values: impl Iterator<Item = String>) -> fmt::Result {
    let values: String = values.map(|v| format!("{v:>10}")).collect();
    writeln!(s, "    {name:<20}{values}")
}

fn fixed(value: f64) -> String {
    // no minus before a zero
    format!("{:.5}", if value.abs() < 5e-6 { 0.0 } else { value })
}

/// Four figures at most.
fn number(value: f64) -> String {
    format!("{:.4}", value).trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn drawn(s: &mut String, r: &FieldReport) -> fmt::Result {
    const SHOWN: usize = 10;
    for d in r.drawn.iter().take(SHOWN) {
        writeln!(
            s,
            "  realisation {:<4} mean {:.4}, sd {:.4}, {:.4} to {:.4} of the mean; {} cells raised to the floor, {} fields drawn again",
            d.realisation,
            d.mean_factor,
            d.sd_factor,
            d.lowest_factor,
            d.highest_factor,
            d.counts.floored,
            d.counts.redrawn
        )?;
    }
    if let Some(more) = r.drawn.len().checked_sub(SHOWN).filter(|n| *n > 0) {
        writeln!(s, "  and {more} more, in field.json")?;
    }
    let (sampled, expected) = (&r.sampled, &r.expected);
    let floored: u64 = r.drawn.iter().map(|d| d.counts.floored).sum();
    let redrawn: u64 = r.drawn.iter().map(|d| d.counts.redrawn).sum();
    writeln!(
        s,
        "  all {:<9} mean {:.4} +- {:.4} (exact {:.4}), sd {:.4} +- {:.4} (exact {:.4}) of the mean, +- one standard error",
        r.drawn.len(),
        sampled.mean_factor,
        sampled.mean_standard_error,
        expected.mean_factor,
        sampled.sd_factor,
        sampled.sd_standard_error,
        expected.sd_factor
    )?;
    writeln!(
        s,
        "               {floored} cells raised to the floor, {redrawn} fields drawn again; {:.1e} of the cells are expected to be low",
        expected.low_share
    )
}
