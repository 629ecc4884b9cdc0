//! The keys of `[material.NAME]` that give softening a length.

use crate::case::Regularisation;
use crate::case::cursor::Cursor;
use crate::case::keys::Keys;
use crate::case::limits::{Limits, between, positive};
use crate::case::log::Problem;

/// m: above 1, where localisation has a limit; a weight that is much larger hardens the soil in its own strain.
const WEIGHT: Limits = between(1.2, 5.0, "");

/// Reads `regularisation` and the keys that belong to its choices.
pub(super) fn read(keys: &mut Keys<'_>) -> Option<Regularisation> {
    let word = keys.or("regularisation", "none", |c| c.word(&["none", "fracture_energy", "nonlocal"]))?;
    let (length, weight) = (keys.get("reference_length"), keys.get("nonlocal_weight"));
    let weightless = word == "nonlocal" || no_meaning(keys, weight.as_ref(), word, "\"nonlocal\"");
    if word == "none" {
        let without = no_meaning(keys, length.as_ref(), word, "\"fracture_energy\" or \"nonlocal\"");
        return (weightless && without).then_some(Regularisation::None);
    }
    let reference_length = reference_length(keys, length)?;
    let nonlocal_weight = weight.filter(|_| word == "nonlocal").map_or(Some(2.0), |c| c.number(WEIGHT))?;
    weightless.then_some(match word {
        "nonlocal" => Regularisation::Nonlocal { reference_length, nonlocal_weight },
        _ => Regularisation::FractureEnergy { reference_length },
    })
}

fn reference_length(keys: &Keys<'_>, given: Option<Cursor<'_>>) -> Option<f64> {
    if let Some(cursor) = given {
        return cursor.number(positive("m"));
    }
    let message = format!("`{}` is missing", keys.path_of("reference_length"));
    let help = "set it (m) to the width of the shear band for which `softening_modulus` was given: the cell of the \
                analysis it was fitted with, or the width seen in a test";
    keys.header_error("reference_length", Problem::new(message, "a regularisation needs a length").help(help))
}

/// Whether a key that the chosen word does not take is absent; one of the file lapses where an override chose.
fn no_meaning(keys: &Keys<'_>, given: Option<&Cursor<'_>>, word: &str, owners: &str) -> bool {
    let Some(cursor) = given else { return true };
    let overridden = keys.named("regularisation").is_some_and(|c| !c.node.span.in_file());
    if cursor.key.in_file() && overridden {
        return true;
    }
    let message = format!("`{}` has no meaning with regularisation = \"{word}\"", cursor.path);
    let help = format!("leave it out, or set `regularisation` to {owners}");
    cursor.key_error(Problem::new(message, format!("a key of regularisation {owners}")).help(help));
    false
}
