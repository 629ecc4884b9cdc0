//! `[[probe]]`.

use super::{default_name, load::items};
use crate::case::cursor::Cursor;
use crate::case::keys::Keys;
use crate::case::limits::{COORDINATE, signed};
use crate::case::log::Problem;
use crate::case::outline::{Extent, place};
use crate::case::{Probe, ProbeQuantity, RegionShape};
use crate::math::polygon::Point;

/// Reads all probes; each must lie in one of the regions.
pub(super) fn probes(root: &mut Keys<'_>, outlines: Option<&[&RegionShape]>) -> Option<Vec<Probe>> {
    items(root, "probe", |index, keys| probe(index, keys, outlines), |probe| &probe.name)
}

fn probe(index: usize, mut keys: Keys<'_>, outlines: Option<&[&RegionShape]>) -> Option<Probe> {
    let name = keys.or("name", default_name("probe", index), own_name);
    let at = keys.required("at", |c| {
        let at = c.pair(COORDINATE)?;
        in_the_soil(c, at, outlines).then_some(at)
    });
    let quantity = keys.required("quantity", quantity);
    let exact = keys.optional("exact", |c| c.number(signed(quantity.map_or("", ProbeQuantity::unit))));
    let source = keys.optional("source", own_name);
    let pair =
        exact.as_ref().zip(source.as_ref()).is_none_or(|(e, s)| belong_together(&keys, e.is_some(), s.is_some()));
    keys.finish();
    pair.then_some(())?;
    Some(Probe { name: name?, at: at?, quantity: quantity?, exact: exact?, source: source? })
}

/// A name that is not empty.
fn own_name(cursor: &Cursor<'_>) -> Option<String> {
    let text = cursor.text()?;
    if text.trim().is_empty() {
        cursor.error(Problem::new(format!("`{}` is empty", cursor.path), "must not be empty"));
        return None;
    }
    Some(text.to_owned())
}

fn quantity(cursor: &Cursor<'_>) -> Option<ProbeQuantity> {
    let word = cursor.word(&ProbeQuantity::ALL.map(ProbeQuantity::word))?;
    ProbeQuantity::ALL.into_iter().find(|quantity| quantity.word() == word)
}

/// Whether there is soil at a place; an outline counts, up to rounding.
fn in_the_soil(cursor: &Cursor<'_>, at: Point, outlines: Option<&[&RegionShape]>) -> bool {
    let Some((shapes, extent)) = outlines.and_then(|shapes| Some((shapes, Extent::of(shapes)?))) else { return true };
    if shapes.iter().any(|shape| shape.reaches(at, 1e-9 * extent.size())) {
        return true;
    }
    let message = format!("there is no soil at {}", place(at));
    let label = "must lie in a region";
    cursor.error(Problem::new(message, label).help("`at` is a place at the start of the run"));
    false
}

fn belong_together(keys: &Keys<'_>, exact: bool, source: bool) -> bool {
    match (exact, source) {
        (true, false) => {
            let problem = Problem::new("this exact value has no source", "needs the key `source`");
            keys.header_error::<()>("source", problem.help("say where the value comes from: a formula, a paper"));
        }
        (false, true) => {
            let problem = Problem::new("this source has no value", "needs the key `exact`");
            keys.header_error::<()>("exact", problem.help("without an exact value leave `source` out"));
        }
        _ => return true,
    }
    false
}
