//! The effects that a case calls for, in the order in which they act.

use crate::{
    case::{self, Case, GravitySchedule},
    effect::{Effect, Friction, Gravity, LocalDamping, Schedule, Support, ViscousDamping},
    space::grid::Side,
};

/// Forces first (gravity, then damping, which looks at the out-of-balance force), then supports
/// that hold both ways, then friction, which sees what they leave.
pub fn build(case: &Case) -> Vec<Box<dyn Effect>> {
    let mut effects: Vec<Box<dyn Effect>> = Vec::new();
    if let Some(schedule) = schedule(case) {
        effects.push(Box::new(Gravity::new(gravity_vector(case), schedule)));
    }
    if has_local_damping(case) {
        effects.push(Box::new(LocalDamping::new(case.damping.local, settle(case))));
    }
    if case.damping.viscous > 0.0 {
        effects.push(Box::new(ViscousDamping::new(case.damping.viscous)));
    }
    effects.extend(sides(case).filter_map(|(side, kind)| hold(side, kind)));
    effects.extend(sides(case).filter_map(|(side, kind)| rub(side, kind)));
    effects
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

/// Damping while the soil settles, and until when.
fn settle(case: &Case) -> Option<(f64, f64)> {
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
