//! `[gravity]` and `[initial_stress]`.

use crate::case::keys::{Keys, Variant};
use crate::case::limits::{DURATION, FRACTION, INTERVAL, between, signed};
use crate::case::{Gravity, GravitySchedule, InitialStress};

/// Standard gravity as geotechnics rounds it (m/s2).
pub(super) const STANDARD: f64 = 9.81;

const SCHEDULES: &[Variant] = &[
    Variant { word: "ramp", keys: &["ramp_time"] },
    Variant { word: "at_once", keys: &[] },
    Variant { word: "none", keys: &[] },
    Variant { word: "normal_first", keys: &["ramp_time", "settle_time", "settle_damping", "tangential_time"] },
    Variant { word: "elastic_first", keys: &["ramp_time", "settle_time", "settle_damping"] },
];

const KINDS: &[Variant] = &[
    Variant { word: "none", keys: &[] },
    Variant { word: "k0", keys: &["k0"] },
    Variant { word: "given", keys: &["xx", "yy", "zz", "xy"] },
];

/// Reads `[gravity]`.
pub(super) fn gravity(root: &mut Keys<'_>) -> Option<Gravity> {
    let mut keys = root.section("gravity")?;
    let acceleration = keys.or("acceleration", STANDARD, |c| c.number(between(1e-6, 1e6, "m/s2")));
    let tilt = keys.or("tilt", 0.0, |c| c.number(between(-90.0, 90.0, "degrees")));
    let schedule = schedule(&mut keys);
    keys.finish();
    Some(Gravity { acceleration: acceleration?, tilt: tilt?, schedule: schedule? })
}

fn schedule(keys: &mut Keys<'_>) -> Option<GravitySchedule> {
    match keys.tag("schedule", Some("ramp"), SCHEDULES)? {
        "none" => Some(GravitySchedule::None),
        "at_once" => Some(GravitySchedule::AtOnce),
        "normal_first" => normal_first(keys),
        "elastic_first" => elastic_first(keys),
        _ => ramp(keys),
    }
}

fn ramp(keys: &mut Keys<'_>) -> Option<GravitySchedule> {
    let ramp_time = keys.or("ramp_time", 5.0, |c| c.number(INTERVAL))?;
    Some(GravitySchedule::Ramp { ramp_time })
}

fn normal_first(keys: &mut Keys<'_>) -> Option<GravitySchedule> {
    let ramp_time = keys.or("ramp_time", 1.0, |c| c.number(INTERVAL));
    let settle_time = keys.or("settle_time", 2.0, |c| c.number(DURATION));
    let settle_damping = keys.or("settle_damping", 0.5, |c| c.number(FRACTION));
    let tangential_time = keys.or("tangential_time", 1.0, |c| c.number(INTERVAL));
    Some(GravitySchedule::NormalFirst {
        ramp_time: ramp_time?,
        settle_time: settle_time?,
        settle_damping: settle_damping?,
        tangential_time: tangential_time?,
    })
}

fn elastic_first(keys: &mut Keys<'_>) -> Option<GravitySchedule> {
    let ramp_time = keys.or("ramp_time", 2.0, |c| c.number(INTERVAL));
    let settle_time = keys.or("settle_time", 6.0, |c| c.number(DURATION));
    let settle_damping = keys.or("settle_damping", 0.3, |c| c.number(FRACTION));
    Some(GravitySchedule::ElasticFirst {
        ramp_time: ramp_time?,
        settle_time: settle_time?,
        settle_damping: settle_damping?,
    })
}

/// Reads `[initial_stress]`.
pub(super) fn initial_stress(root: &mut Keys<'_>) -> Option<InitialStress> {
    let mut keys = root.section("initial_stress")?;
    let stress = match keys.tag("kind", Some("none"), KINDS) {
        Some("k0") => k0(&mut keys),
        Some("given") => given(&mut keys),
        Some(_) => Some(InitialStress::None),
        None => None,
    };
    keys.finish();
    stress
}

fn k0(keys: &mut Keys<'_>) -> Option<InitialStress> {
    let k0 = keys.required("k0", |c| c.number(between(0.0, 10.0, "")))?;
    Some(InitialStress::K0 { k0 })
}

fn given(keys: &mut Keys<'_>) -> Option<InitialStress> {
    let xx = keys.required("xx", |c| c.number(signed("kPa")));
    let yy = keys.required("yy", |c| c.number(signed("kPa")));
    let zz = keys.required("zz", |c| c.number(signed("kPa")));
    let xy = keys.or("xy", 0.0, |c| c.number(signed("kPa")));
    Some(InitialStress::Given { xx: xx?, yy: yy?, zz: zz?, xy: xy? })
}
