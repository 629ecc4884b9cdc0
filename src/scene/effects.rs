//! The effects that a case calls for, in the order in which they act.

use super::{SceneError, refuse};
use crate::{
    body::Body,
    case::{self, Case, GravitySchedule},
    effect::{
        Drive, Effect, Friction, Ghost, Gravity, Load, LocalDamping, Schedule, Support, ViscousDamping,
        drive::NodeRange,
    },
    space::{Grid, grid::Side},
};

/// Forces first (gravity and loads, then damping, which looks at the out-of-balance force, and the
/// ghost penalty), then
/// supports that hold both ways, drives, and friction, which sees what they leave.
///
/// # Errors
/// A load without a point, a drive without a node.
pub fn build(case: &Case, grid: &Grid, body: &Body) -> Result<Vec<Box<dyn Effect>>, SceneError> {
    let mut effects: Vec<Box<dyn Effect>> = Vec::new();
    if let Some(schedule) = schedule(case) {
        effects.push(Box::new(Gravity::new(gravity_vector(case), schedule)));
    }
    for l in &case.load {
        effects.push(Box::new(load(l, grid, body)?));
    }
    if has_local_damping(case) {
        effects.push(Box::new(LocalDamping::new(case.damping.local, settle(case))));
    }
    if case.damping.viscous > 0.0 {
        effects.push(Box::new(ViscousDamping::new(case.damping.viscous)));
    }
    if has_ghost(case) {
        effects.push(Box::new(Ghost::new(case.implicit.ghost_stiffness, case.implicit.ghost_mass)));
    }
    effects.extend(sides(case).filter_map(|(side, kind)| hold(side, kind)));
    for d in &case.drive {
        effects.push(Box::new(drive(case, d, grid)?));
    }
    effects.extend(sides(case).filter_map(|(side, kind)| rub(side, kind)));
    Ok(effects)
}

/// The points that start in the box of a load share it by volume.
fn load(load: &case::Load, grid: &Grid, body: &Body) -> Result<Load, SceneError> {
    let [low, high] = load.area;
    let slack = 1e-9 * grid.h;
    let inside = |x: f64, axis: usize| x >= low[axis] - slack && x <= high[axis] + slack;
    let mut weight = vec![0.0; body.len()];
    let [x, y] = &body.committed.x;
    for (i, &id) in body.id.iter().enumerate() {
        if inside(x[i], 0) && inside(y[i], 1) {
            weight[id as usize] = body.volume[i];
        }
    }
    if weight.iter().all(|w| *w == 0.0) {
        let key = format!("load.{}.box", load.name);
        let message = format!(
            "no material point starts in the box of load \"{}\", from ({}, {}) to ({}, {}) m",
            load.name, low[0], low[1], high[0], high[1]
        );
        return Err(refuse(&key, message));
    }
    Ok(Load::new(weight, load.force, load.ramp_time))
}

fn drive(case: &Case, drive: &case::Drive, grid: &Grid) -> Result<Drive, SceneError> {
    if NodeRange::of(grid, drive.area).is_empty() {
        let [low, high] = drive.area;
        let key = format!("drive.{}.box", drive.name);
        let message = format!(
            "no node of the grid lies in the box of drive \"{}\", from ({}, {}) to ({}, {}) m; nodes are {} m apart",
            drive.name, low[0], low[1], high[0], high[1], grid.h
        );
        return Err(refuse(&key, message));
    }
    let until = drive.until.unwrap_or(f64::INFINITY);
    // in small strain the nodes do not move away from the box
    let moving = drive.moving && case.solver.kinematics != case::Kinematics::Small;
    Ok(Drive::new(drive.area, [drive.velocity_x, drive.velocity_y], moving, until))
}

/// The four sides with their supports. A smooth side that cannot open is a roller.
pub fn sides(case: &Case) -> impl Iterator<Item = (Side, case::Side)> {
    let b = &case.boundary;
    let plain = |kind| match kind {
        case::Side::Friction { coefficient: 0.0, separation: false } => case::Side::Roller,
        other => other,
    };
    Side::ALL.into_iter().zip([b.left, b.right, b.base, b.top].map(plain))
}

fn hold(side: Side, kind: case::Side) -> Option<Box<dyn Effect>> {
    match kind {
        case::Side::Roller => Some(Box::new(Support::roller(side))),
        case::Side::Fixed => Some(Box::new(Support::fixed(side))),
        case::Side::Free | case::Side::Friction { .. } => None,
    }
}

fn rub(side: Side, kind: case::Side) -> Option<Box<dyn Effect>> {
    match kind {
        case::Side::Friction { coefficient, separation } => {
            Some(Box::new(Friction::new(side, coefficient, separation)))
        }
        case::Side::Free | case::Side::Roller | case::Side::Fixed => None,
    }
}

/// (g_x, g_y): straight down, leaning towards +x by the tilt.
fn gravity_vector(case: &Case) -> [f64; 2] {
    let (sin, cos) = case.gravity.tilt.to_radians().sin_cos();
    [case.gravity.acceleration * sin, -case.gravity.acceleration * cos]
}

fn schedule(case: &Case) -> Option<Schedule> {
    match case.gravity.schedule {
        GravitySchedule::None => None,
        GravitySchedule::AtOnce => Some(Schedule::AtOnce),
        GravitySchedule::Ramp { ramp_time } | GravitySchedule::ElasticFirst { ramp_time, .. } => {
            Some(Schedule::Ramp { ramp_time })
        }
        GravitySchedule::NormalFirst { ramp_time, settle_time, tangential_time, .. } => {
            Some(Schedule::NormalFirst { ramp_time, settle_time, tangential_time })
        }
    }
}

/// Damping while the soil settles, and until when. The implicit scheme settles by equilibrium.
fn settle(case: &Case) -> Option<(f64, f64)> {
    if case.solver.scheme == case::Scheme::Implicit {
        return None;
    }
    match case.gravity.schedule {
        GravitySchedule::NormalFirst { ramp_time, settle_time, settle_damping, .. }
        | GravitySchedule::ElasticFirst { ramp_time, settle_time, settle_damping } => {
            Some((settle_damping, ramp_time + settle_time))
        }
        _ => None,
    }
}

/// Whether local damping acts at any time. It is a remedy of the explicit scheme: it needs the
/// out-of-balance force, which the implicit scheme has brought to zero.
pub fn has_local_damping(case: &Case) -> bool {
    let explicit = case.solver.scheme == case::Scheme::Explicit;
    explicit && (case.damping.local > 0.0 || settle(case).is_some_and(|(a, _)| a > 0.0))
}

/// Whether the ghost penalty acts at any time: its mass only where there may be inertia.
pub fn has_ghost(case: &Case) -> bool {
    let i = &case.implicit;
    let mass = i.ghost_mass > 0.0 && i.regime.inertia().is_some();
    case.solver.scheme == case::Scheme::Implicit && (i.ghost_stiffness > 0.0 || mass)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_explicit_scheme_settles_by_damping() {
        let text = case::template("slope").expect("a template");
        let damped = |scheme: &str| {
            let keys = [format!("solver.scheme={scheme}"), "gravity.schedule=elastic_first".to_owned()];
            has_local_damping(&case::read("slope", text, &keys).unwrap_or_else(|e| panic!("{e}")).0)
        };
        assert!(damped("explicit") && !damped("implicit"));
    }

    #[test]
    fn a_penalty_of_nothing_is_not_in_the_list() {
        let text = case::template("slope").expect("a template");
        let ghosts = |keys: &[&str]| {
            let keys: Vec<String> = keys.iter().map(|k| (*k).to_owned()).collect();
            let (case, _) = case::read("slope", text, &keys).unwrap_or_else(|e| panic!("{e}"));
            let grid = Grid { origin: [0.0; 2], h: 1.0, cells: [4, 4] };
            let effects = build(&case, &grid, &Body::new(Vec::new())).unwrap_or_else(|e| panic!("{e}"));
            effects.iter().filter(|e| e.name() == "ghost_penalty").count()
        };
        let implicit = "solver.scheme=implicit";
        assert_eq!(ghosts(&[implicit]), 0);
        assert_eq!(ghosts(&["implicit.ghost_stiffness=0.1"]), 0);
        assert_eq!(ghosts(&[implicit, "implicit.ghost_stiffness=0.1"]), 1);
        assert_eq!(ghosts(&[implicit, "implicit.ghost_mass=0.1"]), 1);
        assert_eq!(ghosts(&[implicit, "implicit.regime=quasi_static", "implicit.ghost_mass=0.1"]), 0);
    }
}
