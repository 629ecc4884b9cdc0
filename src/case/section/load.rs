//! `[[load]]` and `[[drive]]`.

use std::collections::BTreeMap;

use super::default_name;
use crate::case::cursor::Cursor;
use crate::case::keys::Keys;
use crate::case::limits::{COORDINATE, DURATION, INTERVAL, signed};
use crate::case::log::Problem;
use crate::case::outline::place;
use crate::case::tree::Value;
use crate::case::{Drive, Load};

/// Most items of a list of a case.
const MOST: usize = 1000;

/// Reads all loads.
pub(super) fn loads(root: &mut Keys<'_>) -> Option<Vec<Load>> {
    items(root, "load", load, |load| &load.name)
}

/// Reads all drives.
pub(super) fn drives(root: &mut Keys<'_>) -> Option<Vec<Drive>> {
    items(root, "drive", drive, |drive| &drive.name)
}

/// Reads a list of named tables; none is an empty one.
pub(super) fn items<T>(
    root: &mut Keys<'_>,
    list: &'static str,
    read: impl Fn(usize, Keys<'_>) -> Option<T>,
    name: fn(&T) -> &str,
) -> Option<Vec<T>> {
    root.or(list, Vec::new(), |c| {
        let Value::Array(_) = c.node.value else { return c.wrong_type(&format!("a list: write [[{list}]]")) };
        let cursors = c.list()?;
        if cursors.len() > MOST {
            let message = format!("there are {} items of `{list}`", cursors.len());
            c.error(Problem::new(message, format!("must be at most {MOST}")));
            return None;
        }
        // every item is read, so that every error is found
        let found: Vec<_> = cursors.iter().enumerate().map(|(k, c)| read(k, c.table()?)).collect();
        let found: Vec<T> = found.into_iter().collect::<Option<_>>()?;
        unlike_names(&cursors, found.iter().map(name))?;
        Some(found)
    })
}

/// Overrides and messages go by the names.
fn unlike_names<'a>(cursors: &[Cursor<'_>], names: impl Iterator<Item = &'a str>) -> Option<()> {
    let mut seen = BTreeMap::new();
    for (cursor, name) in cursors.iter().zip(names) {
        if let Some(first) = seen.insert(name, &cursor.path) {
            let message = format!("`{first}` and `{}` have the same name \"{name}\"", cursor.path);
            cursor.error(Problem::new(message, "needs a name of its own"));
            return None;
        }
    }
    Some(())
}

fn load(index: usize, mut keys: Keys<'_>) -> Option<Load> {
    let name = name(&mut keys, "load", index);
    let area = keys.required("box", area);
    let force = keys.required("force", |c| c.pair(signed("kN/m")));
    let ramp_time = keys.or("ramp_time", 0.0, |c| c.number(DURATION));
    keys.finish();
    Some(Load { name: name?, area: area?, force: force?, ramp_time: ramp_time? })
}

fn drive(index: usize, mut keys: Keys<'_>) -> Option<Drive> {
    let name = name(&mut keys, "drive", index);
    let area = keys.required("box", area);
    let velocity_x = keys.optional("velocity_x", |c| c.number(signed("m/s")));
    let velocity_y = keys.optional("velocity_y", |c| c.number(signed("m/s")));
    let moving = keys.or("moving", true, |c| c.flag());
    let until = keys.optional("until", |c| c.number(INTERVAL));
    let idle = velocity_x == Some(None) && velocity_y == Some(None);
    let driven = if idle { no_velocity(&keys) } else { Some(()) };
    keys.finish();
    driven?;
    Some(Drive {
        name: name?,
        area: area?,
        velocity_x: velocity_x?,
        velocity_y: velocity_y?,
        moving: moving?,
        until: until?,
    })
}

fn no_velocity(keys: &Keys<'_>) -> Option<()> {
    let problem = Problem::new("this drive moves nothing", "needs `velocity_x`, `velocity_y` or both");
    keys.header_error("velocity_x", problem.help("an axis left out is free; 0 holds the nodes"))
}

/// The name of an item, by default its place in the list.
pub(super) fn name(keys: &mut Keys<'_>, list: &str, index: usize) -> Option<String> {
    keys.or("name", default_name(list, index), |c| c.text().map(str::to_owned))
}

/// A box by its lower left and its upper right corner.
fn area(cursor: &Cursor<'_>) -> Option<[[f64; 2]; 2]> {
    let corners = cursor.list()?;
    let [low, high] = corners.as_slice() else {
        let message = format!("`{}` has {} corners", cursor.path, corners.len());
        cursor.error(Problem::new(message, "must be two corners: [[x0, y0], [x1, y1]]"));
        return None;
    };
    let (low, high) = (low.pair(COORDINATE), high.pair(COORDINATE));
    let (low, high) = (low?, high?);
    if low[0] > high[0] || low[1] > high[1] {
        let message = format!("`{}` goes from {} to {}", cursor.path, place(low), place(high));
        cursor.error(Problem::new(message, "must go from the lower left to the upper right corner"));
        return None;
    }
    Some([low, high])
}
