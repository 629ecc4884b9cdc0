//! One run of a comparison: to its end, and, where there is a crest, to its onset.

use serde::Serialize;

use super::onset::Onset;
use crate::{
    case::Case,
    fault::Fault,
    run::{self, Limits, Observer, Sample, Status},
    scene::Scene,
    sim::Energies,
    snapshot::Snapshot,
    step::Event,
    study::clock,
    work::Work,
};

/// One run. What is CPU time depends on the machine, all else on the case alone.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    pub realisation: u64,
    pub status: Status,
    pub fault: Option<String>,
    pub events: Vec<Event>,
    /// The onset under gravity that grows slowly: a run of its own.
    pub onset: Option<Onset>,
    pub sliding_distance_m: Option<f64>,
    pub blocks: Option<u64>,
    pub first_block_m: Option<f64>,
    pub censored: bool,
    pub runout_m: f64,
    /// Largest displacement of a point at the end (m).
    pub displacement_m: f64,
    /// Largest displacement of a point at any frame (m), where the case has no crest.
    pub amplitude_m: Option<f64>,
    /// Simulated time at which the run ended (s).
    pub end_time_s: f64,
    pub energy_kj_per_m: Energies,
    pub peak_kinetic_kj_per_m: f64,
    pub work: Work,
    /// CPU time of the whole run (s), without building the scene.
    pub cpu_s: Option<f64>,
    #[serde(skip)]
    pub history: Vec<Sample>,
    #[serde(skip)]
    pub snapshot: Snapshot,
}

/// Keeps the samples, and the largest displacement where there is no sliding distance.
struct Keep {
    samples: Vec<Sample>,
    amplitude: Option<f64>,
}

impl Observer for Keep {
    fn sample(&mut self, sample: &Sample) -> std::io::Result<()> {
        self.samples.push(*sample);
        Ok(())
    }

    fn frame(&mut self, snapshot: &Snapshot) -> std::io::Result<()> {
        self.amplitude = self.amplitude.map(|a| a.max(largest(snapshot)));
        Ok(())
    }

    fn wants_frames(&self) -> bool {
        self.amplitude.is_some()
    }
}

/// Runs a scene to its end.
///
/// # Errors
/// None in practice: nothing is written.
pub fn to_the_end(case: &Case, scene: &mut Scene, realisation: u64, limits: Limits) -> Result<Run, String> {
    let mut keep = Keep { samples: Vec::new(), amplitude: case.slide.is_none().then_some(0.0) };
    let before = clock::thread_seconds();
    let outcome = run::run(case, scene, limits, &mut keep).map_err(|e| e.to_string())?;
    let cpu_s = clock::thread_seconds().zip(before).map(|(b, a)| b - a);
    let (m, snapshot) = (outcome.measures, scene.simulation.snapshot());
    Ok(Run {
        realisation,
        status: outcome.status,
        fault: outcome.fault.as_ref().map(Fault::to_string),
        events: scene.simulation.events().to_vec(),
        onset: None,
        sliding_distance_m: m.sliding_distance_m,
        blocks: m.blocks,
        first_block_m: m.plateaus.first().map(|p| p.sliding_distance_m),
        censored: m.sliding_distance_censored,
        runout_m: m.runout_m,
        displacement_m: largest(&snapshot),
        amplitude_m: keep.amplitude,
        end_time_s: outcome.time,
        energy_kj_per_m: m.energy_kj_per_m,
        peak_kinetic_kj_per_m: keep.samples.iter().map(|s| s.energies.kinetic).fold(0.0, f64::max),
        work: scene.simulation.work.clone(),
        cpu_s,
        history: keep.samples,
        snapshot,
    })
}

/// Largest displacement of a point (m).
fn largest(snapshot: &Snapshot) -> f64 {
    (0..snapshot.len()).map(|i| length(snapshot.displacement(i))).fold(0.0, f64::max)
}

fn length(u: [f64; 2]) -> f64 {
    u[0].hypot(u[1])
}

/// Largest distance between the same points of two runs at their ends, over the largest displacement
/// at any time; `None` where a sliding distance says more, or nothing moved.
pub fn distance(a: &Run, b: &Run) -> Option<f64> {
    let amplitude = a.amplitude_m.zip(b.amplitude_m).map(|(a, b)| a.max(b)).filter(|a| *a > 0.0)?;
    let pairs = a.snapshot.position.iter().zip(&b.snapshot.position);
    let apart = pairs.map(|(p, q)| length([p[0] - q[0], p[1] - q[1]])).fold(0.0, f64::max);
    Some(apart / amplitude)
}
