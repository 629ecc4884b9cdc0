//! An ensemble in figures: r with its errors, the shares that bound it, the slide's volume, the cost.

use serde::Serialize;

use crate::{
    math::stats::{Bootstrap, CensoredFit, Censoring, Moments, Share},
    study::ensemble::{CENSORED, Ended, SLIDE_VOLUME, SLIDING_DISTANCE, resolution},
};

/// What an ensemble has come to.
#[derive(Clone, Debug, Serialize)]
pub struct Figures {
    pub realisations: usize,
    pub failed: usize,
    /// r (m) over the realisations that did not fail.
    pub sliding_distance_m: Option<Moments>,
    /// A normal distribution of which values at the wall, and r = 0, are only known as limits.
    pub censored_fit: Option<CensoredFit>,
    /// Share without a slide, and at the wall.
    pub no_slide: Option<Share>,
    pub at_wall: Option<Share>,
    /// r (m) with everything random at its mean.
    pub deterministic_m: Option<f64>,
    pub slide_volume_m3_per_m: Option<Moments>,
    pub cpu_s: f64,
    pub particle_steps: f64,
    #[serde(skip)]
    pub values: Vec<f64>,
    /// r above this (m) has reached the wall.
    pub wall_m: Option<f64>,
    /// Step in which r comes (m).
    #[serde(skip)]
    pub resolution_m: f64,
}

impl Figures {
    /// Of an ensemble.
    pub fn of(ended: &Ended) -> Self {
        let results = &ended.results;
        let values = results.values(SLIDING_DISTANCE);
        let wall = results.case.slide.as_ref().map(|s| s.censored_above);
        let bootstrap = Bootstrap::default();
        let censoring = Censoring { low: Some(0.0), high: wall };
        Figures {
            realisations: results.rows.len(),
            failed: results.failed(),
            sliding_distance_m: results.moments(SLIDING_DISTANCE, &bootstrap),
            censored_fit: CensoredFit::of(&values, &censoring).ok(),
            no_slide: Share::of(&values, |r| r == 0.0),
            at_wall: Share::of(&results.values(CENSORED), |censored| censored > 0.0),
            deterministic_m: results.mean.as_ref().and_then(|d| d.row.measure(SLIDING_DISTANCE)),
            slide_volume_m3_per_m: results.moments(SLIDE_VOLUME, &bootstrap),
            cpu_s: ended.report.timing.rows_cpu_s,
            particle_steps: results.all().filter_map(|d| d.row.work.get("particle_steps")).sum(),
            wall_m: wall,
            resolution_m: resolution(&results.case),
            values,
        }
    }
}
