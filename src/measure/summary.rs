//! All measures of a finished run.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{
    blocks::{Plateau, plateaus},
    onset::InitialFailure,
    probe::Reading,
    slide::{SlideProbe, max_displacement, runout, slide_volume},
};
use crate::{case, sim::Energies, snapshot::Snapshot};

/// What a run came to. The names are those of `record.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Measures {
    /// r; 0 where nothing slid, absent where the case has no crest.
    pub sliding_distance_m: Option<f64>,
    /// r for each threshold on the displacement (m), and by residual strength at the surface.
    pub sliding_distance_at: BTreeMap<String, f64>,
    /// Whether r has reached the wall.
    pub sliding_distance_censored: bool,
    /// When failure began (s), where it did and the run has a crest.
    pub onset_time_s: Option<f64>,
    /// Whether the soil has moved, since the onset, by the lowest of `slide.initial_levels`. Absent without
    /// a crest, and without inertia: equilibrium knows no motion.
    pub slope_failed: Option<bool>,
    /// What had moved when the displacement since the onset reached each level.
    pub initial_failure: Vec<InitialFailure>,
    /// Plateaus of r(t).
    pub blocks: Option<u64>,
    pub plateaus: Vec<Plateau>,
    pub slide_volume_m3_per_m: Option<f64>,
    pub runout_m: f64,
    /// Largest displacement of a point.
    pub max_displacement_m: f64,
    pub energy_kj_per_m: Energies,
    /// Relative change of total mass.
    pub mass_error: f64,
    /// Momentum against the impulses on the body, over weight x time, by axis.
    pub momentum_error: [f64; 2],
    /// What the probes of the case read, in its order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<Reading>,
    /// Groups of points that share no node, at the start and at the end: more at the end have parted numerically.
    pub pieces: [u64; 2],
    /// Points in each stage of the law: elastic, unloading, softening, residual.
    pub stage_points: [u64; 4],
}

/// r(t) of a run, for the blocks.
#[derive(Clone, Debug, Default)]
pub struct SlideHistory {
    pub time: Vec<f64>,
    pub distance: Vec<f64>,
}

/// The slide at the end of a run.
pub struct Slid<'a> {
    pub keys: &'a case::Slide,
    pub probe: &'a SlideProbe,
    /// Displacement that counts, by identity (m): the whole one, or in small strain that since the onset.
    pub displacement: &'a [[f64; 2]],
    pub history: &'a SlideHistory,
}

/// The measures of the last snapshot of a run. `residual_strain` is the plastic strain at which
/// the weakest-softening material is residual, where one softens.
pub fn measures(s: &Snapshot, energies: Energies, slide: Option<&Slid<'_>>, residual_strain: Option<f64>) -> Measures {
    let threshold = slide.map_or(0.0, |slid| slid.keys.threshold);
    let mut m = Measures {
        runout_m: runout(s, threshold),
        max_displacement_m: max_displacement(s),
        energy_kj_per_m: energies,
        ..Measures::default()
    };
    for stage in &s.stage {
        m.stage_points[*stage as usize] += 1;
    }
    if let Some(slid) = slide {
        add_slide(&mut m, s, slid);
        if let Some(strain) = residual_strain {
            m.sliding_distance_at.insert("residual_strength".to_owned(), slid.probe.by_plastic_strain(s, strain));
        }
    }
    m
}

fn add_slide(m: &mut Measures, s: &Snapshot, slid: &Slid<'_>) {
    let Slid { keys, probe, displacement, history } = *slid;
    for threshold in std::iter::once(&keys.threshold).chain(&keys.also) {
        m.sliding_distance_at.insert(format!("{threshold}"), probe.by_displacement(displacement, *threshold));
    }
    let r = probe.by_displacement(displacement, keys.threshold);
    m.sliding_distance_m = Some(r);
    m.sliding_distance_censored = r > keys.censored_above;
    m.plateaus = plateaus(&history.time, &history.distance, keys.block_hold, keys.block_length);
    m.blocks = Some(m.plateaus.len() as u64);
    m.slide_volume_m3_per_m = Some(slide_volume(s, keys.threshold));
}
