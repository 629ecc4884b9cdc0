//! What a scene should tell its user before the run.

use serde::Serialize;

use super::softening;
use crate::{
    case::{self, Case, GravitySchedule, Regime, Scheme},
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
    let mut found = vec![time_step(case, simulation), short(case), large_output(case, simulation)];
    found.extend([jitter(case), given_stress(case), short_load(case), narrow_drive(case)]);
    found.extend(case.material.iter().map(|(name, m)| unresolved_softening(case, name, m)));
    if case.solver.scheme == Scheme::Implicit {
        found.extend([still_damping(case), settle_damping(case), small_strain(case), idle_motion(case)]);
    }
    found.into_iter().flatten().collect()
}

/// Values of random fields that stopped at a limit of their parameter.
pub fn limited(points: u64) -> Option<Warning> {
    (points > 0).then(|| {
        let text = format!(
            "{points} values of the fields stopped at a limit (residual strength at the peak strength, Poisson's ratio at +-0.49)"
        );
        Warning::new("limited_values", "field", text)
    })
}

/// A field that was drawn again until it had no low value is one of a choice, not of the distribution.
pub fn redrawn(fields: &[super::FieldNote]) -> Vec<Warning> {
    let again = fields.iter().filter(|f| f.counts.redrawn > 0);
    again
        .map(|f| {
            let text = format!(
                "field `{}` was drawn {} times until no cell was below the floor: such fields are stronger than the distribution that was asked for",
                f.name,
                f.counts.redrawn + 1
            );
            Warning::new("redrawn_field", &format!("field.{}.low_values", f.name), text)
        })
        .collect()
}

/// Small strain draws any displacement, and means only small ones.
fn small_strain(case: &Case) -> Option<Warning> {
    (case.solver.kinematics == crate::case::Kinematics::Small).then(|| {
        let text = "small strain: forces stay where the points started; displacements of more than part of a cell are drawn, not meant. Sliding distance and volume are those of what has moved since the onset of failure, read at slide.initial_level; without an onset they are 0";
        Warning::new("small_strain", "solver.kinematics", text.into())
    })
}

/// Without inertia a body does not move on.
fn idle_motion(case: &Case) -> Option<Warning> {
    let moving = |r: &crate::case::Region| r.velocity != [0.0; 2] || r.spin.is_some() || r.wave.is_some();
    let region = case.region.iter().position(moving)?;
    (case.implicit.regime == Regime::QuasiStatic).then(|| {
        let text = "regime = \"quasi_static\" has no inertia: the initial velocity is not used";
        Warning::new("idle_motion", &format!("region.{region}.velocity"), text.into())
    })
}

/// Damping works on a velocity, and equilibrium has none.
fn still_damping(case: &Case) -> Option<Warning> {
    let key = if case.damping.local > 0.0 { "damping.local" } else { "damping.viscous" };
    let damped = case.damping.local > 0.0 || case.damping.viscous > 0.0;
    if case.damping.local > 0.0 {
        let text = "local damping is a remedy of the explicit scheme: the implicit one does not use it";
        return Some(Warning::new("local_damping_unused", key, text.into()));
    }
    (damped && case.implicit.regime == Regime::QuasiStatic)
        .then(|| Warning::new("damping_without_motion", key, "regime = \"quasi_static\" has no inertia to damp".into()))
}

/// The implicit scheme finds the in-situ state by equilibrium.
fn settle_damping(case: &Case) -> Option<Warning> {
    let given = match case.gravity.schedule {
        GravitySchedule::NormalFirst { settle_damping, .. } | GravitySchedule::ElasticFirst { settle_damping, .. } => {
            settle_damping > 0.0
        }
        _ => false,
    };
    given.then(|| {
        Warning::new(
            "settle_damping_unused",
            "gravity.settle_damping",
            "the implicit scheme settles by equilibrium: settle_damping is not used".into(),
        )
    })
}

fn time_step(case: &Case, simulation: &mut Simulation) -> Option<Warning> {
    if case.solver.scheme == Scheme::Implicit {
        return None;
    }
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
    let (end, loading) = (case.end.time, case.gravity_end());
    (end <= loading).then(|| {
        let text = format!("the run ends at {end} s, before gravity has its final value at {loading} s");
        Warning::new("ends_while_loading", "end.time", text)
    })
}

fn short_load(case: &Case) -> Option<Warning> {
    let end = case.end.time;
    let slow = case.load.iter().find(|load| end <= load.ramp_time && load.ramp_time > 0.0)?;
    let (name, loading) = (&slow.name, slow.ramp_time);
    let text = format!("the run ends at {end} s, before load \"{name}\" has its final value at {loading} s");
    Some(Warning::new("ends_while_loading", &format!("load.{name}.ramp_time"), text))
}

/// A box that moves and is narrower than a cell leaves its nodes before it reaches the next ones.
fn narrow_drive(case: &Case) -> Option<Warning> {
    let moves = |v: Option<f64>| v.is_some_and(|v| v != 0.0);
    let narrow = |d: &&case::Drive| {
        let size = [0, 1].map(|a: usize| d.area[1][a] - d.area[0][a]);
        let axes = [moves(d.velocity_x), moves(d.velocity_y)];
        d.moving && (0..2).any(|a| axes[a] && size[a] < case.grid.cell * (1.0 - 1e-9))
    };
    let drive = case.drive.iter().find(narrow)?;
    let text = format!(
        "the box of drive \"{}\" moves and is narrower than a cell ({} m): between two nodes it drives none",
        drive.name, case.grid.cell
    );
    Some(Warning::new("narrow_drive", &format!("drive.{}.box", drive.name), text))
}

/// A length that the cells do not resolve, or cells on which softening comes close to what a step can follow.
fn unresolved_softening(case: &Case, name: &str, material: &case::Material) -> Option<Warning> {
    let case::Material::VonMises { elastic, strength } = material else { return None };
    let h = case.grid.cell;
    match strength.regularisation {
        case::Regularisation::Nonlocal { reference_length: l, .. } if l < 4.0 * h => {
            let text = format!(
                "reference_length = {l} m of `{name}` is less than four cells of {h} m: the average over it is in part that of the grid, and a band may take another energy"
            );
            Some(Warning::new("unresolved_length", &format!("material.{name}.reference_length"), text))
        }
        case::Regularisation::FractureEnergy { .. } => {
            let largest = softening::largest_cell(case, elastic, strength);
            (h > 0.5 * largest).then(|| {
                let text = format!("softening of `{name}` on cells of {h} m is more than half as steep as the elastic stress falls; from {largest:.3} m there is no solution");
                Warning::new("steep_softening", "grid.cell", text)
            })
        }
        _ => None,
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn slope(keys: &[&str]) -> Case {
        let keys: Vec<String> = keys.iter().map(|k| (*k).to_owned()).collect();
        let text = case::template("slope").expect("a template");
        case::read("slope", text, &keys).unwrap_or_else(|e| panic!("{e}")).0
    }

    #[test]
    fn damping_is_for_what_moves() {
        let quiet = ["implicit.regime=quasi_static", "damping.viscous=0.1"];
        assert_eq!(still_damping(&slope(&quiet)).map(|w| w.key), Some("damping.viscous".to_owned()));
        assert_eq!(still_damping(&slope(&quiet[..1])), None);
        assert_eq!(still_damping(&slope(&quiet[1..])), None);
    }

    #[test]
    fn a_moving_box_is_no_narrower_than_a_cell() {
        let text = case::template("bar").expect("a template");
        let bar = |more: &str| case::read("bar", &format!("{text}\n{more}"), &[]).unwrap_or_else(|e| panic!("{e}")).0;
        let drive = "[[drive]]\nbox = [[25, 0], [25, 1]]\nvelocity_x = 0.1\n";
        assert_eq!(narrow_drive(&bar(drive)).map(|w| w.key), Some("drive.drive 1.box".to_owned()));
        assert_eq!(narrow_drive(&bar(&format!("{drive}moving = false\n"))), None);
        assert_eq!(narrow_drive(&bar(&drive.replace("velocity_x", "velocity_y"))), None);
    }

    #[test]
    fn a_load_has_its_final_value_before_the_end() {
        let load = "\n[[load]]\nbox = [[0, 0], [1, 1]]\nforce = [1, 0]\nramp_time = 99\n";
        let text = case::template("bar").expect("a template").to_owned() + load;
        let found = short_load(&case::read("bar", &text, &[]).unwrap_or_else(|e| panic!("{e}")).0);
        assert_eq!(found.map(|w| w.key), Some("load.load 1.ramp_time".to_owned()));
        assert_eq!(short_load(&slope(&[])), None);
    }

    #[test]
    fn settling_by_equilibrium_needs_no_damping() {
        assert!(settle_damping(&slope(&["gravity.schedule=elastic_first"])).is_some());
        let off = ["gravity.schedule=normal_first", "gravity.settle_damping=0"];
        assert_eq!((settle_damping(&slope(&off)), settle_damping(&slope(&[]))), (None, None));
    }
}
