//! `[[region]]`.

use super::default_name;
use crate::case::check::PlacedRegion;
use crate::case::cursor::Cursor;
use crate::case::keys::Keys;
use crate::case::limits::{COORDINATE, positive, signed};
use crate::case::log::Problem;
use crate::case::outline;
use crate::case::source::Span;
use crate::case::{Region, RegionShape, Spin, Wave};

/// Most regions of a case.
const MOST: usize = 1000;

/// Reads all regions; one with errors keeps its place in the list.
pub(super) fn regions(root: &mut Keys<'_>) -> Option<Vec<PlacedRegion>> {
    let cursors = root.required("region", |c| {
        let list = c.list()?;
        let message = format!("there are {} regions", list.len());
        if list.is_empty() || list.len() > MOST {
            c.error(Problem::new(message, format!("must be from 1 to {MOST}")));
            return None;
        }
        Some(list)
    })?;
    Some(cursors.iter().enumerate().map(|(index, cursor)| placed(index, cursor)).collect())
}

/// The shapes of all regions; `None` where one has errors.
pub(super) fn outlines(regions: &[PlacedRegion]) -> Option<Vec<&RegionShape>> {
    regions.iter().map(|region| Some(&region.value.as_ref()?.shape)).collect()
}

fn placed(index: usize, cursor: &Cursor<'_>) -> PlacedRegion {
    let mut places = PlacedRegion {
        path: cursor.path.clone(),
        name_at: cursor.node.span,
        material_at: cursor.node.span,
        shape_at: cursor.node.span,
        corners_at: Vec::new(),
        value: None,
    };
    let value = cursor.table().and_then(|keys| region(index, keys, &mut places));
    PlacedRegion { value, ..places }
}

fn region(index: usize, mut keys: Keys<'_>, places: &mut PlacedRegion) -> Option<Region> {
    let name = keys.or("name", default_name("region", index), |c| {
        places.name_at = c.node.span;
        c.text().map(str::to_owned)
    });
    let material = keys.required("material", |c| {
        places.material_at = c.node.span;
        c.text().map(str::to_owned)
    });
    let shape = keys.either("polygon", "circle").and_then(|c| {
        places.shape_at = c.key;
        shape(&c, &mut places.corners_at)
    });
    let velocity = keys.or("velocity", [0.0, 0.0], |c| c.pair(signed("m/s")));
    let spin = keys.optional("spin", spin);
    let wave = keys.optional("wave", wave);
    keys.finish();
    Some(Region { name: name?, material: material?, shape: shape?, velocity: velocity?, spin: spin?, wave: wave? })
}

fn shape(cursor: &Cursor<'_>, corners_at: &mut Vec<Span>) -> Option<RegionShape> {
    if cursor.path.ends_with("circle") {
        return circle(cursor.table()?);
    }
    let items = cursor.list()?;
    let corners: Vec<_> = items.iter().map(|item| item.pair(COORDINATE)).collect();
    let corners: Vec<_> = corners.into_iter().collect::<Option<_>>()?;
    corners_at.extend(items.iter().map(|item| item.node.span));
    match outline::problem(&corners) {
        Some(problem) => {
            cursor.key_error(problem);
            None
        }
        None => Some(RegionShape::Polygon(corners)),
    }
}

fn circle(mut keys: Keys<'_>) -> Option<RegionShape> {
    let center = keys.required("center", |c| c.pair(COORDINATE));
    let radius = keys.required("radius", |c| c.number(positive("m")));
    keys.finish();
    Some(RegionShape::Circle { center: center?, radius: radius? })
}

fn spin(cursor: &Cursor<'_>) -> Option<Spin> {
    let mut keys = cursor.table()?;
    let rate = keys.required("rate", |c| c.number(signed("rad/s")));
    let center = keys.required("center", |c| c.pair(COORDINATE));
    keys.finish();
    Some(Spin { rate: rate?, center: center? })
}

fn wave(cursor: &Cursor<'_>) -> Option<Wave> {
    let mut keys = cursor.table()?;
    let amplitude = keys.required("amplitude", |c| c.pair(signed("m/s")));
    let number = |c: &Cursor<'_>| c.pair_by(|item| item.formula(signed("rad/m")));
    let wave_number = keys.required("wave_number", number);
    keys.finish();
    Some(Wave { amplitude: amplitude?, wave_number: wave_number? })
}
