//! `[slide]`: how the sliding distance is read. Its defaults come from the outline of the soil.

use crate::case::keys::Keys;
use crate::case::limits::{COORDINATE, DURATION, figure, not_negative, positive};
use crate::case::log::Problem;
use crate::case::outline::Extent;
use crate::case::types::{RegionShape, Slide};
use crate::math::polygon::Point;

/// Reads `[slide]`; no table, no slide.
pub(super) fn slide(root: &mut Keys<'_>, outlines: Option<&[&RegionShape]>) -> Option<Option<Slide>> {
    root.optional("slide", |cursor| read(cursor.table()?, outlines))
}

fn read(mut keys: Keys<'_>, outlines: Option<&[&RegionShape]>) -> Option<Slide> {
    let extent = outlines.and_then(Extent::of);
    let crest = crest(&mut keys, outlines, extent.as_ref());
    let height = crest.zip(extent.as_ref()).map(|(crest, soil)| crest[1] - soil.low[1]);
    let width = crest.zip(extent.as_ref()).map(|(crest, soil)| crest[0] - soil.low[0]);
    let threshold = length(&mut keys, "threshold", height.map(|h| 0.05 * h));
    let twice = threshold.map(|threshold| vec![2.0 * threshold]).unwrap_or_default();
    let also = keys.or("also", twice, |c| c.numbers(positive("m")));
    let censored_above = length(&mut keys, "censored_above", width.map(|w| 0.9 * w));
    let block_hold = keys.or("block_hold", 0.5, |c| c.number(DURATION));
    let block_length = keys.or("block_length", 1.0, |c| c.number(not_negative("m")));
    keys.finish();
    Some(Slide {
        crest: crest?,
        threshold: threshold?,
        also: also?,
        censored_above: censored_above?,
        block_hold: block_hold?,
        block_length: block_length?,
    })
}

/// A length whose default is measured on the soil; `None` where there is no soil to measure.
fn length(keys: &mut Keys<'_>, key: &'static str, default: Option<f64>) -> Option<f64> {
    if let Some(cursor) = keys.get(key) {
        return cursor.number(positive("m"));
    }
    let default = default?;
    if default > 0.0 {
        return Some(default);
    }
    let message = format!("`slide.{key}` has no default here");
    let problem = Problem::new(message, "the crest is the lowest or leftmost point of the soil");
    keys.header_error(key, problem.help(format!("set `slide.{key}`, or move `slide.crest`")))
}

fn crest(keys: &mut Keys<'_>, outlines: Option<&[&RegionShape]>, extent: Option<&Extent>) -> Option<Point> {
    let Some(cursor) = keys.get("crest") else {
        let found = extent?.crest;
        let problem = Problem::new("no crest can be found", "no region is a polygon")
            .help("set `slide.crest`, or leave the table `slide` out");
        return found.or_else(|| keys.header_error("crest", problem));
    };
    let crest = cursor.pair(COORDINATE)?;
    let (Some(outlines), Some(extent)) = (outlines, extent) else { return Some(crest) };
    let near = 1e-6 * extent.size();
    if outlines.iter().any(|shape| shape.reaches(crest, near)) {
        return Some(crest);
    }
    let message = format!("the crest ({}, {}) lies outside the soil", figure(crest[0]), figure(crest[1]));
    let found = extent.crest.map(|[x, y]| format!("the highest corner is [{x}, {y}]"));
    cursor.error(Problem::new(message, "must lie in a region").help_if(found));
    None
}
