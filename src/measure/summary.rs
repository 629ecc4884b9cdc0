//! All measures of a finished run.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{
    blocks::{Plateau, plateaus},
    slide::{SlideProbe, runout, slide_volume},
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
    /// Plateaus of r(t).
    pub blocks: Option<u64>,
    pub plateaus: Vec<Plateau>,
    pub slide_volume_m3_per_m: Option<f64>,
    pub runout_m: f64,
    pub energy_kj_per_m: Energies,
    /// Relative change of total mass.
    pub mass_error: f64,
    /// Momentum against the impulses on the body, over weight x time, by axis.
    pub momentum_error: [f64; 2],
    /// Points in each stage of the law: elastic, unloading, softening, residual.
    pub stage_points: [u64; 4],
}

/// r(t) of a run, for the blocks.
#[derive(Clone, Debug, Default)]
pub struct SlideHistory {
    pub time: Vec<f64>,
    pub distance: Vec<f64>,
}

/// The measures of the last snapshot of a run. `residual_strain` is the plastic strain at which
/// the weakest-softening material is residual, where one softens.
pub fn measures(
    s: &Snapshot,
    energies: Energies,
    slide: Option<(&case::Slide, &SlideProbe)>,
    history: &SlideHistory,
    residual_strain: Option<f64>,
) -> Measures {
    let threshold = slide.map_or(0.0, |(keys, _)| keys.threshold);
    let mut m = Measures { runout_m: runout(s, threshold), energy_kj_per_m: energies, ..Measures::default() };
    for stage in &s.stage {
        m.stage_points[*stage as usize] += 1;
    }
    if let Some((keys, probe)) = slide {
        add_slide(&mut m, s, keys, probe, history);
        if let Some(strain) = residual_strain {
            m.sliding_distance_at.insert("residual_strength".to_owned(), probe.by_plastic_strain(s, strain));
        }
    }
    m
}

fn add_slide(m: &mut Measures, s: &Snapshot, keys: &case::Slide, probe: &SlideProbe, history: &SlideHistory) {
    let u: Vec<[f64; 2]> = (0..s.len()).map(|i| s.displacement(i)).collect();
    for threshold in std::iter::once(&keys.threshold).chain(&keys.also) {
        m.sliding_distance_at.insert(format!("{threshold}"), probe.by_displacement(&u, *threshold));
    }
    let r = probe.by_displacement(&u, keys.threshold);
    m.sliding_distance_m = Some(r);
    m.sliding_distance_censored = r > keys.censored_above;
    m.plateaus = plateaus(&history.time, &history.distance, keys.block_hold, keys.block_length);
    m.blocks = Some(m.plateaus.len() as u64);
    m.slide_volume_m3_per_m = Some(slide_volume(s, keys.threshold));
}
