//! `[solver]` and `[explicit]`.

use crate::case::cursor::Cursor;
use crate::case::keys::Keys;
use crate::case::limits::{FRACTION, between};
use crate::case::types::{Explicit, Kinematics, Scheme, Solver, StressUpdate};

/// Reads `[solver]`.
pub(super) fn solver(root: &mut Keys<'_>) -> Option<Solver> {
    let mut keys = root.section("solver")?;
    let explicit = |c: &Cursor<'_>| c.word(&["explicit"]).map(|_| Scheme::Explicit);
    let scheme = keys.or("scheme", Scheme::Explicit, explicit);
    let kinematics = keys.or("kinematics", Kinematics::Hencky, kinematics);
    keys.finish();
    Some(Solver { scheme: scheme?, kinematics: kinematics? })
}

fn kinematics(cursor: &Cursor<'_>) -> Option<Kinematics> {
    match cursor.word(&["hencky", "rate"])? {
        "rate" => Some(Kinematics::Rate),
        _ => Some(Kinematics::Hencky),
    }
}

/// Reads `[explicit]`.
pub(super) fn explicit(root: &mut Keys<'_>) -> Option<Explicit> {
    let mut keys = root.section("explicit")?;
    let stress_update = keys.or("stress_update", StressUpdate::Musl, stress_update);
    let pic_rate = keys.or("pic_rate", 0.5, |c| c.number(between(0.0, 1e6, "1/s")));
    let courant = keys.or("courant", 0.25, |c| c.number(between(1e-3, 1.0, "")));
    let time_step = keys.optional("time_step", |c| c.number(between(1e-12, 1e6, "s")));
    let floor = default_mass_floor(stress_update);
    let mass_floor = keys.or("mass_floor", floor, |c| c.number(FRACTION));
    keys.finish();
    Some(Explicit {
        stress_update: stress_update?,
        pic_rate: pic_rate?,
        courant: courant?,
        time_step: time_step?,
        mass_floor: mass_floor?,
    })
}

/// MUSL is stable beside light nodes; USL is not.
fn default_mass_floor(stress_update: Option<StressUpdate>) -> f64 {
    if stress_update == Some(StressUpdate::Usl) { 1e-3 } else { 0.0 }
}

fn stress_update(cursor: &Cursor<'_>) -> Option<StressUpdate> {
    match cursor.word(&["musl", "usl"])? {
        "usl" => Some(StressUpdate::Usl),
        _ => Some(StressUpdate::Musl),
    }
}
