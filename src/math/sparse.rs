//! The structure of a matrix over the nodes of a grid, two unknowns a node.
//!
//! Unknown `2 i + a` is component `a` of node `i`. Nodes are sorted by their grid number
//! `x + y row`, so the entries of a column come in the order of the bits of the node's mask: the
//! place of every 2 x 2 block follows from one population count, and assembly needs no search.

/// Nodes that a node can couple with on each side, along each axis.
const REACH: i32 = 3;
/// Width of the neighbourhood.
const WIDTH: u32 = 7;
/// Bits of a mask: 7 x 7 nodes.
const ALL: u64 = (1 << (WIDTH * WIDTH)) - 1;
/// Bits of one line of the neighbourhood.
const LINE: u64 = (1 << WIDTH) - 1;
/// The node itself.
const SELF: u32 = offset_bit(0, 0);

/// Bit of the neighbour at (`dx`, `dy`), both within -3..=3: bit 24 is the node itself, and the
/// neighbour in the opposite direction has bit `48 - bit`.
pub const fn offset_bit(dx: i32, dy: i32) -> u32 {
    ((dy + REACH) * WIDTH as i32 + dx + REACH) as u32
}

/// What [`Pattern::adopt`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// The structure is that of the step before.
    Same,
    /// The step needs less than the structure holds; it was kept.
    Subset,
    /// The structure was made anew: factors and values belong to another matrix.
    Rebuilt,
}

/// Structure of a square, structurally symmetric matrix in compressed columns, both triangles stored.
///
/// The arrays keep their capacity, so steps that do not grow do not allocate. Fewer than 2^31 values.
#[derive(Clone, Debug, Default)]
pub struct Pattern {
    row: u32,
    /// Grid numbers of the nodes, ascending.
    ids: Vec<u32>,
    /// Masks as they were asked for when the structure was made.
    asked: Vec<u64>,
    /// Masks of the structure: symmetric, without nodes that are not there.
    masks: Vec<u64>,
    /// First value of column `2 j`.
    start: Vec<u32>,
    col_ptr: Vec<u32>,
    row_idx: Vec<u32>,
    /// Node number of each slot.
    ranks: Vec<u32>,
    /// Node numbers without a slot.
    unused: Vec<u32>,
    /// (grid number, slot) of this step, ascending.
    sorted: Vec<(u32, u32)>,
    fingerprint: u64,
}

impl Pattern {
    /// Takes in the active nodes of a step: grid numbers `ids` in slot order and, per slot, the mask
    /// of the nodes it couples with. A grid row has `row` nodes, and no grid number comes twice.
    ///
    /// The structure is kept if it is the same, or, with `keep_superset`, if it contains what the step
    /// needs; else it is made anew. Bits of nodes that are not active are left out, and a coupling
    /// that only one of two nodes names is stored for both. Slots are given their ranks in any case.
    pub fn adopt(&mut self, row: u32, ids: &[u32], masks: &[u64], keep_superset: bool) -> Change {
        let slots = ids.len().min(masks.len());
        self.sorted.clear();
        self.sorted.extend(ids[..slots].iter().zip(0..).map(|(&id, slot)| (id, slot)));
        self.sorted.sort_unstable();
        self.ranks.clear();
        self.ranks.resize(slots, 0);
        let change = match self.fit(row, masks) {
            Some(Change::Subset) if !keep_superset => Change::Rebuilt,
            fit => fit.unwrap_or(Change::Rebuilt),
        };
        if change == Change::Rebuilt {
            self.rebuild(row, masks);
        }
        change
    }

    /// Whether the structure holds the sorted nodes; gives the slots their ranks as far as it does.
    fn fit(&mut self, row: u32, masks: &[u64]) -> Option<Change> {
        if row != self.row || self.sorted.len() > self.ids.len() {
            return None;
        }
        let (mut rank, mut same) = (0, self.sorted.len() == self.ids.len());
        self.unused.clear();
        for &(id, slot) in &self.sorted {
            while *self.ids.get(rank)? < id {
                self.unused.push(rank as u32);
                rank += 1;
            }
            let mask = masks[slot as usize];
            if self.ids[rank] != id || mask & ALL & !(self.asked[rank] | self.masks[rank]) != 0 {
                return None;
            }
            same &= mask == self.asked[rank];
            self.ranks[slot as usize] = rank as u32;
            rank += 1;
        }
        self.unused.extend(rank as u32..self.ids.len() as u32);
        Some(if same { Change::Same } else { Change::Subset })
    }

    fn rebuild(&mut self, row: u32, masks: &[u64]) {
        self.row = row;
        self.ids.clear();
        self.ids.extend(self.sorted.iter().map(|&(id, _)| id));
        self.asked.clear();
        self.asked.extend(self.sorted.iter().map(|&(_, slot)| masks[slot as usize]));
        self.unused.clear();
        for (rank, &(_, slot)) in (0..).zip(&self.sorted) {
            self.ranks[slot as usize] = rank;
        }
        self.couple();
        self.number();
        self.fingerprint = self.hash();
    }

    /// Masks of the structure: what was asked for, symmetric, without nodes that are not there.
    fn couple(&mut self) {
        self.masks.clear();
        self.masks.resize(self.ids.len(), 0);
        let mut window = Window::new(self.row);
        for j in 0..self.ids.len() {
            window.move_to(&self.ids, self.ids[j]);
            let wanted = self.asked[j] & window.present | 1 << SELF;
            self.masks[j] |= wanted;
            for bit in bits(wanted) {
                self.masks[window.rank(bit)] |= 1 << (2 * SELF - bit);
            }
        }
    }

    /// Column pointers and row indices from the masks.
    fn number(&mut self) {
        self.start.clear();
        self.col_ptr.clear();
        self.row_idx.clear();
        let mut window = Window::new(self.row);
        for j in 0..self.ids.len() {
            window.move_to(&self.ids, self.ids[j]);
            self.start.push(self.row_idx.len() as u32);
            for _component in 0..2 {
                self.col_ptr.push(self.row_idx.len() as u32);
                let rows = bits(self.masks[j]).map(|bit| 2 * window.rank(bit) as u32);
                self.row_idx.extend(rows.flat_map(|r| [r, r + 1]));
            }
        }
        self.col_ptr.push(self.row_idx.len() as u32);
    }

    /// FNV-1a over nodes and masks.
    fn hash(&self) -> u64 {
        let words = self.ids.iter().map(|&id| id as u64).chain(self.masks.iter().copied());
        words.chain([self.row as u64]).fold(0xcbf2_9ce4_8422_2325, |h, w| (h ^ w).wrapping_mul(0x0000_0100_0000_01b3))
    }

    /// Node number of a slot in the matrix.
    #[inline]
    pub fn rank(&self, slot: usize) -> usize {
        self.ranks[slot] as usize
    }

    /// Nodes in the matrix; at least as many as slots.
    pub fn nodes(&self) -> usize {
        self.ids.len()
    }

    /// Nodes of the matrix that have no slot in this step: the caller gives them a unit diagonal.
    pub fn unused(&self) -> impl Iterator<Item = usize> {
        self.unused.iter().map(|&rank| rank as usize)
    }

    /// Rows, and columns, of the matrix: two a node.
    pub fn dim(&self) -> usize {
        2 * self.nodes()
    }

    /// Stored values.
    pub fn len(&self) -> usize {
        self.row_idx.len()
    }

    /// Whether there is no node.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Index of the value in row `2 i` and column `2 j`, where node `i` is node `j` displaced by the
    /// offset of `bit`, one of the bits of `mask(j)`. Entry `(2 i + a, 2 j + b)` stands at that index
    /// `+ a + b * stride(j)`.
    #[inline]
    pub fn block(&self, j: usize, bit: u32) -> usize {
        let before = self.masks[j] & ((1 << bit) - 1);
        self.start[j] as usize + 2 * before.count_ones() as usize
    }

    /// Values in a column of node `j`, i.e. from its first column to its second.
    #[inline]
    pub fn stride(&self, j: usize) -> usize {
        2 * self.masks[j].count_ones() as usize
    }

    /// Nodes that node `j` couples with, itself among them.
    #[inline]
    pub fn mask(&self, j: usize) -> u64 {
        self.masks[j]
    }

    /// Ranks of the nodes that node `j` couples with, ascending as the bits of its mask.
    pub fn neighbours(&self, j: usize) -> impl Iterator<Item = usize> {
        let from = self.start[j] as usize;
        self.row_idx[from..from + self.stride(j)].iter().step_by(2).map(|&r| r as usize / 2)
    }

    /// First value of each column, and the number of values.
    pub fn col_ptr(&self) -> &[u32] {
        if self.is_empty() { &[0] } else { &self.col_ptr }
    }

    /// Rows of the values, ascending in each column.
    pub fn row_idx(&self) -> &[u32] {
        &self.row_idx
    }

    /// Grid column and grid row of a node.
    pub fn place(&self, rank: usize) -> [u32; 2] {
        let row = self.row.max(1);
        [self.ids[rank] % row, self.ids[rank] / row]
    }

    /// A number that two different structures share only by accident (1 in 2^64).
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let words = [&self.ids, &self.start, &self.col_ptr, &self.row_idx, &self.ranks, &self.unused];
        let wide = self.asked.capacity() + self.masks.capacity() + self.sorted.capacity();
        4 * words.map(Vec::capacity).iter().sum::<usize>() + 8 * wide
    }

    /// `y = A x`, with the values of A in the order of the structure.
    pub fn multiply(&self, values: &[f64], x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for j in 0..self.nodes() {
            let (from, stride) = (self.start[j] as usize, self.stride(j));
            let (first, second) = values[from..from + 2 * stride].split_at(stride);
            let (x0, x1) = (x[2 * j], x[2 * j + 1]);
            for ((&r, a), b) in self.row_idx[from..from + stride].iter().zip(first).zip(second) {
                y[r as usize] += a * x0 + b * x1;
            }
        }
    }

    /// `out = A^T`, in the order of the structure.
    pub fn transposed(&self, values: &[f64], out: &mut [f64]) {
        self.mirror(|here, there| out[here] = values[there]);
    }

    /// `out = (A + A^T) / 2`, in the order of the structure.
    pub fn symmetric_part(&self, values: &[f64], out: &mut [f64]) {
        self.mirror(|here, there| out[here] = 0.5 * (values[here] + values[there]));
    }

    /// Calls `f` with the index of every value and that of the value across the diagonal.
    #[inline]
    fn mirror(&self, mut f: impl FnMut(usize, usize)) {
        for j in 0..self.nodes() {
            let stride = self.stride(j);
            for (bit, i) in bits(self.masks[j]).zip(self.neighbours(j)) {
                let here = self.block(j, bit);
                let (there, across) = (self.block(i, 2 * SELF - bit), self.stride(i));
                for (a, b) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    f(here + a + b * stride, there + b + a * across);
                }
            }
        }
    }
}

/// The set bits of a mask, ascending.
fn bits(mut mask: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let bit = (mask != 0).then(|| mask.trailing_zeros())?;
        mask &= mask - 1;
        Some(bit)
    })
}

/// The neighbourhood of a node that walks through the sorted nodes: one cursor a grid line.
struct Window {
    row: u32,
    /// Rank of the first node at or behind the left end of each line.
    first: [usize; WIDTH as usize],
    /// Neighbours that exist.
    present: u64,
}

impl Window {
    fn new(row: u32) -> Self {
        Window { row: row.max(1), first: [0; WIDTH as usize], present: 0 }
    }

    /// Goes on to the node with grid number `id`, which is behind the one before.
    fn move_to(&mut self, ids: &[u32], id: u32) {
        let (x, y, row) = ((id % self.row) as i64, (id / self.row) as i64, self.row as i64);
        let reach = REACH as i64;
        self.present = 0;
        for (line, first) in (0..).zip(self.first.iter_mut()) {
            let begin = (y + line - reach) * row;
            let (left, right) = (begin + (x - reach).max(0), begin + (x + reach).min(row - 1));
            while ids.get(*first).is_some_and(|&i| (i as i64) < left) {
                *first += 1;
            }
            for &i in ids[*first..].iter().take_while(|&&i| i as i64 <= right) {
                self.present |= 1 << (line * WIDTH as i64 + i as i64 - begin - x + reach);
            }
        }
    }

    /// Rank of the neighbour with that bit, which is present.
    fn rank(&self, bit: u32) -> usize {
        let line = bit / WIDTH;
        let left_of_it = self.present >> (line * WIDTH) & LINE & ((1 << (bit % WIDTH)) - 1);
        self.first[line as usize] + left_of_it.count_ones() as usize
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use nalgebra::DMatrix;
    use nalgebra_sparse::CscMatrix;
    use proptest::prelude::*;

    use super::*;

    /// Entries by definition: for every pair of nodes, whether one names the other.
    fn naive(row: u32, ids: &[u32], masks: &[u64]) -> BTreeSet<(u32, u32)> {
        let names = |a: usize, b: usize| {
            let d = |f: fn(u32, u32) -> u32| f(ids[b], row) as i32 - f(ids[a], row) as i32;
            let (dx, dy) = (d(|i, r| i % r), d(|i, r| i / r));
            dx.abs() <= 3 && dy.abs() <= 3 && masks[a] >> offset_bit(dx, dy) & 1 == 1
        };
        let mut sorted = ids.to_vec();
        sorted.sort_unstable();
        let rank = |id: u32| sorted.binary_search(&id).unwrap() as u32;
        let pairs = (0..ids.len()).flat_map(|a| (0..ids.len()).map(move |b| (a, b)));
        let coupled = pairs.filter(|&(a, b)| a == b || names(a, b) || names(b, a));
        coupled.flat_map(|(a, b)| (0..4).map(move |k| (2 * rank(ids[a]) + k / 2, 2 * rank(ids[b]) + k % 2))).collect()
    }

    fn entries(p: &Pattern) -> BTreeSet<(u32, u32)> {
        let column = |c: usize| p.row_idx()[p.col_ptr()[c] as usize..p.col_ptr()[c + 1] as usize].iter();
        (0..p.dim()).flat_map(|c| column(c).map(move |&r| (r, c as u32))).collect()
    }

    /// Nodes in an order of their own, with masks.
    fn steps() -> impl Strategy<Value = (u32, Vec<u32>, Vec<u64>)> {
        (1u32..12, 1u32..9).prop_flat_map(|(row, lines)| {
            let all: Vec<u32> = (0..row * lines).collect();
            let some = proptest::sample::subsequence(all, 0..=(row * lines) as usize).prop_shuffle();
            (Just(row), some).prop_flat_map(|(row, ids)| {
                let n = ids.len();
                (Just(row), Just(ids), proptest::collection::vec(0..=ALL, n))
            })
        })
    }

    proptest! {
        #[test]
        fn the_structure_is_what_the_masks_say((row, ids, masks) in steps()) {
            let mut p = Pattern::default();
            prop_assert_eq!(p.adopt(row, &ids, &masks, false), if ids.is_empty() && row == 0 { Change::Same } else { Change::Rebuilt });
            prop_assert_eq!(entries(&p), naive(row, &ids, &masks));
            prop_assert_eq!(p.len(), p.col_ptr()[p.dim()] as usize);
            prop_assert!(p.unused().next().is_none());
            for (slot, &id) in ids.iter().enumerate() {
                let [x, y] = p.place(p.rank(slot));
                prop_assert_eq!(x + y * row, id);
            }
            prop_assert_eq!(p.adopt(row, &ids, &masks, false), Change::Same);
        }

        #[test]
        fn every_block_is_found((row, ids, masks) in steps()) {
            let mut p = Pattern::default();
            p.adopt(row, &ids, &masks, false);
            for j in 0..p.nodes() {
                for (bit, i) in bits(p.mask(j)).zip(p.neighbours(j)) {
                    for (a, b) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                        let k = p.block(j, bit) + a + b * p.stride(j);
                        prop_assert_eq!(p.row_idx()[k] as usize, 2 * i + a);
                        prop_assert!((p.col_ptr()[2 * j + b]..p.col_ptr()[2 * j + b + 1]).contains(&(k as u32)));
                    }
                }
            }
        }

        #[test]
        fn a_part_of_the_step_fits_into_the_structure((row, ids, masks) in steps(), keep in 0.0..1.0) {
            let mut p = Pattern::default();
            p.adopt(row, &ids, &masks, false);
            let (before, len) = (p.fingerprint(), (keep * ids.len() as f64) as usize);
            let fewer: Vec<u64> = masks.iter().map(|m| m & 0x5555_5555_5555_5555).collect();
            let change = p.adopt(row, &ids[..len], &fewer[..len], true);
            prop_assert!(change != Change::Rebuilt);
            prop_assert_eq!(p.fingerprint(), before);
            prop_assert_eq!(p.unused().count(), ids.len() - len);
            let used: BTreeSet<usize> = (0..len).map(|slot| p.rank(slot)).collect();
            prop_assert!(p.unused().all(|rank| !used.contains(&rank)));
            if change == Change::Subset {
                prop_assert_eq!(p.adopt(row, &ids[..len], &fewer[..len], false), Change::Rebuilt);
                prop_assert_eq!(p.nodes(), len);
            }
        }
    }

    fn chain(n: u32) -> Pattern {
        let mut p = Pattern::default();
        let ids: Vec<u32> = (0..n).collect();
        p.adopt(n, &ids, &vec![1 << offset_bit(1, 0); n as usize], false);
        p
    }

    #[test]
    fn products_and_symmetric_parts_are_those_of_the_dense_matrix() {
        let p = chain(7);
        let values: Vec<f64> = (0..p.len()).map(|k| (1.0 + k as f64).sin()).collect();
        let [ptr, rows] = [p.col_ptr(), p.row_idx()].map(|s| s.iter().map(|&i| i as usize).collect::<Vec<_>>());
        let sparse = CscMatrix::try_from_csc_data(p.dim(), p.dim(), ptr, rows, values.clone()).unwrap();
        let dense = DMatrix::from(&sparse);
        let x: Vec<f64> = (0..p.dim()).map(|k| (k as f64).cos()).collect();
        let mut y = vec![f64::NAN; p.dim()];
        p.multiply(&values, &x, &mut y);
        let wanted = &dense * DMatrix::from_column_slice(p.dim(), 1, &x);
        assert!(y.iter().zip(wanted.iter()).all(|(a, b)| (a - b).abs() < 1e-14));

        let mut half = vec![f64::NAN; p.len()];
        p.symmetric_part(&values, &mut half);
        let wanted = (&dense + dense.transpose()) * 0.5;
        for (row, column, value) in sparse.triplet_iter().zip(&half).map(|((r, c, _), v)| (r, c, v)) {
            assert_eq!(*value, wanted[(row, column)]);
        }
        p.transposed(&values, &mut half);
        for (row, column, value) in sparse.triplet_iter().zip(&half).map(|((r, c, _), v)| (r, c, v)) {
            assert_eq!(*value, dense[(column, row)]);
        }
    }

    #[test]
    fn a_step_that_needs_more_is_a_new_structure() {
        let mut p = chain(5);
        let wide = vec![1 << offset_bit(2, 0); 5];
        assert_eq!(p.adopt(5, &[0, 1, 2, 3, 4], &wide, true), Change::Rebuilt);
        assert_eq!(p.mask(0).count_ones(), 2);
        assert_eq!(p.adopt(6, &[0, 1, 2, 3, 4], &wide, true), Change::Rebuilt, "another grid");
    }

    #[test]
    fn a_grid_line_ends_where_it_ends() {
        // nodes 2 and 3 follow each other, at the end of one line and the start of the next
        let mut p = Pattern::default();
        p.adopt(3, &[2, 3], &[ALL; 2], false);
        assert_eq!(p.mask(0).count_ones(), 2, "(2, 0) and (0, 1) are 2 columns and 1 line apart");
        p.adopt(5, &[4, 5], &[ALL; 2], false);
        assert_eq!(p.mask(0).count_ones(), 1, "(4, 0) and (0, 1) are 4 columns apart");
    }
}
