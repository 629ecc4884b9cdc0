//! A block on an incline: the tangent at which it starts to slide.

use super::super::{incline::Incline, remedy::Bench, setup::keys};

/// (m)
const H: f64 = 0.5;

pub(super) fn play(bench: &mut Bench<'_>) -> Result<(), String> {
    let held = keys(&[("boundary.base.separation", "false".to_owned())]);
    for (scheme, key) in [("explicit", "watched"), ("implicit", "still")] {
        let [without, with] = [steepest(bench, scheme, &held)?, steepest(bench, scheme, &[])?];
        let what = |figure| ["stick-slip", "base that may open", scheme, figure];
        bench.line(what("threshold over mu, error"), without.0, with.0);
        bench.judge(key, "base that may open", with.0)?;
        bench.judge(key, "closed base", without.0)?;
        if scheme == "implicit" {
            bench.line(what("Newton iterations up to the slide"), without.1, with.1);
        }
    }
    bench.report.note("stick-slip: the remedy is the consistent tangent of the contact, which has no switch; the two contacts that there are stand beside each other. No regularised friction is offered");
    Ok(())
}

/// Error of the tangent over mu, and the Newton iterations.
fn steepest(bench: &mut Bench<'_>, scheme: &str, more: &[String]) -> Result<(f64, f64), String> {
    bench.aside(&Incline, |reference, report| {
        let mu = reference.exact("threshold")?;
        let tangent = match scheme {
            "explicit" => Incline.steepest_watched(H, more, reference, report)?,
            _ => Incline.steepest_still(H, more, reference, report)?,
        };
        Ok(((tangent / mu - 1.0).abs(), report.cost.newton_iterations as f64))
    })
}
