//! `[implicit]`.

use crate::case::cursor::Cursor;
use crate::case::keys::{Keys, Variant};
use crate::case::limits::{Limits, between, figure, not_negative};
use crate::case::log::Problem;
use crate::case::section::solver::{Chosen, pic_rate};
use crate::case::{Implicit, Inertia, Ordering, Regime, Symmetric, Unsymmetric};

const REGIMES: &[Variant] = &[
    Variant { word: "auto", keys: &["inertia", "hht_alpha"] },
    Variant { word: "quasi_static", keys: &[] },
    Variant { word: "newmark", keys: &[] },
    Variant { word: "hht", keys: &["hht_alpha"] },
    Variant { word: "backward_euler", keys: &[] },
];

/// Lengths of steps (s).
const STEP: Limits = between(1e-12, 1e6, "s");

/// First step (s), and how far below it the shortest lies by default.
const FIRST: f64 = 0.02;
const CUTS: f64 = 1024.0;

/// Reads `[implicit]`.
pub(super) fn implicit(root: &mut Keys<'_>, chosen: Option<&Chosen>) -> Option<Implicit> {
    let mut keys = root.section("implicit")?;
    let regime = regime(&mut keys);
    let steps = steps(&mut keys);
    let tolerance = keys.optional("tolerance", |c| c.number(between(1e-9, 1.0, "cells")));
    let residual = keys.or("residual", 1e-9, |c| c.number(between(1e-14, 0.1, "")));
    let absolute_residual = keys.optional("absolute_residual", |c| c.number(not_negative("kN/m")));
    let max_iterations = keys.or("max_iterations", 12, |c| c.whole(1, 1000));
    let line_search = keys.or("line_search", true, |c| c.flag());
    let pic_rate = pic_rate(&mut keys, chosen);
    let ordering = keys.or("ordering", Ordering::Auto, ordering);
    let symmetric = keys.or("symmetric", Symmetric::Auto, symmetric);
    let unsymmetric = keys.or("unsymmetric", Unsymmetric::Auto, unsymmetric);
    let ghost_stiffness = keys.or("ghost_stiffness", 0.0, |c| c.number(between(0.0, 10.0, "")));
    let ghost_mass = keys.or("ghost_mass", 0.0, |c| c.number(between(0.0, 10.0, "")));
    keys.finish();
    let [min_time_step, time_step, max_time_step] = steps?;
    Some(Implicit {
        regime: regime?,
        time_step,
        min_time_step,
        max_time_step,
        tolerance: tolerance?,
        residual: residual?,
        absolute_residual: absolute_residual?,
        max_iterations: max_iterations? as usize,
        line_search: line_search?,
        pic_rate: pic_rate?,
        ordering: ordering?,
        symmetric: symmetric?,
        unsymmetric: unsymmetric?,
        ghost_stiffness: ghost_stiffness?,
        ghost_mass: ghost_mass?,
    })
}

fn regime(keys: &mut Keys<'_>) -> Option<Regime> {
    match keys.tag("regime", Some("auto"), REGIMES)? {
        "quasi_static" => Some(Regime::QuasiStatic),
        "newmark" => Some(Regime::Newmark),
        "hht" => Some(Regime::Hht { hht_alpha: hht_alpha(keys)? }),
        "backward_euler" => Some(Regime::BackwardEuler),
        _ => Some(Regime::Auto { inertia: inertia(keys)? }),
    }
}

fn hht_alpha(keys: &mut Keys<'_>) -> Option<f64> {
    keys.or("hht_alpha", 0.1, |c| c.formula(between(0.0, 1.0 / 3.0, "")))
}

/// The integrator that `auto` brings in.
fn inertia(keys: &mut Keys<'_>) -> Option<Inertia> {
    let words = ["backward_euler", "newmark", "hht"];
    let word = keys.or("inertia", "newmark", |c| c.word(&words))?;
    if word == "hht" {
        return Some(Inertia::Hht { hht_alpha: hht_alpha(keys)? });
    }
    no_alpha(keys, word)?;
    Some(if word == "newmark" { Inertia::Newmark } else { Inertia::BackwardEuler })
}

/// `hht_alpha` belongs to hht alone; one of the file lapses where an override chose another integrator.
fn no_alpha(keys: &mut Keys<'_>, word: &str) -> Option<()> {
    let Some(alpha) = keys.get("hht_alpha") else { return Some(()) };
    let overridden = |key| keys.named(key).is_some_and(|c| !c.node.span.in_file());
    if alpha.key.in_file() && (overridden("regime") || overridden("inertia")) {
        return Some(());
    }
    let message = format!("`{}` has no meaning with inertia = \"{word}\"", alpha.path);
    let help = "leave `hht_alpha` out or set `implicit.inertia` to \"hht\"";
    alpha.key_error(Problem::new(message, "a key of inertia \"hht\"").help(help));
    None
}

/// Shortest, first and longest step (s), in this order.
fn steps(keys: &mut Keys<'_>) -> Option<[f64; 3]> {
    let first = keys.or("time_step", FIRST, |c| c.number(STEP));
    let shortest = keys.optional("min_time_step", |c| bound(c, first, "at most", |step, first| step <= first));
    let longest = keys.optional("max_time_step", |c| bound(c, first, "at least", |step, first| step >= first));
    let (first, shortest, longest) = (first?, shortest?, longest?);
    Some([shortest.unwrap_or(first / CUTS), first, longest.unwrap_or(first)])
}

/// A bound of the time step, which holds for the first one too.
fn bound(cursor: &Cursor<'_>, first: Option<f64>, way: &str, fits: fn(f64, f64) -> bool) -> Option<f64> {
    let (step, first) = (cursor.number(STEP)?, first?);
    if fits(step, first) {
        return Some(step);
    }
    let message = format!("`{}` = {} leaves out the first step of {} s", cursor.path, figure(step), figure(first));
    let help = "the first step is `implicit.time_step`";
    cursor.error(Problem::new(message, format!("must be {way} {} s", figure(first))).help(help));
    None
}

fn ordering(cursor: &Cursor<'_>) -> Option<Ordering> {
    match cursor.word(&["auto", "amd", "nested_dissection"])? {
        "amd" => Some(Ordering::Amd),
        "nested_dissection" => Some(Ordering::NestedDissection),
        _ => Some(Ordering::Auto),
    }
}

fn symmetric(cursor: &Cursor<'_>) -> Option<Symmetric> {
    match cursor.word(&["auto", "direct", "pcg"])? {
        "direct" => Some(Symmetric::Direct),
        "pcg" => Some(Symmetric::Pcg),
        _ => Some(Symmetric::Auto),
    }
}

fn unsymmetric(cursor: &Cursor<'_>) -> Option<Unsymmetric> {
    match cursor.word(&["auto", "lu", "gmres"])? {
        "lu" => Some(Unsymmetric::Lu),
        "gmres" => Some(Unsymmetric::Gmres),
        _ => Some(Unsymmetric::Auto),
    }
}
