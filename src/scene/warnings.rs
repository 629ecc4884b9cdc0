//! What a scene should tell its user before the run.

use serde::Serialize;

use crate::{
    case::{self, Case, GravitySchedule},
    sim::Simulation,
};

/// Where the model or the answer is to be taken with care.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Warning {
    pub code: String,
    pub text: String,
    /// The key of the case that it is about.
    pub key: String,
}

impl Warning {
    /// A warning about a key.
    pub fn new(code: &str, key: &str, text: String) -> Self {
        Warning { code: code.to_owned(), key: key.to_owned(), text }
    }
}

/// Bytes of a frame, a point.
const FRAME_BYTES: f64 = 200.0;
/// Bytes of output from which a run is warned of.
const MUCH: f64 = 4e9;

/// All warnings of a scene.
pub fn list(case: &Case, simulation: &mut Simulation) -> Vec<Warning> {
    [time_step(case, simulation), short(case), large_output(case, simulation), jitter(case), given_stress(case)]
        .into_iter()
        .flatten()
        .collect()
}

fn time_step(case: &Case, simulation: &mut Simulation) -> Option<Warning> {
    let fixed = case.explicit.time_step?;
    let limit = simulation.stable_dt()? / case.explicit.courant;
    (fixed > limit).then(|| {
        Warning::new(
            "unstable_time_step",
            "explicit.time_step",
            format!("{fixed} s is longer than the stable step of about {limit:.2e} s"),
        )
    })
}

fn short(case: &Case) -> Option<Warning> {
    let loading = match case.gravity.schedule {
        GravitySchedule::None | GravitySchedule::AtOnce => 0.0,
        GravitySchedule::Ramp { ramp_time } => ramp_time,
        GravitySchedule::NormalFirst { ramp_time, settle_time, tangential_time, .. } => {
            ramp_time + settle_time + tangential_time
        }
        GravitySchedule::ElasticFirst { ramp_time, settle_time, .. } => ramp_time + settle_time,
    };
    (case.end.time <= loading).then(|| {
        Warning::new(
            "ends_while_loading",
            "end.time",
            format!("the run ends at {} s, before gravity has its final value at {loading} s", case.end.time),
        )
    })
}

fn large_output(case: &Case, simulation: &Simulation) -> Option<Warning> {
    let bytes = case.end.time / case.output.frames * FRAME_BYTES * simulation.body.len() as f64;
    (bytes > MUCH).then(|| {
        Warning::new("large_output", "output.frames", format!("the frames may take up to {:.0} GB", bytes / 1e9))
    })
}

fn jitter(case: &Case) -> Option<Warning> {
    let strong = case.material.values().any(|m| matches!(m, case::Material::VonMises { .. }));
    (case.jitter.strength > 0.0 && !strong).then(|| {
        Warning::new("jitter_without_strength", "jitter.strength", "no material has a strength to vary".into())
    })
}

fn given_stress(case: &Case) -> Option<Warning> {
    matches!(case.initial_stress, case::InitialStress::Given { .. }).then(|| {
        Warning::new(
            "given_stress",
            "initial_stress.kind",
            "the given stress is taken as it is; where it does not balance the loads the body moves at once".into(),
        )
    })
}
