//! `timing.json` of an ensemble: what depends on the machine and the hour.

use serde::Serialize;

use super::results::Results;

/// Of the session that wrote it, and of all rows.
#[derive(Clone, Debug, Serialize)]
pub struct Timing {
    /// Of this session: seconds, CPU seconds of the process, workers, realisations done.
    pub wall_s: f64,
    pub cpu_s: Option<f64>,
    pub threads: usize,
    pub realisations: usize,
    /// Part of the time of the workers in which they had nothing to do; `None` without workers.
    pub idle_share: Option<f64>,
    /// Of all rows, whoever made them: seconds, CPU seconds, points moved.
    pub rows_wall_s: f64,
    pub rows_cpu_s: f64,
    pub particle_steps: f64,
    pub particle_steps_per_cpu_s: Option<f64>,
}

/// What a session has used.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spent {
    pub wall_s: f64,
    pub cpu_s: Option<f64>,
    pub threads: usize,
    /// Draws done, and the seconds that workers spent on them.
    pub draws: usize,
    pub busy_s: f64,
    /// Seconds in which there were workers.
    pub working_s: f64,
}

/// The timing of a session and of the rows.
pub fn timing(results: &Results, spent: &Spent) -> Timing {
    let rows_cpu_s: f64 = results.all().filter_map(|d| d.cost.cpu_s).sum();
    let particle_steps: f64 = results.all().filter_map(|d| d.row.work.get("particle_steps")).sum();
    let room = spent.threads as f64 * spent.working_s;
    Timing {
        wall_s: spent.wall_s,
        cpu_s: spent.cpu_s,
        threads: spent.threads,
        realisations: spent.draws,
        idle_share: (spent.draws > 0 && room > 0.0).then(|| (1.0 - spent.busy_s / room).max(0.0)),
        rows_wall_s: results.all().map(|d| d.cost.wall_s).sum(),
        rows_cpu_s,
        particle_steps,
        particle_steps_per_cpu_s: (rows_cpu_s > 0.0).then(|| particle_steps / rows_cpu_s),
    }
}
