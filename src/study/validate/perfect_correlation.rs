//! The probability of failure of a slope with a random strength (RFEM), one run for each realisation.
//!
//! With a scale of fluctuation far beyond the slope each realisation is all but uniform, and the probability is known:
//! that of a cohesion with which the uniform slope fails on the same grid. With a short one strong and weak soil
//! average out, and what is left decides: the slope is safer where the variation is low, and less safe where it is
//! high (Griffiths and Fenton 2004).

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    reference::Reference,
    setup::{MEMORY, keys},
    undrained_slopes::{SLOPES, Slope},
};
use crate::{
    case::{self, Case},
    math::stats::{CONFIDENCE, Share, gauss},
    run::{self, Blind, Limits},
    scene::{self, Fields},
    study::{ensemble::realise, strength_reduction, workers},
    work::Work,
};

/// See the module.
pub struct PerfectCorrelation;

impl Problem for PerfectCorrelation {
    fn name(&self) -> &'static str {
        "perfect-correlation"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/perfect-correlation/case.toml"),
            reference: include_str!("../../../validation/perfect-correlation/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let slope = *SLOPES.iter().find(|s| s.key == "gentle_2").ok_or("no such slope")?;
        let (rows, realisations, variations) = match effort {
            Effort::Short => (5, 60, &VARIATIONS[1..2]),
            Effort::Full => (10, 400, &VARIATIONS[..]),
        };
        let plan = Plan { slope, rows, realisations, reference };
        let factor = plan.factor(report)?;
        let mut found = Vec::new();
        for (seed, &v) in (1..).zip(variations) {
            let limit = plan.limit(seed, v, factor, report)?;
            found.push((v.variation, limit.share));
            if let Some(side) = v.side {
                plan.averaged(seed + 10, v, side, &limit, report)?;
            }
        }
        report.figure(probabilities(found, factor));
        Ok(())
    }
}

/// A coefficient of variation, its answer, and what short scales of fluctuation do to the slope.
#[derive(Clone, Copy)]
struct Variation {
    variation: f64,
    published: &'static str,
    side: Option<Side>,
}

#[derive(Clone, Copy)]
enum Side {
    Safer,
    LessSafe,
}

const VARIATIONS: [Variation; 3] = [
    Variation { variation: 0.25, published: "published_0_25", side: None },
    Variation { variation: 0.5, published: "published_0_5", side: Some(Side::Safer) },
    Variation { variation: 1.0, published: "published_1", side: Some(Side::LessSafe) },
];

struct Plan<'a> {
    slope: Slope,
    /// H / h.
    rows: u32,
    realisations: usize,
    reference: &'a Reference,
}

/// What the runs of one set-up have shown.
struct Sample {
    failed: Share,
    /// Fields with whose geometric mean a uniform slope would fail.
    weak: Share,
    /// Runs that ended as a uniform slope with the geometric mean of their field would.
    foretold: Share,
}

/// P[c < mean c / `factor`] for a lognormal c.
///
/// ln c is normal with the mean ln(mean c) - s^2/2 and the deviation s, s^2 = ln(1 + V^2).
fn exact(variation: f64, factor: f64) -> f64 {
    let square = variation.powi(2).ln_1p();
    gauss::cdf((0.5 * square - factor.ln()) / square.sqrt())
}

/// Probability of failure over the variation.
fn probabilities(found: Vec<(f64, f64)>, factor: f64) -> Figure {
    let curve = (1..=120).map(|k| f64::from(k) / 100.0).map(|v| (v, exact(v, factor))).collect();
    Figure::new(
        "Probability of failure of a slope with perfectly correlated strength",
        "one run for each realisation; the standard error of a share p of n is sqrt(p (1 - p) / n)",
        "coefficient of variation",
        "probability of failure",
    )
    .with("realisations", Kind::Points, found)
    .with("exact, with the factor of safety of the grid", Kind::Exact, curve)
}

impl Plan<'_> {
    fn name(&self, v: Variation) -> String {
        format!("V = {:?}, H/h = {}, n = {}", v.variation, self.rows, self.realisations)
    }

    fn case(&self, more: &[(&str, String)]) -> Result<Case, String> {
        let mut set = self.slope.keys(self.rows);
        set.extend(keys(&[("field.strength.cell", format!("{:?}", 10.0 / f64::from(self.rows)))]));
        set.extend(keys(more));
        case::read("case.toml", PerfectCorrelation.files().case, &set).map(|(case, _)| case).map_err(|e| e.to_string())
    }

    /// The slope's own factor of safety, found as failure is in the realisations.
    fn factor(&self, report: &mut Report) -> Result<f64, String> {
        let find = |more: &[(&str, String)]| {
            let case = realise(&self.case(more)?, None);
            let found = strength_reduction::find(&case, MEMORY, Limits::NONE, |_| {}).map_err(|e| format!("{e:?}"))?;
            Ok::<_, String>(found.factor_of_safety)
        };
        let factor = find(&[])?;
        let fine = find(&[("implicit.min_time_step", "2e-3".to_owned())])?;
        let name = format!("H/h = {}", self.rows);
        report.row_of(self.reference, "factor", &name, None, factor)?;
        report.row_of(self.reference, "settings", &name, None, factor / fine)?;
        Ok(factor)
    }

    /// Fields of 100 H: the probability against that of uniform slopes.
    fn limit(&self, seed: u64, v: Variation, factor: f64, report: &mut Report) -> Result<Share, String> {
        let sample = self.sample(seed, v, "theta_long", factor, report)?;
        let (p, n, name) = (exact(v.variation, factor), self.realisations as f64, self.name(v));
        let failed = sample.failed.share;
        report.row_of(self.reference, "limit", &name, Some(p), failed)?;
        report.row_of(self.reference, "deviation", &name, None, (failed - p) / (p * (1.0 - p) / n).sqrt())?;
        report.row_of(self.reference, v.published, &name, None, failed)?;
        report.row_of(self.reference, "weak", &name, None, sample.weak.share)?;
        report.row_of(self.reference, "foretold", &name, None, sample.foretold.share)?;
        Ok(sample.failed)
    }

    /// Fields of H / 2: which side of the limit the probability lies on.
    fn averaged(&self, seed: u64, v: Variation, side: Side, limit: &Share, report: &mut Report) -> Result<(), String> {
        let sample = self.sample(seed, v, "theta_short", 1.0, report)?;
        let (name, more) = (self.name(v), sample.failed.minus(limit));
        report.row_of(self.reference, "short", &name, None, sample.failed.share)?;
        match side {
            Side::Safer => report.row_of(self.reference, "safer", &name, None, more.high),
            Side::LessSafe => report.row_of(self.reference, "less_safe", &name, None, more.low),
        }
    }

    /// Runs all realisations of a set-up with the scale of fluctuation that the reference gives. A `seed` of its own
    /// makes it independent of the others.
    fn sample(&self, seed: u64, v: Variation, theta: &str, factor: f64, report: &mut Report) -> Result<Sample, String> {
        let theta = format!("{:?}", self.reference.given(theta)?);
        let case = self.case(&[
            ("seed", seed.to_string()),
            ("field.strength.variation", format!("{:?}", v.variation)),
            ("field.strength.theta_h", theta.clone()),
            ("field.strength.theta_v", theta),
        ])?;
        let fields = Fields::of(&case).map_err(|e| e.to_string())?;
        let jobs: Vec<u64> = (0..self.realisations as u64).collect();
        let work = |k: &u64| attempt(&realise(&case, Some(*k)), &fields, factor);
        let runs = workers::all(0, &jobs, &|_, _| {}, &work)?;
        runs.iter().for_each(|run| report.count_work(&run.work));
        let share = |test: fn(&Attempt) -> bool| {
            let count = runs.iter().filter(|run| test(run)).count();
            Share::wilson(count, runs.len(), CONFIDENCE).ok_or("no realisations")
        };
        Ok(Sample {
            failed: share(|run| run.failed)?,
            weak: share(|run| run.weak)?,
            foretold: share(|run| run.failed == run.weak)?,
        })
    }
}

/// One realisation.
struct Attempt {
    failed: bool,
    /// Whether a uniform slope with the geometric mean of its field would fail.
    weak: bool,
    work: Work,
}

fn attempt(case: &Case, fields: &Fields, factor: f64) -> Result<Attempt, String> {
    let drawn = fields.draw(case).map_err(|e| e.to_string())?;
    let factors: Vec<f64> = drawn.into_iter().flat_map(|d| d.factors).collect();
    let mean_log = factors.iter().map(|f| f.ln()).sum::<f64>() / factors.len() as f64;
    let mut scene = scene::build_with(case, MEMORY, fields).map_err(|e| e.to_string())?;
    let outcome = run::run(case, &mut scene, Limits::NONE, &mut Blind).map_err(|e| e.to_string())?;
    let realisation = case.ensemble.realisation;
    let failed = strength_reduction::has_failed(&outcome)
        .ok_or_else(|| format!("realisation {realisation} shows neither failure nor stand: {}", outcome.message))?;
    Ok(Attempt { failed, weak: mean_log < -factor.ln(), work: scene.simulation.work })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published factor of safety has three digits: 1.47 is anything from 1.465 to 1.475.
    #[test]
    fn the_limit_is_that_of_a_lognormal_strength() {
        let reference = Reference::read(PerfectCorrelation.files().reference).unwrap();
        for v in VARIATIONS {
            let published = reference.exact(v.published).unwrap();
            assert!((exact(v.variation, 1.475)..=exact(v.variation, 1.465)).contains(&published), "{published}");
        }
        // the median of a lognormal strength is mean / sqrt(1 + V^2)
        for variation in [0.25, 0.5, 1.0f64] {
            assert!((exact(variation, (1.0 + variation * variation).sqrt()) - 0.5).abs() < 1e-12);
        }
    }
}
