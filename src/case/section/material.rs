//! `[material.NAME]`.

mod regularisation;

use std::collections::BTreeMap;

use crate::case::check::Materials;
use crate::case::cursor::Cursor;
use crate::case::keys::{Keys, Variant};
use crate::case::limits::{Limits, between, figure, positive, rounded, signed};
use crate::case::log::Problem;
use crate::case::source::Span;
use crate::case::{Elastic, Material, Regularisation, Strength, StrengthMeasure};

const LAWS: &[Variant] = &[
    Variant { word: "elastic", keys: &[] },
    Variant {
        word: "von_mises",
        keys: &[
            "cohesion",
            "residual_cohesion",
            "softening_modulus",
            "yield_constant",
            "strength_measure",
            "regularisation",
            "reference_length",
            "nonlocal_weight",
        ],
    },
];

/// Poisson's ratio of a stable, compressible solid.
const POISSON: Limits = Limits { low: -1.0, high: 0.5, open: true, unit: "" };

/// Reads `[material]`; a material with errors is kept by name alone.
pub(super) fn materials(root: &mut Keys<'_>, acceleration: f64) -> Option<Materials> {
    let keys = root.required("material", |c| c.table())?;
    let cursors = keys.names().filter_map(|name| Some((name, keys.named(name)?)));
    let by_name: BTreeMap<_, _> =
        cursors.map(|(name, cursor)| (name.clone(), (cursor.key, material(&cursor, acceleration)))).collect();
    if by_name.is_empty() {
        let problem = Problem::new("there is no material", "at least one `[material.NAME]`");
        return keys.header_error("", problem);
    }
    Some(Materials { by_name })
}

fn material(cursor: &Cursor<'_>, acceleration: f64) -> Option<Material> {
    let mut keys = cursor.table()?;
    let law = keys.tag("law", None, LAWS);
    let elastic = elastic(&mut keys, acceleration);
    let material = match law {
        Some("von_mises") => von_mises(&mut keys, cursor, elastic),
        Some(_) => elastic.map(|elastic| Material::Elastic { elastic }),
        None => None,
    };
    keys.finish();
    material
}

fn elastic(keys: &mut Keys<'_>, acceleration: f64) -> Option<Elastic> {
    let unit_weight = unit_weight(keys, acceleration);
    let young_modulus = keys.required("young_modulus", |c| c.number(positive("kPa")));
    let poisson_ratio = keys.required("poisson_ratio", |c| c.number(POISSON));
    Some(Elastic { unit_weight: unit_weight?, young_modulus: young_modulus?, poisson_ratio: poisson_ratio? })
}

fn unit_weight(keys: &mut Keys<'_>, acceleration: f64) -> Option<f64> {
    let given = keys.either("unit_weight", "density")?;
    match given.path.ends_with("density") {
        true => given.number(positive("t/m3")).map(|density| density * acceleration),
        false => given.number(positive("kN/m3")),
    }
}

fn von_mises(keys: &mut Keys<'_>, cursor: &Cursor<'_>, elastic: Option<Elastic>) -> Option<Material> {
    let at = Places::of(keys, cursor.key);
    let strength = strength(keys);
    let (elastic, strength) = (elastic?, strength?);
    check_residual(cursor, &at, &strength);
    check_softening(cursor, &at, &elastic, &strength);
    Some(Material::VonMises { elastic, strength })
}

fn strength(keys: &mut Keys<'_>) -> Option<Strength> {
    let cohesion = keys.required("cohesion", |c| c.number(positive("kPa")));
    let residual = keys.optional("residual_cohesion", |c| c.number(positive("kPa")));
    let softening_modulus = keys.or("softening_modulus", 0.0, |c| c.number(signed("kPa")));
    let constant = between(1e-3, 1e3, "");
    let yield_constant = keys.or("yield_constant", 3f64.sqrt(), |c| c.formula(constant));
    let strength_measure = keys.or("strength_measure", StrengthMeasure::Cauchy, measure);
    let regularisation = regularisation::read(keys);
    Some(Strength {
        cohesion: cohesion?,
        residual_cohesion: residual?.or(cohesion)?,
        softening_modulus: softening_modulus?,
        yield_constant: yield_constant?,
        strength_measure: strength_measure?,
        regularisation: regularisation?,
    })
}

fn measure(cursor: &Cursor<'_>) -> Option<StrengthMeasure> {
    match cursor.word(&["cauchy", "kirchhoff"])? {
        "kirchhoff" => Some(StrengthMeasure::Kirchhoff),
        _ => Some(StrengthMeasure::Cauchy),
    }
}

/// Where the keys of the strength stand, or the material where they are left out.
struct Places {
    residual: Span,
    softening: Span,
}

impl Places {
    fn of(keys: &Keys<'_>, material: Span) -> Self {
        let place = |key| keys.named(key).map_or(material, |cursor| cursor.node.span);
        Self { residual: place("residual_cohesion"), softening: place("softening_modulus") }
    }
}

/// The residual strength must lie where the slope of the strength leads.
fn check_residual(cursor: &Cursor<'_>, at: &Places, s: &Strength) {
    let path = format!("{}.residual_cohesion", cursor.path);
    let (peak, residual, slope) = (s.cohesion, s.residual_cohesion, s.softening_modulus);
    let values = format!("residual_cohesion = {} and cohesion = {}", figure(residual), figure(peak));
    if (slope < 0.0 && residual > peak) || (slope > 0.0 && residual < peak) {
        let way = if slope < 0.0 { "softens: at most" } else { "hardens: at least" };
        let label = format!("`{}` {way} {}", cursor.path, figure(peak));
        let help = "change the sign of `softening_modulus` or swap the two strengths";
        cursor.log.error(at.residual, &path, Problem::new(values, label).help(help));
    } else if slope != 0.0 && residual == peak {
        let problem = Problem::new(values, "`softening_modulus` has no effect")
            .help("set `residual_cohesion`, or leave `softening_modulus` out");
        cursor.log.warning(at.softening, &path, problem);
    } else if slope == 0.0 && residual != peak {
        let problem = Problem::new(values, "never reached: `softening_modulus` is 0");
        cursor.log.warning(at.residual, &path, problem);
    }
}

/// The return to the yield surface exists while 3G + k f H > 0, f being the factor on the strength:
/// J, or 1/J. Half as much again as the initial volume is allowed for.
fn check_softening(cursor: &Cursor<'_>, at: &Places, e: &Elastic, s: &Strength) {
    let shear_modulus = e.young_modulus / (2.0 * (1.0 + e.poisson_ratio));
    let least = -3.0 * shear_modulus / (1.5 * s.yield_constant);
    let scaled = s.regularisation != Regularisation::None;
    // what is scaled with lengths is judged where these are known, in `scene`
    if s.softening_modulus > least || scaled {
        return;
    }
    let path = format!("{}.softening_modulus", cursor.path);
    let message = format!("`{path}` = {} is too steep", figure(s.softening_modulus));
    let label = format!("must be greater than -3 G / (1.5 k) = {} kPa", rounded(least));
    let help = "the strength would drop faster than the stress: raise `softening_modulus` or \
                `young_modulus`";
    cursor.log.error(at.softening, &path, Problem::new(message, label).help(help));
}
