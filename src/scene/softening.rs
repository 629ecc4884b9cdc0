//! Softening with a length: what the cells of the grid make of the modulus of a case.
//!
//! A local law localises into the narrowest band that the shape functions can strain, n cells wide, and
//! dissipates w = n h times the energy per volume. With H given for bands of width l_ref the modulus
//! ```text
//! H_eff = H n h / l_ref
//! ```
//! makes the energy per area that of H in a band of width l_ref, whatever h (Pietruszczak & Mroz 1981; Bazant & Oh
//! 1983).

use super::{SceneError, band, refuse};
use crate::{
    assembly::nonlocal::Average,
    body::{Body, Group},
    case::{self, Case, Regularisation},
    material::Strength,
};

/// n, the width of a shear band in cells. The strain of a bilinear cell is the same in all its points, so that one
/// row of cells softens. So it is with GIMP while the domains lie within cells: on the layer of `rmpm validate
/// shear-layer` both have bands of 1.00 to 1.03 cells. Domains that reach across a face would widen a band; points that
/// travel do so all the time, and what it makes of n has not been measured.
const BAND_CELLS: f64 = 1.0;

/// Factor on the softening modulus of a soil on the grid of a case. A nonlocal band dissipates what one of its effective
/// width does, `band::effective_width` times l_ref.
pub fn factor(case: &Case, strength: &case::Strength) -> f64 {
    match strength.regularisation {
        Regularisation::None => 1.0,
        Regularisation::FractureEnergy { reference_length } => BAND_CELLS * case.grid.cell / reference_length,
        Regularisation::Nonlocal { nonlocal_weight, .. } => band::effective_width(nonlocal_weight),
    }
}

/// Plastic strain at which a softening soil is residual on the grid of a case; `None` if it does not soften.
pub fn residual_strain(case: &Case, material: &case::Material) -> Option<f64> {
    match material {
        case::Material::VonMises { strength: s, .. } if s.softening_modulus < 0.0 => {
            Some((s.residual_cohesion - s.cohesion) / (factor(case, s) * s.softening_modulus))
        }
        _ => None,
    }
}

/// Cell (m) on which the mean soil would soften as fast as its stress falls; infinite where it does not soften.
pub fn largest_cell(case: &Case, elastic: &case::Elastic, strength: &case::Strength) -> f64 {
    let g = elastic.young_modulus / (2.0 * (1.0 + elastic.poisson_ratio));
    let steepness = -1.5 * strength.yield_constant * factor(case, strength) * strength.softening_modulus / (3.0 * g);
    if steepness > 0.0 { case.grid.cell / steepness } else { f64::INFINITY }
}

/// The averages that the groups of a body soften by.
pub fn averages(case: &Case, body: &Body) -> Vec<Average> {
    let materials: Vec<&case::Material> = case.material.values().collect();
    let average = |(group, g): (usize, &Group)| match materials.get(usize::from(g.material)) {
        Some(case::Material::VonMises { strength, .. }) => match strength.regularisation {
            Regularisation::Nonlocal { reference_length: length, nonlocal_weight: weight } => {
                Some(Average { group, length, weight })
            }
            _ => None,
        },
        _ => None,
    };
    body.groups.iter().enumerate().filter_map(average).collect()
}

/// The return to the yield surface exists while 3G + k f H > 0, f being the factor on the strength; half as
/// much again as the initial volume is allowed for. Nonlocal softening lags by a step, and so settles only while its
/// steepest change, with max(1, m - 1) H, stays below the same. The case is checked for its means, a field's values
/// here.
///
/// # Errors
/// A point whose strength would drop faster than its stress, with the largest cell for which it would not.
pub fn check(case: &Case, strength: &case::Strength, p: &Strength) -> Result<(), SceneError> {
    let (modulus, g) = (p.softening_modulus, p.elasticity.shear_modulus);
    let steepest = match strength.regularisation {
        Regularisation::Nonlocal { nonlocal_weight, .. } => (nonlocal_weight - 1.0).max(1.0),
        _ => 1.0,
    };
    let least = -3.0 * g / (1.5 * p.yield_constant * steepest);
    if modulus > least {
        return Ok(());
    }
    let (key, advice) = match strength.regularisation {
        Regularisation::FractureEnergy { .. } => {
            let largest = case.grid.cell * least / modulus;
            ("grid.cell", format!("use cells of less than {largest:.4} m or a longer `reference_length`"))
        }
        Regularisation::Nonlocal { .. } => (
            "material",
            "raise `softening_modulus` or `young_modulus`, or lower the variation of the fields".to_owned(),
        ),
        Regularisation::None => ("field", "lower the variation of the fields".to_owned()),
    };
    let soft = format!("a point has a softening modulus of {modulus:.4} kPa with a shear modulus of {g:.4} kPa");
    Err(refuse(key, format!("{soft}: the strength would drop faster than the stress; {advice}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{body::Column, scene};

    /// The scene of the paper's slope with fracture energy and some more keys.
    fn build(keys: &[&str]) -> Result<scene::Scene, SceneError> {
        let energy = ["material.clay.regularisation=fracture_energy", "material.clay.reference_length=0.25"];
        let keys: Vec<String> = energy.iter().chain(keys).map(|k| (*k).to_owned()).collect();
        let text = case::template("slope").expect("a template");
        let (case, _) = case::read("slope", text, &keys).unwrap_or_else(|e| panic!("{e}"));
        scene::build(&case, u64::MAX)
    }

    fn moduli(scene: &scene::Scene) -> &Column {
        &scene.simulation.body.groups[0].params[4]
    }

    #[test]
    fn the_modulus_goes_with_the_cell_and_the_energy_per_area_stays() {
        let scene = build(&["grid.cell=0.5"]).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(moduli(&scene), &Column::Uniform(-100.0));
        // on the paper's cells nothing changes
        let scene = build(&[]).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(moduli(&scene), &Column::Uniform(-50.0));
    }

    #[test]
    fn a_modulus_that_varies_is_scaled_point_by_point() {
        let field = "field.soft={material=\"clay\", parameters=[\"softening_modulus\"], variation=0.2, theta_h=2, theta_v=2, distribution=\"lognormal\"}";
        let (fine, scaled) = (build(&[field]), build(&[field, "material.clay.reference_length=0.5"]));
        let (fine, scaled) = (fine.unwrap_or_else(|e| panic!("{e}")), scaled.unwrap_or_else(|e| panic!("{e}")));
        let (Column::Varying(a), Column::Varying(b)) = (moduli(&fine), moduli(&scaled)) else { panic!("both vary") };
        assert!(a.iter().zip(b).all(|(a, b)| 0.5 * a == *b));
    }

    #[test]
    fn cells_too_large_for_the_length_are_refused_with_the_largest() {
        // 3 G / (1.5 k) = 434.1 kPa = 50 kPa h / l_ref
        let refused = build(&["grid.cell=0.5", "material.clay.reference_length=0.05"]).err().expect("too steep");
        assert_eq!(refused.key, "grid.cell");
        assert!(refused.message.contains("less than 0.4341 m"), "{refused}");
        assert!(build(&["grid.cell=0.5", "material.clay.reference_length=0.06"]).is_ok());
        // a modulus that is too steep as it stands may do on small cells
        let steep = ["material.clay.softening_modulus=-800", "material.clay.reference_length=1"];
        assert!(build(&steep).is_ok());
    }
}
