//! Twenty times gravity in one step: points whose volume would become negative, or that would leave the grid.

use super::{super::remedy::Bench, HardCases, played::Played};
use crate::study::validate::Problem;

/// Steps of the case (s); as the shortest step too, none is cut.
const STEP: &str = "0.05";

pub(super) fn play(bench: &mut Bench<'_>) -> Result<(), String> {
    let regimes: &[&str] = match bench.is_full() {
        false => &["quasi_static", "auto"],
        true => &["quasi_static", "auto", "newmark", "hht", "backward_euler"],
    };
    for regime in regimes {
        let key = format!("implicit.regime={regime}");
        let cut = crushed(bench, &format!("20 g, {regime}"), std::slice::from_ref(&key))?;
        let uncut = [key, format!("implicit.min_time_step={STEP}")];
        let uncut = crushed(bench, &format!("20 g, {regime}, no step cut"), &uncut)?;
        let what =
            ["det F <= 0, off the grid", "step cut", "implicit", &format!("share of the time reached, {regime}")];
        bench.line(what, uncut, cut);
    }
    explicit(bench)
}

/// There is no switch for the cut of explicit steps: the step is the one that the waves allow, or far too long.
fn explicit(bench: &mut Bench<'_>) -> Result<(), String> {
    let scheme = "solver.scheme=explicit".to_owned();
    let bound = crushed(bench, "20 g, explicit", std::slice::from_ref(&scheme))?;
    let long = [scheme, "explicit.time_step=0.2".to_owned()];
    let long = crushed(bench, "20 g, explicit, steps of 0.2 s", &long)?;
    bench.line(
        ["det F <= 0, off the grid", "Courant step for 0.2 s", "explicit", "share of the time reached"],
        long,
        bound,
    );
    Ok(())
}

fn crushed(bench: &mut Bench<'_>, name: &str, set: &[String]) -> Result<f64, String> {
    let end = Played::of(HardCases.files().case, set)?;
    end.rows(name, bench)?;
    Ok(end.share)
}
