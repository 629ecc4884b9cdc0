//! What an ensemble says about the sliding distance r: fits, shares, exceedance.

use serde::Serialize;

use super::{
    measures::{CENSORED, SLIDING_DISTANCE},
    results::Results,
};
use crate::{
    case::{Case, Slide},
    math::stats::{CONFIDENCE, CensoredFit, Censoring, Exceed, Exceedance, Goodness, NormalFit, NormalTest, Share},
};

/// Statistics of r (m) over the realisations that did not fail.
#[derive(Clone, Debug, Serialize)]
pub struct SlideStatistics {
    /// Realisations with r = 0, and those that have reached the wall.
    pub no_slide: Option<Share>,
    pub censored: Option<Share>,
    /// The normal of the values as they are.
    pub normal: Option<NormalFit>,
    /// The normal of which r = 0 and the wall hide the tails.
    pub censored_normal: Option<CensoredFit>,
    /// How well the latter fits.
    pub goodness: Option<Goodness>,
    /// P(r > R) at whole metres, up to the wall.
    pub exceedance: Vec<Exceed>,
    /// Why something is not there.
    pub remarks: Vec<String>,
}

/// From where on r tells a side only.
pub fn censoring(slide: &Slide) -> Censoring {
    Censoring { low: Some(0.0), high: Some(slide.censored_above) }
}

/// The step in which r comes: the mean distance of the columns of points (m).
pub fn resolution(case: &Case) -> f64 {
    case.grid.cell / case.points.per_axis.max(1) as f64
}

/// P(r > R), where it is known.
pub fn exceedance(results: &Results) -> Option<Exceedance> {
    let high = results.case.slide.as_ref()?.censored_above;
    Exceedance::of(&results.values(SLIDING_DISTANCE), Some(high), CONFIDENCE)
}

/// The statistics; `None` where the case has no crest or nothing is done.
pub fn statistics(results: &Results) -> Option<SlideStatistics> {
    let slide = results.case.slide.as_ref()?;
    let r = results.values(SLIDING_DISTANCE);
    if r.is_empty() {
        return None;
    }
    let censoring = censoring(slide);
    let mut remarks = Vec::new();
    if results.rows.values().any(|done| done.row.antithetic.is_some()) {
        remarks.push(
            "realisations come in opposite pairs: the errors of the means are those of pairs, all other errors, intervals and p-values take realisations as independent".to_owned(),
        );
    }
    let redrawn = results.rows.values().filter(|d| d.row.work.get("redrawn_fields").is_some_and(|n| *n > 0.0)).count();
    if redrawn > 0 {
        remarks.push(format!(
            "{redrawn} realisations had fields drawn again (low_values = \"resample\"): they are stronger than the distribution that was asked for"
        ));
    }
    let fit = CensoredFit::of(&r, &censoring).map_err(|e| remarks.push(format!("no censored normal: {e}"))).ok();
    let test = NormalTest { censoring, resolution: resolution(&results.case), ..NormalTest::default() };
    // a test of what cannot be fitted has the same reason not to be
    let goodness = fit.and_then(|_| test.of(&r).map_err(|e| remarks.push(format!("no test: {e}"))).ok());
    Some(SlideStatistics {
        no_slide: Share::of(&r, |v| v == 0.0),
        censored: Share::of(&results.values(CENSORED), |v| v > 0.0),
        normal: NormalFit::of(&r),
        censored_normal: fit,
        goodness,
        exceedance: exceedance(results).map_or(Vec::new(), |curve| at_whole_metres(&curve)),
        remarks,
    })
}

/// A table from 0 to the largest r.
fn at_whole_metres(curve: &Exceedance) -> Vec<Exceed> {
    const MOST: f64 = 1000.0;
    let last = curve.range().1.ceil().clamp(0.0, MOST) as u32;
    (0..=last).filter_map(|metres| curve.at(f64::from(metres))).collect()
}
