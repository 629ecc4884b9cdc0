//! What the figures of a study say and do not say.

use super::{ArmReport, Figures};

/// Remarks on all arms.
pub fn remarks(arms: &[ArmReport]) -> Vec<String> {
    let mut text: Vec<String> = arms.iter().filter_map(against_source).collect();
    text.extend(trend(arms));
    text.extend(arms.iter().filter_map(wall));
    text.extend(arms.iter().filter_map(rfem));
    text.extend(failures(arms));
    text.push(
        "Every mean stands with its standard error. After failure a single realisation may move by a whole block where its strength moves by a hair, so only ensembles are compared.".to_owned(),
    );
    text
}

/// Ours against a source: the source gives no standard error, so ours stands for both.
fn against_source(arm: &ArmReport) -> Option<String> {
    let expected = arm.arm.expect.as_ref()?;
    let ours = arm.rmpm.sliding_distance_m.as_ref()?;
    let mean = expected.mean?;
    let error = std::f64::consts::SQRT_2 * ours.mean_se;
    let apart = (ours.mean - mean) / error;
    let verdict = match apart.abs() {
        a if a <= 2.0 => "within two standard errors of each other",
        _ => "further apart than chance explains: a choice that the source leaves open, or the model, differs",
    };
    Some(format!(
        "{}: mean r {:.2} +- {:.2} m against {mean:.2} m ({}); the difference is {apart:.1} standard errors (ours taken for both): {verdict}.",
        arm.arm.name, ours.mean, ours.mean_se, expected.source
    ))
}

/// How mean and sd move over the arms of a group.
fn trend(arms: &[ArmReport]) -> Vec<String> {
    let mut groups: Vec<&str> = Vec::new();
    for group in arms.iter().map(|a| a.arm.group.as_str()).filter(|g| !g.is_empty()) {
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    groups.into_iter().filter_map(|group| group_trend(group, arms)).collect()
}

fn group_trend(group: &str, arms: &[ArmReport]) -> Option<String> {
    let own: Vec<&ArmReport> = arms.iter().filter(|a| a.arm.group == group).collect();
    let (first, last) = (own.first()?, own.last()?);
    let (a, b) = (first.rmpm.sliding_distance_m.as_ref()?, last.rmpm.sliding_distance_m.as_ref()?);
    if own.len() < 2 || a.sd <= 0.0 || b.sd <= 0.0 {
        return None;
    }
    let ratio = b.sd / a.sd;
    // relative errors of a quotient of independent estimates
    let error = ratio * (a.sd_se / a.sd).hypot(b.sd_se / b.sd);
    let shift = b.mean - a.mean;
    let shift_error = a.mean_se.hypot(b.mean_se);
    Some(format!(
        "{group}, from \"{}\" to \"{}\": sd of r by a factor of {ratio:.2} +- {error:.2}; mean by {shift:+.2} +- {shift_error:.2} m{}.",
        first.arm.name,
        last.arm.name,
        if shift.abs() < 2.0 * shift_error { ", which chance alone may do" } else { "" }
    ))
}

fn wall(arm: &ArmReport) -> Option<String> {
    let Figures { at_wall, censored_fit, sliding_distance_m, .. } = &arm.rmpm;
    let (share, fit, plain) = (at_wall.as_ref()?, censored_fit.as_ref()?, sliding_distance_m.as_ref()?);
    (share.count > 0).then(|| {
        format!(
            "{}: {} of {} slides reach the wall, so r is cut off there; a normal distribution with these (and r = 0) as limits has mean {:.2} +- {:.2} and sd {:.2} +- {:.2} m, where the plain ones are {:.2} and {:.2} m.",
            arm.arm.name, share.count, share.n, fit.mean, fit.mean_se, fit.sd, fit.sd_se, plain.mean, plain.sd
        )
    })
}

fn rfem(arm: &ArmReport) -> Option<String> {
    let pairs = arm.pairs.as_ref()?;
    let (shorter, difference) = (pairs.rfem_shorter.as_ref()?, pairs.difference_m.as_ref()?);
    let ratio = pairs.ratio_of_means.map_or(String::new(), |r| format!(", {:.0} % of RMPM's", 100.0 * r));
    let first = pairs.first_slide_difference_m.as_ref().map_or(String::new(), |d| {
        format!(" Against RMPM's first slide alone it differs by {:+.2} +- {:.2} m.", d.mean, d.mean_se)
    });
    Some(format!(
        "{}: RFEM on the same fields is shorter in {} of {} realisations ({:.0} %, 95 % interval {:.0} to {:.0} %), by {:.2} +- {:.2} m in the mean{ratio}.{first}",
        arm.arm.name,
        shorter.count,
        shorter.n,
        100.0 * shorter.share,
        100.0 * shorter.low,
        100.0 * shorter.high,
        difference.mean,
        difference.mean_se
    ))
}

fn failures(arms: &[ArmReport]) -> Option<String> {
    let failed = |f: &Figures| f.failed;
    let n: usize = arms.iter().map(|a| failed(&a.rmpm) + a.rfem.as_ref().map_or(0, failed)).sum();
    (n > 0).then(|| {
        format!("{n} runs failed and are left out of the statistics; ensemble.csv of their arm holds the reasons.")
    })
}
