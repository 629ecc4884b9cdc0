//! `[strength_reduction]`: the search for the factor of safety.

use crate::case::check::Materials;
use crate::case::keys::Keys;
use crate::case::limits::{between, figure};
use crate::case::log::Problem;
use crate::case::{Material, StrengthReduction};

/// Reads `[strength_reduction]`; no table, no search.
pub(super) fn strength_reduction(
    root: &mut Keys<'_>,
    materials: Option<&Materials>,
) -> Option<Option<StrengthReduction>> {
    root.optional("strength_reduction", |cursor| {
        let found = read(cursor.table()?)?;
        let soils = materials.map(|m| m.by_name.iter().filter_map(|(name, (_, soil))| Some((name, soil.as_ref()?))));
        let softens =
            |soil: &Material| matches!(soil, Material::VonMises { strength, .. } if strength.softening_modulus != 0.0);
        let soft = soils.into_iter().flatten().find(|(_, soil)| softens(soil));
        let Some((name, _)) = soft else { return Some(found) };
        let message = format!("a factor of safety needs a constant strength, and `{name}` softens or hardens");
        let problem = Problem::new(message, "strengths are divided by one factor");
        cursor.key_error(problem.help(format!("set material.{name}.softening_modulus = 0")));
        None
    })
}

fn read(mut keys: Keys<'_>) -> Option<StrengthReduction> {
    let factor = between(1e-3, 1e3, "");
    let low = keys.or("low", 0.5, |c| c.number(factor));
    let high = keys.or("high", 4.0, |c| c.number(factor));
    let tolerance = keys.or("tolerance", 0.005, |c| c.number(between(1e-6, 1.0, "")));
    let (low, high) = (low?, high?);
    if low >= high {
        let message = format!("`low` = {} does not lie below `high` = {}", figure(low), figure(high));
        let problem = Problem::new(message, "the slope must stand with `low` and fail with `high`");
        return keys.header_error("low", problem);
    }
    keys.finish();
    Some(StrengthReduction { low, high, tolerance: tolerance? })
}
