//! `[slide]`: how the sliding distance is read. Its defaults come from the outline of the soil.

use crate::case::cursor::Cursor;
use crate::case::keys::Keys;
use crate::case::limits::{COORDINATE, DURATION, between, figure, not_negative, positive};
use crate::case::log::Problem;
use crate::case::outline::Extent;
use crate::case::{RegionShape, Slide};
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
    let levels = keys.or("initial_levels", vec![0.25, 0.5, 1.0], levels);
    let middle = levels.as_ref().and_then(|l| l.get(l.len() / 2)).copied();
    let level = match keys.get("initial_level") {
        Some(cursor) => main_level(&cursor, levels.as_deref()),
        None => middle,
    };
    let onset_energy = keys.or("onset_energy", 0.01, |c| c.number(between(1e-9, 1.0, "")));
    keys.finish();
    Some(Slide {
        crest: crest?,
        threshold: threshold?,
        also: also?,
        censored_above: censored_above?,
        block_hold: block_hold?,
        block_length: block_length?,
        initial_levels: levels?,
        initial_level: level?,
        onset_energy: onset_energy?,
    })
}

/// Rising levels, at least one.
fn levels(cursor: &Cursor<'_>) -> Option<Vec<f64>> {
    let found = cursor.numbers(positive("m"))?;
    if !found.is_empty() && found.windows(2).all(|pair| pair[0] < pair[1]) {
        return Some(found);
    }
    let message = format!("`{}` is not a list of rising numbers", cursor.path);
    cursor.error(Problem::new(message, "must be rising displacements, such as [0.25, 0.5, 1.0]"));
    None
}

fn main_level(cursor: &Cursor<'_>, levels: Option<&[f64]>) -> Option<f64> {
    let (level, levels) = (cursor.number(positive("m"))?, levels?);
    if levels.contains(&level) {
        return Some(level);
    }
    let message = format!("`{}` = {} is not one of the levels", cursor.path, figure(level));
    let known: Vec<String> = levels.iter().map(|l| figure(*l)).collect();
    let problem = Problem::new(message, format!("the levels are {}", known.join(", ")));
    cursor.error(problem.help("add it to `slide.initial_levels`"));
    None
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
