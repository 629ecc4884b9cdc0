//! `[solver]` and `[explicit]`.

use crate::case::cursor::Cursor;
use crate::case::keys::{Keys, Variant};
use crate::case::limits::{FRACTION, between};
use crate::case::log::Problem;
use crate::case::{Explicit, Kinematics, Locking, Scheme, ShapeFunctions, Solver, StressUpdate, Transfer};

const TRANSFERS: &[Variant] = &[
    Variant { word: "flip", keys: &[] },
    Variant { word: "apic", keys: &[] },
    Variant { word: "xpic", keys: &["xpic_order"] },
];

/// Reads `[solver]`.
pub(super) fn solver(root: &mut Keys<'_>) -> Option<Solver> {
    let mut keys = root.section("solver")?;
    let scheme = keys.or("scheme", Scheme::Explicit, scheme);
    let kinematics = keys.or("kinematics", Kinematics::Hencky, |c| kinematics(c, scheme));
    let locking = keys.or("locking", Locking::None, locking);
    let shape = keys.or("shape", ShapeFunctions::Linear, shape);
    let transfer = transfer(&mut keys);
    keys.finish();
    Some(Solver { scheme: scheme?, kinematics: kinematics?, locking: locking?, shape: shape?, transfer: transfer? })
}

fn transfer(keys: &mut Keys<'_>) -> Option<Transfer> {
    match keys.tag("transfer", Some("flip"), TRANSFERS)? {
        "apic" => Some(Transfer::Apic),
        "xpic" => {
            let order = keys.or("xpic_order", 5, |c| c.whole(1, 10))?;
            Some(Transfer::Xpic { xpic_order: order as u32 })
        }
        _ => Some(Transfer::Flip),
    }
}

/// What the schemes ask about the transfer.
pub(super) struct Chosen {
    transfer: Transfer,
    /// Whether an override chose it: a `pic_rate` of the file then lapses.
    overridden: bool,
}

impl Chosen {
    /// Of what [`solver`] has read.
    pub fn new(root: &Keys<'_>, solver: &Solver) -> Self {
        let table = root.named("solver").and_then(|c| c.table());
        let overridden = table.and_then(|t| t.named("transfer").map(|c| !c.node.span.in_file()));
        Chosen { transfer: solver.transfer, overridden: overridden.unwrap_or(false) }
    }

    fn word(&self) -> &'static str {
        match self.transfer {
            Transfer::Flip => "flip",
            Transfer::Apic => "apic",
            Transfer::Xpic { .. } => "xpic",
        }
    }
}

/// `pic_rate` of a scheme: a key of flip alone.
pub(super) fn pic_rate(keys: &mut Keys<'_>, chosen: Option<&Chosen>) -> Option<Option<f64>> {
    let Some(other) = chosen.filter(|c| c.transfer != Transfer::Flip) else {
        return keys.or("pic_rate", 0.5, |c| c.number(between(0.0, 1e6, "1/s"))).map(Some);
    };
    let Some(rate) = keys.get("pic_rate").filter(|rate| !(other.overridden && rate.key.in_file())) else {
        return Some(None);
    };
    let message = format!("`{}` has no meaning with solver.transfer = \"{}\"", rate.path, other.word());
    let help = "leave `pic_rate` out or set `solver.transfer` to \"flip\"";
    rate.key_error(Problem::new(message, "a key of transfer \"flip\"").help(help));
    None
}

fn shape(cursor: &Cursor<'_>) -> Option<ShapeFunctions> {
    let word = cursor.word(&ShapeFunctions::ALL.map(ShapeFunctions::word))?;
    ShapeFunctions::ALL.into_iter().find(|shape| shape.word() == word)
}

fn scheme(cursor: &Cursor<'_>) -> Option<Scheme> {
    match cursor.word(&["explicit", "implicit"])? {
        "implicit" => Some(Scheme::Implicit),
        _ => Some(Scheme::Explicit),
    }
}

fn kinematics(cursor: &Cursor<'_>, scheme: Option<Scheme>) -> Option<Kinematics> {
    match (cursor.word(&["hencky", "rate", "small"])?, scheme) {
        ("rate", Some(Scheme::Implicit)) => wrong_scheme(cursor, "rate", "implicit", "explicit"),
        ("small", Some(Scheme::Explicit)) => wrong_scheme(cursor, "small", "explicit", "implicit"),
        ("rate", _) => Some(Kinematics::Rate),
        ("small", _) => Some(Kinematics::Small),
        _ => Some(Kinematics::Hencky),
    }
}

/// A strain measure of the other scheme.
fn wrong_scheme<T>(cursor: &Cursor<'_>, word: &str, chosen: &str, owner: &str) -> Option<T> {
    let message = format!("`{}` = \"{word}\" does not go with scheme = \"{chosen}\"", cursor.path);
    let help = format!("use \"hencky\", which goes with both, or solver.scheme = \"{owner}\"");
    cursor.error(Problem::new(message, format!("{owner} only")).help(help));
    None
}

fn locking(cursor: &Cursor<'_>) -> Option<Locking> {
    match cursor.word(&["none", "b_bar"])? {
        "b_bar" => Some(Locking::BBar),
        _ => Some(Locking::None),
    }
}

/// Reads `[explicit]`.
pub(super) fn explicit(root: &mut Keys<'_>, chosen: Option<&Chosen>) -> Option<Explicit> {
    let mut keys = root.section("explicit")?;
    let stress_update = keys.or("stress_update", StressUpdate::Musl, stress_update);
    let pic_rate = pic_rate(&mut keys, chosen);
    let courant = keys.or("courant", 0.25, |c| c.number(between(1e-3, 1.0, "")));
    let time_step = keys.optional("time_step", |c| c.number(between(1e-12, 1e6, "s")));
    let floor = default_mass_floor(stress_update, chosen);
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

/// MUSL is stable beside light nodes; USL is not, and APIC, which gives a light node its velocity back whole,
/// still less.
fn default_mass_floor(stress_update: Option<StressUpdate>, chosen: Option<&Chosen>) -> f64 {
    match (chosen.map(|c| c.transfer), stress_update) {
        (Some(Transfer::Apic), _) => 1e-2,
        (_, Some(StressUpdate::Usl)) => 1e-3,
        _ => 0.0,
    }
}

fn stress_update(cursor: &Cursor<'_>) -> Option<StressUpdate> {
    match cursor.word(&["musl", "usl"])? {
        "usl" => Some(StressUpdate::Usl),
        _ => Some(StressUpdate::Musl),
    }
}
