//! The keys of `[material.NAME]` that give softening a length.

use crate::case::Regularisation;
use crate::case::cursor::Cursor;
use crate::case::keys::Keys;
use crate::case::limits::positive;
use crate::case::log::Problem;

/// Reads `regularisation` and the keys that belong to its choices.
pub(super) fn read(keys: &mut Keys<'_>) -> Option<Regularisation> {
    let word = keys.or("regularisation", "none", |c| c.word(&["none", "fracture_energy"]));
    let length = keys.get("reference_length");
    match word? {
        "fracture_energy" => Some(Regularisation::FractureEnergy { reference_length: reference_length(keys, length)? }),
        word => no_meaning(keys, length, word).then_some(Regularisation::None),
    }
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
fn no_meaning(keys: &Keys<'_>, given: Option<Cursor<'_>>, word: &str) -> bool {
    let Some(cursor) = given else { return true };
    let overridden = keys.named("regularisation").is_some_and(|c| !c.node.span.in_file());
    if cursor.key.in_file() && overridden {
        return true;
    }
    let message = format!("`{}` has no meaning with regularisation = \"{word}\"", cursor.path);
    let help = "leave it out, or set `regularisation` to \"fracture_energy\"";
    cursor.key_error(Problem::new(message, "a key of a regularised softening").help(help));
    false
}
