//! Where everything of a factor lies: made once for a structure.

use std::ops::Range;

use super::tree::{Supernode, supernodes};
use crate::math::{ordering::inverted, sparse::Pattern};

/// Columns, and rows, of a block of the dense kernels.
pub(super) const WIDTH: usize = 8;

/// A front: the columns of a supernode in a panel of columns, and what it leaves to its parent.
///
/// The rows of a panel are its own unknowns, padded to whole blocks, then those below, then the right side. What it
/// leaves, the update, has the rows below and the right side, and a column for each row below.
#[derive(Clone, Debug, Default)]
pub(super) struct Front {
    /// Place of the first node, and how many there are.
    pub first: usize,
    pub nodes: usize,
    /// Unknowns padded to whole blocks.
    pub padded: usize,
    /// Nodes below, in `Plan::rows`.
    pub rows: Range<usize>,
    /// Length of a column of the panel, and of the update.
    pub panel_column: usize,
    pub update_column: usize,
    /// Where the panel starts among the values, and the update in the workspace.
    pub panel: usize,
    pub update: usize,
    pub children: Range<usize>,
    /// Blocks of the matrix, in `Plan::entries`.
    pub entries: Range<usize>,
    /// Where the rows of the update go in the parent's panel, in `Plan::pieces`.
    pub pieces: Range<usize>,
}

impl Front {
    /// Unknowns of its own.
    pub fn own(&self) -> usize {
        2 * self.nodes
    }

    /// Unknowns below.
    pub fn below(&self) -> usize {
        2 * self.rows.len()
    }

    /// Values of the panel.
    pub fn panel_len(&self) -> usize {
        self.padded * self.panel_column
    }

    /// Values of the update: whole blocks of columns.
    pub fn update_len(&self) -> usize {
        self.below().next_multiple_of(WIDTH) * self.update_column
    }

    /// Row of the right side in the panel.
    pub fn right(&self) -> usize {
        self.padded + self.below()
    }
}

/// A block of two by two values of the matrix.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Its first value, and the values between its columns.
    pub from: u32,
    pub stride: u32,
    /// Where it goes, from the start of the panel.
    pub to: u32,
}

/// Rows that follow each other in an update and in the parent's panel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub from: u32,
    pub to: u32,
    pub len: u32,
}

/// All fronts, children before parents.
#[derive(Debug, Default)]
pub(super) struct Plan {
    pub fronts: Vec<Front>,
    pub rows: Vec<u32>,
    pub children: Vec<u32>,
    pub entries: Vec<Entry>,
    pub pieces: Vec<Piece>,
    /// Node at each place.
    pub order: Vec<u32>,
    /// Values of all panels, and of the workspace of the updates.
    pub values: usize,
    pub workspace: usize,
    /// Longest column of a panel.
    pub longest: usize,
}

impl Plan {
    /// For nodes that are eliminated in about this order.
    pub fn new(pattern: &Pattern, order: &[u32]) -> Self {
        let (tree, order) = supernodes(pattern, order);
        let mut plan = Plan { order, ..Plan::default() };
        tree.iter().for_each(|s| plan.add(s));
        plan.enter(pattern);
        plan.place_updates();
        for s in 0..tree.len() {
            plan.cut_pieces(s);
        }
        plan
    }

    fn add(&mut self, s: &Supernode) {
        let padded = (2 * s.columns.len()).next_multiple_of(WIDTH);
        let update_column = (2 * s.rows.len() + 1).next_multiple_of(WIDTH);
        let mut panel_column = padded + update_column;
        // columns a power of two apart would share the sets of the cache
        if panel_column.is_multiple_of(64) {
            panel_column += WIDTH;
        }
        let (rows, children) = (self.rows.len(), self.children.len());
        self.rows.extend(&s.rows);
        self.children.extend(&s.children);
        let front = Front {
            first: s.columns.first().map_or(0, |&c| c as usize),
            nodes: s.columns.len(),
            padded,
            rows: rows..self.rows.len(),
            panel_column,
            update_column,
            panel: self.values,
            children: children..self.children.len(),
            ..Front::default()
        };
        self.values += front.panel_len();
        self.longest = self.longest.max(panel_column);
        self.fronts.push(front);
    }

    /// Finds the blocks of the matrix that each panel holds.
    fn enter(&mut self, pattern: &Pattern) {
        let place = inverted(&self.order);
        let mut local = vec![0; self.order.len()];
        for front in &mut self.fronts {
            let start = self.entries.len();
            for (k, &row) in self.rows[front.rows.clone()].iter().enumerate() {
                local[row as usize] = front.padded + 2 * k;
            }
            (0..front.nodes).for_each(|k| local[front.first + k] = 2 * k);
            for k in 0..front.nodes {
                let j = self.order[front.first + k] as usize;
                let stride = pattern.stride(j);
                let below = pattern.neighbours(j).enumerate().filter(|(_, i)| place[*i] as usize >= front.first + k);
                self.entries.extend(below.map(|(at, i)| Entry {
                    from: (pattern.col_ptr()[2 * j] as usize + 2 * at) as u32,
                    stride: stride as u32,
                    to: (2 * k * front.panel_column + local[place[i] as usize]) as u32,
                }));
            }
            front.entries = start..self.entries.len();
        }
    }

    /// Gives each update a place in the workspace that is free from its front to its parent's.
    fn place_updates(&mut self) {
        let mut free = Free::default();
        for s in 0..self.fronts.len() {
            self.fronts[s].update = free.take(self.fronts[s].update_len());
            for &c in &self.children[self.fronts[s].children.clone()] {
                let child = &self.fronts[c as usize];
                free.give(child.update, child.update_len());
            }
        }
        self.workspace = free.end;
    }

    /// Where the updates of the children of a front go.
    fn cut_pieces(&mut self, s: usize) {
        let front = self.fronts[s].clone();
        let (last, rows) = (front.first + front.nodes, &self.rows[front.rows.clone()]);
        for &c in &self.children[front.children.clone()] {
            let start = self.pieces.len();
            let child = &mut self.fronts[c as usize];
            let mut at = 0;
            for (k, &row) in (0..).zip(&self.rows[child.rows.clone()]) {
                let to = if (row as usize) < last {
                    2 * (row as usize - front.first)
                } else {
                    at += rows[at..].partition_point(|r| *r < row);
                    front.padded + 2 * at
                };
                join(&mut self.pieces, start, Piece { from: 2 * k, to: to as u32, len: 2 });
            }
            let right = Piece { from: child.below() as u32, to: front.right() as u32, len: 1 };
            join(&mut self.pieces, start, right);
            child.pieces = start..self.pieces.len();
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let small = 4 * (self.rows.capacity() + self.children.capacity() + self.order.capacity());
        let pieces = self.pieces.capacity() * size_of::<Piece>() + self.entries.capacity() * size_of::<Entry>();
        small + pieces + self.fronts.capacity() * size_of::<Front>()
    }
}

/// Adds a piece, as part of the one before where it goes on.
fn join(pieces: &mut Vec<Piece>, start: usize, piece: Piece) {
    if pieces.len() > start
        && let Some(last) = pieces.last_mut()
        && last.from + last.len == piece.from
        && last.to + last.len == piece.to
    {
        last.len += piece.len;
        return;
    }
    pieces.push(piece);
}

/// The free parts of the workspace, ascending, and its end so far.
#[derive(Default)]
struct Free {
    parts: Vec<Range<usize>>,
    end: usize,
}

impl Free {
    /// The first part that is long enough.
    fn take(&mut self, len: usize) -> usize {
        if len == 0 {
            return 0;
        }
        if let Some(k) = self.parts.iter().position(|p| p.len() >= len) {
            let start = self.parts[k].start;
            self.parts[k].start += len;
            if self.parts[k].is_empty() {
                self.parts.remove(k);
            }
            return start;
        }
        let start = match self.parts.last() {
            Some(last) if last.end == self.end => self.parts.pop().map_or(self.end, |p| p.start),
            _ => self.end,
        };
        self.end = start + len;
        start
    }

    fn give(&mut self, start: usize, len: usize) {
        if len == 0 {
            return;
        }
        let k = self.parts.partition_point(|p| p.start < start);
        self.parts.insert(k, start..start + len);
        if self.parts.get(k + 1).is_some_and(|p| p.start == start + len) {
            self.parts[k].end = self.parts[k + 1].end;
            self.parts.remove(k + 1);
        }
        if k > 0 && self.parts[k - 1].end == start {
            self.parts[k - 1].end = self.parts[k].end;
            self.parts.remove(k);
        }
    }
}
