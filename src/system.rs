//! The equations of an implicit step: increments of the active nodes, what is out of balance,
//! the tangent, and which unknowns a support or a contact holds.

use crate::{
    fault::Fault,
    math::{
        linear::{Solution, Solver},
        sparse::{Change, Pattern, offset_bit},
    },
    work::Work,
};

/// Row and normal of a node that slides along a side: r_t + factor r_n = 0 in place of r_t = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slip {
    slot: u32,
    tangent: u8,
    normal: u8,
    factor: f64,
}

/// Unknown increments, residual and tangent of one step. Columns are by axis and slot.
#[derive(Default)]
pub struct System {
    /// Displacement since the start of the step (m).
    pub du: [Vec<f64>; 2],
    /// Internal minus external force plus inertia (kN/m): what holds must supply.
    pub residual: [Vec<f64>; 2],
    /// What to add to `residual` where an unknown comes to its velocity within the step, whatever
    /// the integrator, and its derivative (of both axes); empty without inertia.
    pub impact: [Vec<f64>; 2],
    pub impact_slope: Vec<f64>,
    /// d residual / d du, in the order of `pattern`.
    pub values: Vec<f64>,
    pub pattern: Pattern,
    masks: Vec<u64>,
    slots: usize,
    held: [Vec<bool>; 2],
    target: [Vec<f64>; 2],
    /// Unknowns that come to the velocity du / dt within the step; what is held is one of them.
    inelastic: [Vec<bool>; 2],
    slips: Vec<Slip>,
    rhs: Vec<f64>,
    delta: Vec<f64>,
    /// Whether the tangent is symmetric so far.
    pub symmetric: bool,
}

/// Sums over the equations as they stand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Norms {
    /// |r| over the free unknowns (kN/m).
    pub residual: f64,
    /// |R| over the held unknowns (kN/m).
    pub reaction: f64,
}

impl System {
    /// Starts a step over `slots` nodes: no increment, no coupling.
    pub fn begin(&mut self, slots: usize) {
        self.slots = slots;
        let System { du, residual, target, held, inelastic, masks, .. } = self;
        for axis in 0..2 {
            refill(&mut du[axis], slots, 0.0);
            refill(&mut residual[axis], slots, 0.0);
            refill(&mut target[axis], slots, 0.0);
            refill(&mut held[axis], slots, false);
            refill(&mut inelastic[axis], slots, false);
        }
        refill(masks, slots, 0);
    }

    /// Notes that node `slot` is coupled with the nodes of `mask`.
    #[inline(always)]
    pub fn couple(&mut self, slot: usize, mask: u64) {
        self.masks[slot] |= mask;
    }

    /// Makes the structure fit the couplings; `ids` are grid numbers by slot, `row` the nodes of a
    /// grid row.
    pub fn adopt(&mut self, row: u32, ids: &[u32], keep_superset: bool) -> Change {
        let change = self.pattern.adopt(row, ids, &self.masks, keep_superset);
        refill(&mut self.values, self.pattern.len(), 0.0);
        refill(&mut self.rhs, self.pattern.dim(), 0.0);
        refill(&mut self.delta, self.pattern.dim(), 0.0);
        change
    }

    /// Starts an evaluation at the present increment.
    pub fn clear(&mut self, tangent: bool) {
        self.residual.iter_mut().for_each(|r| r.fill(0.0));
        if tangent {
            self.values.fill(0.0);
        }
        self.symmetric = true;
    }

    /// Index of diagonal entry (`slot`, `axis`).
    fn diagonal(&self, slot: usize, axis: usize) -> usize {
        let j = self.pattern.rank(slot);
        self.pattern.block(j, offset_bit(0, 0)) + axis * (self.pattern.stride(j) + 1)
    }

    /// Index of the first entry of block (`row`, `column`) by slots, which must be coupled, and the
    /// stride to its second column.
    pub fn block(&self, row: usize, column: usize) -> (usize, usize) {
        let (i, j) = (self.pattern.rank(row), self.pattern.rank(column));
        let ([xi, yi], [xj, yj]) = (self.pattern.place(i), self.pattern.place(j));
        let bit = offset_bit(xi as i32 - xj as i32, yi as i32 - yj as i32);
        (self.pattern.block(j, bit), self.pattern.stride(j))
    }

    /// Adds to a diagonal entry.
    pub fn add_diagonal(&mut self, slot: usize, axis: usize, value: f64) {
        let k = self.diagonal(slot, axis);
        self.values[k] += value;
    }

    /// Forgets holds and slips.
    pub fn release(&mut self) {
        self.held.iter_mut().chain(&mut self.inelastic).for_each(|h| h.fill(false));
        self.slips.clear();
    }

    /// Holds an unknown at an increment (m). False if it is held already.
    pub fn hold(&mut self, slot: usize, axis: usize, increment: f64) -> bool {
        let free = !self.held[axis][slot];
        if free {
            self.held[axis][slot] = true;
            self.inelastic[axis][slot] = true;
            self.target[axis][slot] = increment;
        }
        free
    }

    /// Whether an unknown is held.
    pub fn is_held(&self, slot: usize, axis: usize) -> bool {
        self.held[axis][slot]
    }

    /// Lets an unknown come to the velocity du / dt within the step. A contact needs that: its
    /// states must agree on what motion is.
    pub fn damp_impact(&mut self, slot: usize, axis: usize) {
        self.inelastic[axis][slot] = true;
    }

    /// Whether an unknown comes to the velocity du / dt within the step.
    pub fn is_inelastic(&self, slot: usize, axis: usize) -> bool {
        self.inelastic[axis][slot]
    }

    /// Lets a node slide along axis `tangent`: its row becomes r_t + factor r_n, with r_n what
    /// axis `normal` is held with.
    pub fn slide(&mut self, slot: usize, tangent: usize, normal: usize, factor: f64) {
        if factor != 0.0 {
            self.slips.push(Slip { slot: slot as u32, tangent: tangent as u8, normal: normal as u8, factor });
        }
    }

    /// Force (kN/m) that holds an unknown: its residual, motion stopped within the step.
    pub fn reaction(&self, slot: usize, axis: usize) -> f64 {
        let impact = self.impact[axis].get(slot).copied().unwrap_or(0.0);
        self.residual[axis][slot] + impact
    }

    /// Residual of a free unknown.
    fn free_residual(&self, slot: usize, axis: usize) -> f64 {
        if self.inelastic[axis][slot] { self.reaction(slot, axis) } else { self.residual[axis][slot] }
    }

    /// Right-hand side -r with the rows of sliding nodes, and its norms.
    pub fn norms(&mut self) -> Norms {
        self.rhs.fill(0.0);
        let (mut free, mut held) = (0.0, 0.0);
        for axis in 0..2 {
            for slot in 0..self.slots {
                let k = 2 * self.pattern.rank(slot) + axis;
                self.rhs[k] = -self.free_residual(slot, axis);
            }
        }
        for s in &self.slips {
            let (slot, t) = (s.slot as usize, s.tangent as usize);
            self.rhs[2 * self.pattern.rank(slot) + t] -= s.factor * self.reaction(slot, s.normal as usize);
        }
        for axis in 0..2 {
            for slot in 0..self.slots {
                if self.held[axis][slot] {
                    held += self.reaction(slot, axis).powi(2);
                } else {
                    free += self.rhs[2 * self.pattern.rank(slot) + axis].powi(2);
                }
            }
        }
        Norms { residual: free.sqrt(), reaction: held.sqrt() }
    }

    /// The largest gap between a held unknown and where it is held (m).
    pub fn gap(&self) -> f64 {
        let mut gap: f64 = 0.0;
        for axis in 0..2 {
            for slot in (0..self.slots).filter(|&s| self.held[axis][s]) {
                gap = gap.max((self.target[axis][slot] - self.du[axis][slot]).abs());
            }
        }
        gap
    }

    /// Correction of the increment: K delta = -r, with sliding rows combined and held unknowns
    /// taken to their targets. Call [`System::norms`] first.
    pub fn solve(&mut self, solver: &mut Solver, work: &mut Work) -> Result<Solution, Fault> {
        self.finish_rows();
        self.symmetric &= self.slips.is_empty();
        for axis in 0..2 {
            for slot in 0..self.slots {
                if self.held[axis][slot] {
                    self.eliminate(slot, axis);
                }
            }
        }
        self.fill_empty_rows();
        let System { pattern, values, symmetric, rhs, delta, .. } = self;
        solver.solve(pattern, values, *symmetric, rhs, delta, work)
    }

    /// Stops of held and touching unknowns, and the rows of sliding nodes.
    fn finish_rows(&mut self) {
        for axis in 0..2 {
            for slot in 0..self.slots.min(self.impact_slope.len()) {
                if self.inelastic[axis][slot] {
                    self.add_diagonal(slot, axis, self.impact_slope[slot]);
                }
            }
        }
        for k in 0..self.slips.len() {
            self.combine_rows(self.slips[k]);
        }
    }

    /// Row t += factor x row n, within the blocks of one node.
    fn combine_rows(&mut self, s: Slip) {
        let System { pattern, values, .. } = self;
        let i = pattern.rank(s.slot as usize);
        for (j, bit) in neighbours(pattern, i) {
            let at = pattern.block(j, mirror(bit));
            for b in 0..2 {
                let column = at + b * pattern.stride(j);
                values[column + s.tangent as usize] += s.factor * values[column + s.normal as usize];
            }
        }
    }

    /// Takes an unknown out: its column goes to the right-hand side, its row becomes
    /// d x = d (target - du), with the scale d of its diagonal.
    fn eliminate(&mut self, slot: usize, axis: usize) {
        let j = self.pattern.rank(slot);
        let own = self.diagonal(slot, axis);
        let scale = if self.values[own] > 0.0 { self.values[own] } else { 1.0 };
        let increment = self.target[axis][slot] - self.du[axis][slot];
        let System { pattern, values, rhs, .. } = self;
        for (i, bit) in neighbours(pattern, j) {
            let column = pattern.block(j, bit) + axis * pattern.stride(j);
            let row = pattern.block(i, mirror(bit)) + axis;
            for b in 0..2 {
                rhs[2 * i + b] -= values[column + b] * increment;
                values[column + b] = 0.0;
                values[row + b * pattern.stride(i)] = 0.0;
            }
        }
        values[own] = scale;
        rhs[2 * j + axis] = scale * increment;
    }

    /// A unit diagonal where there is no soil: nodes of the structure that are not active, and
    /// nodes of a patch that no point gives weight to.
    fn fill_empty_rows(&mut self) {
        for k in 0..self.pattern.nodes() {
            let at = self.pattern.block(k, offset_bit(0, 0));
            for axis in 0..2 {
                let own = at + axis * (self.pattern.stride(k) + 1);
                if self.values[own] == 0.0 {
                    self.values[own] = 1.0;
                    self.rhs[2 * k + axis] = 0.0;
                }
            }
        }
    }

    /// Adds `share` of the last correction to the increment.
    pub fn advance(&mut self, share: f64) {
        for axis in 0..2 {
            for slot in 0..self.slots {
                let to = self.du[axis][slot] + share * self.delta[2 * self.pattern.rank(slot) + axis];
                // the whole way goes to the target, without rounding
                let whole = share == 1.0 && self.held[axis][slot];
                self.du[axis][slot] = if whole { self.target[axis][slot] } else { to };
            }
        }
    }

    /// Energy norm |delta . r| of the last correction (kJ/m).
    pub fn energy(&self) -> f64 {
        self.delta.iter().zip(&self.rhs).map(|(d, r)| d * r).sum::<f64>().abs()
    }

    /// Right-hand side, not a number in held rows, and the dense tangent.
    #[cfg(test)]
    pub(crate) fn free_equations(&mut self) -> (Vec<f64>, Vec<Vec<f64>>) {
        self.norms();
        self.finish_rows();
        for axis in 0..2 {
            for slot in (0..self.slots).filter(|&s| self.held[axis][s]) {
                self.rhs[2 * self.pattern.rank(slot) + axis] = f64::NAN;
            }
        }
        let n = self.pattern.dim();
        let mut dense = vec![vec![0.0; n]; n];
        for (column, ends) in self.pattern.col_ptr().windows(2).enumerate() {
            for k in ends[0] as usize..ends[1] as usize {
                dense[self.pattern.row_idx()[k] as usize][column] += self.values[k];
            }
        }
        (self.rhs.clone(), dense)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        8 * (self.values.capacity() + 2 * self.rhs.capacity() + 8 * self.masks.capacity()) + 4 * self.pattern.len()
    }
}

/// The nodes that node `j` of the matrix is coupled with, itself among them, each with the bit of
/// its place as seen from `j`.
fn neighbours(pattern: &Pattern, j: usize) -> impl Iterator<Item = (usize, u32)> {
    let mut mask = pattern.mask(j);
    pattern.neighbours(j).map(move |i| {
        let bit = mask.trailing_zeros();
        mask &= mask.wrapping_sub(1);
        (i, bit)
    })
}

/// The same coupling seen from the other node.
fn mirror(bit: u32) -> u32 {
    2 * offset_bit(0, 0) - bit
}

fn refill<T: Copy>(column: &mut Vec<T>, n: usize, value: T) {
    column.clear();
    column.resize(n, value);
}
