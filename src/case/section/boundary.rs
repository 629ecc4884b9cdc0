//! `[boundary]`: each side a bare word or a table with its `kind`.

use crate::case::cursor::Cursor;
use crate::case::keys::{Keys, Variant};
use crate::case::limits::between;
use crate::case::log::Problem;
use crate::case::tree::Value;
use crate::case::{Boundary, Side};

const KINDS: &[Variant] = &[
    Variant { word: "free", keys: &[] },
    Variant { word: "roller", keys: &[] },
    Variant { word: "fixed", keys: &[] },
    Variant { word: "friction", keys: &["coefficient", "separation"] },
];

/// Reads `[boundary]`.
pub(super) fn boundary(root: &mut Keys<'_>) -> Option<Boundary> {
    let mut keys = root.section("boundary")?;
    let left = keys.or("left", Side::Free, side);
    let right = keys.or("right", Side::Free, side);
    let base = keys.or("base", Side::Free, side);
    let top = keys.or("top", Side::Free, side);
    keys.finish();
    Some(Boundary { left: left?, right: right?, base: base?, top: top? })
}

fn side(cursor: &Cursor<'_>) -> Option<Side> {
    match cursor.node.value {
        Value::Text(_) => bare_side(cursor),
        Value::Table(_) => table_side(cursor.table()?),
        _ => cursor.wrong_type("a word such as \"roller\" or a table with `kind`"),
    }
}

fn bare_side(cursor: &Cursor<'_>) -> Option<Side> {
    let kind = cursor.word(&["free", "roller", "fixed", "friction"])?;
    let plain = plain_side(kind);
    if plain.is_none() {
        let message = format!("`{}.coefficient` is missing", cursor.path);
        let help = "write { kind = \"friction\", coefficient = 0.3 }";
        cursor.error(Problem::new(message, "friction needs a coefficient").help(help));
    }
    plain
}

fn plain_side(kind: &str) -> Option<Side> {
    match kind {
        "free" => Some(Side::Free),
        "roller" => Some(Side::Roller),
        "fixed" => Some(Side::Fixed),
        _ => None,
    }
}

fn table_side(mut keys: Keys<'_>) -> Option<Side> {
    let kind = keys.tag("kind", None, KINDS);
    let side = kind.and_then(|kind| plain_side(kind).or_else(|| friction(&mut keys)));
    keys.finish();
    side
}

fn friction(keys: &mut Keys<'_>) -> Option<Side> {
    let coefficient = keys.required("coefficient", |c| c.number(between(0.0, 100.0, "")));
    let separation = keys.or("separation", true, |c| c.flag());
    Some(Side::Friction { coefficient: coefficient?, separation: separation? })
}
