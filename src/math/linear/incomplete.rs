//! Incomplete factor L L^T without fill, by nodes: blocks of two by two where the matrix has them (Meijerink & van der
//! Vorst 1977), with the nodes in the order of the grid.

use crate::math::sparse::Pattern;

/// By columns: [a_00, a_10, a_01, a_11].
type Block = [f64; 4];

/// The factor, by rows of nodes; kept between factorisations.
#[derive(Default)]
pub(super) struct Incomplete {
    structure: Option<u64>,
    /// First block of each row, and the nodes of its blocks, all before the node of the row.
    start: Vec<u32>,
    nodes: Vec<u32>,
    /// Where the blocks stand among the values of the matrix, and the values between their columns.
    from: Vec<[u32; 2]>,
    blocks: Vec<Block>,
    /// Inverses of the blocks on the diagonal: lower triangular.
    inverses: Vec<[f64; 3]>,
}

impl Incomplete {
    pub fn forget(&mut self) {
        self.structure = None;
    }

    /// Blocks left of the diagonal.
    fn prepare(&mut self, pattern: &Pattern) {
        if self.structure == Some(pattern.fingerprint()) {
            return;
        }
        self.structure = Some(pattern.fingerprint());
        self.start.clear();
        self.nodes.clear();
        self.from.clear();
        for i in 0..pattern.nodes() {
            self.start.push(self.nodes.len() as u32);
            // the structure is symmetric: the row is read from the column of the same node
            let before = pattern.neighbours(i).enumerate().filter(|&(_, j)| j < i);
            for (at, j) in before {
                self.nodes.push(j as u32);
                self.from.push([pattern.col_ptr()[2 * i] + 2 * at as u32, pattern.stride(i) as u32]);
            }
        }
        self.start.push(self.nodes.len() as u32);
        self.blocks.resize(self.nodes.len(), [0.0; 4]);
        self.inverses.resize(pattern.nodes(), [0.0; 3]);
    }

    /// Factors a symmetric matrix; `None` where a pivot is not positive, which does not mean that the matrix is not.
    /// ```text
    /// L_ij = (A_ij - sum_k<j L_ik L_jk^T) L_jj^-T,   L_ii L_ii^T = A_ii - sum_k<i L_ik L_ik^T
    /// ```
    pub fn factor(&mut self, pattern: &Pattern, values: &[f64]) -> Option<()> {
        self.prepare(pattern);
        for i in 0..pattern.nodes() {
            let row = self.start[i] as usize..self.start[i + 1] as usize;
            let own = pattern.block(i, crate::math::sparse::offset_bit(0, 0));
            let mut pivot = [values[own], values[own + 1], values[own + pattern.stride(i) + 1]];
            for at in row.clone() {
                let j = self.nodes[at] as usize;
                let [from, stride] = self.from[at].map(|v| v as usize);
                // column i holds A_ji = A_ij^T
                let mut block = [values[from], values[from + stride], values[from + 1], values[from + stride + 1]];
                self.subtract_common(row.start..at, j, &mut block);
                let block = divided(&block, &self.inverses[j]);
                pivot[0] -= block[0] * block[0] + block[2] * block[2];
                pivot[1] -= block[1] * block[0] + block[3] * block[2];
                pivot[2] -= block[1] * block[1] + block[3] * block[3];
                self.blocks[at] = block;
            }
            self.inverses[i] = inverse(pivot)?;
        }
        Some(())
    }

    /// block -= sum L_ik L_jk^T over the nodes k that row j and these blocks of row i have in common.
    fn subtract_common(&self, row: std::ops::Range<usize>, j: usize, block: &mut Block) {
        let mut other = self.start[j] as usize;
        let end = self.start[j + 1] as usize;
        for at in row {
            while other < end && self.nodes[other] < self.nodes[at] {
                other += 1;
            }
            if other < end && self.nodes[other] == self.nodes[at] {
                let (a, b) = (&self.blocks[at], &self.blocks[other]);
                block[0] -= a[0] * b[0] + a[2] * b[2];
                block[1] -= a[1] * b[0] + a[3] * b[2];
                block[2] -= a[0] * b[1] + a[2] * b[3];
                block[3] -= a[1] * b[1] + a[3] * b[3];
            }
        }
    }

    /// Overwrites `x` with (L L^T)^-1 x.
    pub fn solve(&self, x: &mut [f64]) {
        for i in 0..self.inverses.len() {
            let row = self.start[i] as usize..self.start[i + 1] as usize;
            let (known, own) = x.split_at_mut(2 * i);
            let mut r = [own[0], own[1]];
            for (b, &j) in self.blocks[row.clone()].iter().zip(&self.nodes[row]) {
                let y = &known[2 * j as usize..][..2];
                r[0] -= b[0] * y[0] + b[2] * y[1];
                r[1] -= b[1] * y[0] + b[3] * y[1];
            }
            let [a, b, c] = self.inverses[i];
            (own[0], own[1]) = (a * r[0], b * r[0] + c * r[1]);
        }
        for i in (0..self.inverses.len()).rev() {
            let row = self.start[i] as usize..self.start[i + 1] as usize;
            let (rest, own) = x.split_at_mut(2 * i);
            let [a, b, c] = self.inverses[i];
            let y = [a * own[0] + b * own[1], c * own[1]];
            (own[0], own[1]) = (y[0], y[1]);
            for (b, &j) in self.blocks[row.clone()].iter().zip(&self.nodes[row]) {
                rest[2 * j as usize] -= b[0] * y[0] + b[1] * y[1];
                rest[2 * j as usize + 1] -= b[2] * y[0] + b[3] * y[1];
            }
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let words = self.start.capacity() + self.nodes.capacity() + 2 * self.from.capacity();
        4 * words + 8 * (4 * self.blocks.capacity() + 3 * self.inverses.capacity())
    }
}

/// B L^-T, with the inverse of L: [l_00, l_10, l_11].
fn divided(b: &Block, l: &[f64; 3]) -> Block {
    [b[0] * l[0], b[1] * l[0], b[0] * l[1] + b[2] * l[2], b[1] * l[1] + b[3] * l[2]]
}

/// Inverse of the factor of a symmetric block [a_00, a_10, a_11]; `None` if it is not positive definite.
fn inverse([a, b, c]: [f64; 3]) -> Option<[f64; 3]> {
    let l00 = a.sqrt();
    let l10 = b / l00;
    let l11 = (c - l10 * l10).sqrt();
    let inverse = [1.0 / l00, -l10 / (l00 * l11), 1.0 / l11];
    let positive = a > 0.0 && c - l10 * l10 > 0.0 && inverse.iter().all(|v| v.is_finite());
    positive.then_some(inverse)
}
