//! The figures of a run that are compared, in the order of the table. One that no run has is left
//! out.

use super::single::Run;
use crate::run::Status;

/// A number of a run.
pub struct Figure {
    /// Its name in `compare.json` and `compare.csv`.
    pub name: &'static str,
    /// In words.
    pub words: &'static str,
    /// Decimals in the table.
    pub digits: usize,
    pub of: fn(&Run) -> Option<f64>,
}

const fn figure(name: &'static str, words: &'static str, digits: usize, of: fn(&Run) -> Option<f64>) -> Figure {
    Figure { name, words, digits, of }
}

/// All of them.
pub const FIGURES: &[Figure] = &[
    figure("onset_kn_m3", "onset: unit weight at 0.25 m (kN/m3)", 2, |r| r.onset.as_ref()?.unit_weight_kn_m3),
    figure("stability_lost_kn_m3", "  equilibrium lost at (kN/m3)", 2, |r| r.onset.as_ref()?.stability_lost_kn_m3),
    figure("onset_steps", "  steps to the onset", 0, |r| Some(r.onset.as_ref()?.work.steps as f64)),
    figure("onset_cpu_s", "  CPU seconds to the onset", 2, |r| r.onset.as_ref()?.cpu_s),
    figure("first_block_m", "first block (m)", 2, |r| r.first_block_m),
    figure("sliding_distance_m", "sliding distance r (m)", 2, |r| r.sliding_distance_m),
    figure("blocks", "blocks", 1, |r| r.blocks.map(|b| b as f64)),
    figure("runout_m", "run-out (m)", 2, |r| r.sliding_distance_m.map(|_| r.runout_m)),
    figure("displacement_m", "largest displacement (m)", 3, |r| Some(r.displacement_m)),
    figure("amplitude_m", "  at any time (m)", 3, |r| r.amplitude_m),
    figure("rest_time_s", "at rest (s)", 2, |r| (r.status == Status::AtRest).then_some(r.end_time_s)),
    figure("external_kj_per_m", "energy supplied (kJ/m)", 2, |r| Some(r.energy_kj_per_m.external)),
    figure("dissipated_kj_per_m", "  dissipated (kJ/m)", 2, |r| Some(r.energy_kj_per_m.dissipated)),
    figure("strain_kj_per_m", "  elastic at the end (kJ/m)", 2, |r| Some(r.energy_kj_per_m.strain)),
    figure("kinetic_kj_per_m", "  kinetic at the end (kJ/m)", 2, |r| Some(r.energy_kj_per_m.kinetic)),
    figure("numerical_kj_per_m", "  numerical (kJ/m)", 2, |r| Some(r.energy_kj_per_m.numerical)),
    figure("peak_kinetic_kj_per_m", "  largest kinetic (kJ/m)", 2, |r| Some(r.peak_kinetic_kj_per_m)),
    figure("steps", "steps", 0, |r| Some(r.work.steps as f64)),
    figure("rejected_steps", "  rejected", 0, |r| Some(r.work.rejected_steps as f64)),
    figure("newton_iterations", "  Newton iterations", 0, |r| Some(r.work.newton_iterations as f64)),
    figure("factorisations", "  factorisations", 0, |r| Some(r.work.factorisations as f64)),
    figure("particle_steps", "particle-steps", 0, |r| Some(r.work.particle_steps as f64)),
    figure("cpu_s", "CPU seconds to the end", 2, |r| r.cpu_s),
];
