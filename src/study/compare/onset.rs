//! The onset of failure: the gravity at which the crest has moved by a quarter of a metre, when
//! gravity is raised slowly.

use serde::Serialize;

use crate::{
    case::{Case, GravitySchedule, InitialStress, Material},
    fault::Fault,
    measure::SlideProbe,
    run::Limits,
    scene::Scene,
    sim::Simulation,
    study::clock,
    work::Work,
};

/// Unit weight added in a second (kN/m3/s): slow against the waves of a slope.
pub const RATE: f64 = 1.0;
/// Horizontal displacement of the crest that counts as failure (m). A part of it is elastic.
pub const DISPLACEMENT: f64 = 0.25;
/// Seconds between two looks at the crest.
const LOOK: f64 = 0.02;

/// What raising gravity has shown.
#[derive(Clone, Debug, Serialize)]
pub struct Onset {
    /// Unit weight of the soil at the crest at the onset (kN/m3); `None`: it stands under 1.5 times full
    /// gravity.
    pub unit_weight_kn_m3: Option<f64>,
    /// The same over full gravity.
    pub share: Option<f64>,
    /// Unit weight at which the implicit scheme has brought inertia in (kN/m3).
    pub stability_lost_kn_m3: Option<f64>,
    pub fault: Option<String>,
    /// CPU time to the onset (s), without building the scene.
    pub cpu_s: Option<f64>,
    pub work: Work,
}

/// Gravity is raised to at most this many times its full value.
const BEYOND: f64 = 1.5;

/// Unit weight of the soil at the crest under full gravity (kN/m3); `None` where there is no crest
/// or no gravity.
pub fn crest_weight(case: &Case) -> Option<f64> {
    let crest = case.slide.as_ref()?.crest;
    if case.gravity.schedule == GravitySchedule::None {
        return None;
    }
    // the soil just behind and below the crest
    let inside = [crest[0] - 0.5 * case.grid.cell, crest[1] - 0.5 * case.grid.cell];
    let region = case.region.iter().rev().find(|r| r.shape.contains(inside)).or(case.region.last())?;
    Some(case.material.get(&region.material)?.elastic().unit_weight)
}

/// The case with gravity that grows by [`RATE`] at the crest and passes its full value there: mass
/// stays, acceleration and weight grow. `full` is the unit weight at the crest (kN/m3).
pub fn raised(case: &Case, full: f64) -> Case {
    let mut case = case.clone();
    case.gravity.acceleration *= BEYOND;
    case.gravity.schedule = GravitySchedule::Ramp { ramp_time: BEYOND * full / RATE };
    case.initial_stress = InitialStress::None;
    case.end.time = BEYOND * full / RATE;
    for material in case.material.values_mut() {
        let (Material::Elastic { elastic } | Material::VonMises { elastic, .. }) = material;
        elastic.unit_weight *= BEYOND;
    }
    case
}

/// Raises gravity until the crest has moved, or gravity is at its end. The case is a [`raised`] one.
pub fn find(case: &Case, scene: &mut Scene, full: f64, limits: Limits) -> Onset {
    let before = clock::thread_seconds();
    let sim = &mut scene.simulation;
    let reference = sim.snapshot().reference;
    let probe = case.slide.as_ref().map(|s| SlideProbe::new(&reference, s.crest, scene.grid.h));
    let crest = probe.and_then(|p| p.crest_point());
    let mut track = Vec::new();
    let fault = crest.and_then(|id| climb(sim, id as usize, case.end.time, limits, &mut track).err());
    let at = crossing(&track, DISPLACEMENT).map(|time| RATE * time);
    let lost = sim.events().iter().find(|e| e.kind == "stability_lost");
    Onset {
        unit_weight_kn_m3: at,
        share: at.map(|weight| weight / full),
        stability_lost_kn_m3: lost.map(|e| RATE * e.time_s),
        fault: fault.as_ref().map(Fault::to_string),
        cpu_s: clock::thread_seconds().zip(before).map(|(b, a)| b - a),
        work: sim.work.clone(),
    }
}

/// Steps up to `end` (s), and the horizontal displacement of point `id` over time (s, m).
fn climb(sim: &mut Simulation, id: usize, end: f64, limits: Limits, track: &mut Vec<(f64, f64)>) -> Result<(), Fault> {
    let mut displacement = vec![[0.0; 2]; sim.body.len()];
    let mut next = 0.0;
    while sim.time < end * (1.0 - 1e-12) {
        sim.step(end - sim.time)?;
        if sim.time < next {
            continue;
        }
        next = sim.time + LOOK;
        sim.body.displacements(&mut displacement);
        track.push((sim.time, displacement.get(id).map_or(0.0, |u| u[0])));
        if limits.interrupted() || track.last().is_some_and(|(_, u)| *u > DISPLACEMENT) {
            break;
        }
    }
    Ok(())
}

/// Where a track of (time, value) first passes `level`, by linear interpolation.
fn crossing(track: &[(f64, f64)], level: f64) -> Option<f64> {
    let above = track.iter().position(|(_, u)| *u > level)?;
    let (t1, u1) = track[above];
    let Some((t0, u0)) = above.checked_sub(1).map(|k| track[k]) else { return Some(t1) };
    Some(t0 + (t1 - t0) * (level - u0) / (u1 - u0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_onset_lies_between_two_looks() {
        let track = [(0.0, 0.0), (1.0, 0.05), (2.0, 0.15), (4.0, 0.35), (5.0, 0.1), (6.0, 3.0)];
        assert!(crossing(&track, 0.25).is_some_and(|t| (t - 3.0).abs() < 1e-12));
        assert!(crossing(&track, 0.1).is_some_and(|t| (t - 1.5).abs() < 1e-12));
        assert_eq!(crossing(&track, 4.0), None);
        assert_eq!(crossing(&track[3..], 0.25), Some(4.0));
        assert_eq!(crossing(&[], 0.25), None);
    }

    #[test]
    fn gravity_grows_by_one_unit_a_second() {
        let read = |name: &str| {
            let text = crate::case::template(name).expect("a template");
            crate::case::read(name, text, &[]).unwrap_or_else(|e| panic!("{e}")).0
        };
        let case = read("slope");
        let full = crest_weight(&case).expect("a crest");
        let raised = raised(&case, full);
        assert_eq!((full, raised.gravity_end()), (20.0, 30.0));
        let density = |c: &Case| c.material["clay"].elastic().unit_weight / c.gravity.acceleration;
        assert!((density(&raised) / density(&case) - 1.0).abs() < 1e-12);
        assert_eq!(crest_weight(&read("bar")), None);
    }
}
