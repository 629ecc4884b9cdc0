//! `[grid]` and `[points]`.

use crate::case::check::PlacedGrid;
use crate::case::cursor::Cursor;
use crate::case::keys::Keys;
use crate::case::limits::{COORDINATE, positive};
use crate::case::{CutCells, Grid, Layout, Points};

/// Reads `[grid]`, which every case needs.
pub(super) fn grid(root: &mut Keys<'_>) -> Option<PlacedGrid> {
    root.required("grid", |cursor| placed(cursor, cursor.table()?))
}

fn placed(cursor: &Cursor<'_>, mut keys: Keys<'_>) -> Option<PlacedGrid> {
    let mut cell_at = cursor.key;
    let cell = keys.required("cell", |c| {
        cell_at = c.node.span;
        c.formula(positive("m"))
    });
    let origin = keys.or("origin", [0.0, 0.0], |c| c.pair(COORDINATE));
    let size = keys.required("size", |c| c.pair(positive("m")));
    keys.finish();
    let value = Grid { cell: cell?, origin: origin?, size: size? };
    Some(PlacedGrid { value, cell_at })
}

/// Reads `[points]`.
pub(super) fn points(root: &mut Keys<'_>) -> Option<Points> {
    let mut keys = root.section("points")?;
    let layout = keys.or("layout", Layout::Gauss, layout);
    let per_axis = keys.or("per_axis", 2, |c| c.whole(1, 8));
    let cut_cells = keys.or("cut_cells", CutCells::Full, cut_cells);
    keys.finish();
    Some(Points { layout: layout?, per_axis: per_axis? as usize, cut_cells: cut_cells? })
}

fn layout(cursor: &Cursor<'_>) -> Option<Layout> {
    match cursor.word(&["gauss", "even"])? {
        "even" => Some(Layout::Even),
        _ => Some(Layout::Gauss),
    }
}

fn cut_cells(cursor: &Cursor<'_>) -> Option<CutCells> {
    match cursor.word(&["full", "inside", "scaled"])? {
        "inside" => Some(CutCells::Inside),
        "scaled" => Some(CutCells::Scaled),
        _ => Some(CutCells::Full),
    }
}
