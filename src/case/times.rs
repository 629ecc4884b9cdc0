//! Times at which what acts on the soil has its final value, and the keys of the time step.

use super::{Case, Drive, GravitySchedule, Scheme};

impl Case {
    /// Time from which gravity has its final value (s).
    pub fn gravity_end(&self) -> f64 {
        match self.gravity.schedule {
            GravitySchedule::None | GravitySchedule::AtOnce => 0.0,
            GravitySchedule::Ramp { ramp_time } => ramp_time,
            GravitySchedule::NormalFirst { ramp_time, settle_time, tangential_time, .. } => {
                ramp_time + settle_time + tangential_time
            }
            GravitySchedule::ElasticFirst { ramp_time, settle_time, .. } => ramp_time + settle_time,
        }
    }

    /// Time from which gravity and all loads have their final values and nothing is driven (s);
    /// infinite where a drive goes on.
    pub fn loading_end(&self) -> f64 {
        let loads = self.load.iter().map(|load| load.ramp_time);
        let drives = self.drive.iter().map(drive_end);
        loads.chain(drives).fold(self.gravity_end(), f64::max)
    }

    /// The keys that set the length of a step, for messages.
    pub fn step_keys(&self) -> &'static str {
        match self.solver.scheme {
            Scheme::Explicit => "`explicit.courant` (or `explicit.time_step`)",
            Scheme::Implicit => "`implicit.time_step` and `implicit.min_time_step`",
        }
    }
}

fn drive_end(drive: &Drive) -> f64 {
    let moves = [drive.velocity_x, drive.velocity_y].iter().flatten().any(|v| *v != 0.0);
    if moves { drive.until.unwrap_or(f64::INFINITY) } else { 0.0 }
}
