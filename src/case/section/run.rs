//! `[damping]`, `[jitter]`, `[end]` and `[output]`.

use crate::case::keys::Keys;
use crate::case::limits::{DURATION, FRACTION, INTERVAL, between, positive};
use crate::case::{Damping, End, Jitter, Output};

/// Reads `[damping]`.
pub(super) fn damping(root: &mut Keys<'_>) -> Option<Damping> {
    let mut keys = root.section("damping")?;
    let local = keys.or("local", 0.0, |c| c.number(FRACTION));
    let viscous = keys.or("viscous", 0.0, |c| c.number(between(0.0, 1e6, "1/s")));
    keys.finish();
    Some(Damping { local: local?, viscous: viscous? })
}

/// Reads `[jitter]`.
pub(super) fn jitter(root: &mut Keys<'_>) -> Option<Jitter> {
    let mut keys = root.section("jitter")?;
    let strength = keys.or("strength", 0.0, |c| c.number(between(0.0, 0.5, "")));
    let realisation = keys.or("realisation", 0, |c| c.whole(0, i64::MAX as u64));
    keys.finish();
    Some(Jitter { strength: strength?, realisation: realisation? })
}

/// Reads `[end]`, which every case needs.
pub(super) fn end(root: &mut Keys<'_>) -> Option<End> {
    let mut keys = root.required("end", |c| c.table())?;
    let time = keys.required("time", |c| c.number(INTERVAL));
    let at_rest = keys.or("at_rest", true, |c| c.flag());
    let rest_energy = keys.or("rest_energy", 1e-3, |c| c.number(FRACTION));
    let rest_hold = keys.or("rest_hold", 4.0, |c| c.number(DURATION));
    let after_failure = keys.optional("after_failure", |c| c.number(positive("m")));
    keys.finish();
    Some(End {
        time: time?,
        at_rest: at_rest?,
        rest_energy: rest_energy?,
        rest_hold: rest_hold?,
        after_failure: after_failure?,
    })
}

/// Reads `[output]`.
pub(super) fn output(root: &mut Keys<'_>) -> Option<Output> {
    let mut keys = root.section("output")?;
    let history = keys.or("history", 0.05, |c| c.number(INTERVAL));
    let frames = keys.or("frames", 0.25, |c| c.number(INTERVAL));
    let pictures = keys.or("pictures", Vec::new(), |c| c.numbers(DURATION));
    keys.finish();
    Some(Output { history: history?, frames: frames?, pictures: pictures? })
}
