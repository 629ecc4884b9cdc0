//! L L^T by fronts (multifrontal method, Duff & Reid 1983): a supernode's columns are one dense panel, and what their
//! elimination leaves to later unknowns is a dense matrix that is added to the parent's. The right side is one more row
//! of every front, so that forward elimination is done with the factor.

mod dense;
mod plan;
#[cfg(test)]
mod tests;
mod tree;

use plan::{Front, Plan, WIDTH};

use crate::math::{
    fused::{Arithmetic, Fused, FusedKernel},
    sparse::Pattern,
};

/// Symbolic and numeric factor; all of it is kept between factorisations.
#[derive(Default)]
pub(super) struct Fronts {
    plan: Option<Plan>,
    /// Whether `values` are a factor.
    made: bool,
    values: Vec<f64>,
    updates: Vec<f64>,
    /// Unknowns of a front, and of all.
    local: Vec<f64>,
    sorted: Vec<f64>,
}

impl Fronts {
    pub fn forget(&mut self) {
        self.plan = None;
        self.made = false;
    }

    pub fn is_prepared(&self) -> bool {
        self.plan.is_some()
    }

    /// Symbolic factorisation with the nodes eliminated in about this order, in a postorder of its tree.
    pub fn prepare(&mut self, pattern: &Pattern, order: &[u32]) {
        let plan = Plan::new(pattern, order);
        self.values.resize(plan.values, 0.0);
        self.updates.resize(plan.workspace, 0.0);
        self.local.resize(plan.longest, 0.0);
        self.sorted.resize(2 * plan.order.len(), 0.0);
        self.plan = Some(plan);
        self.made = false;
    }

    /// L L^T of a matrix, of which one triangle is read, and L^-1 b; `None` if it is not positive definite.
    pub fn factor(&mut self, values: &[f64], rhs: &[f64]) -> Option<()> {
        let Fronts { plan: Some(plan), values: panels, updates, .. } = self else { return None };
        self.made = Fused::best().run(Factor { plan, values, rhs, panels, updates });
        self.made.then_some(())
    }

    /// A^-1 b for the right side of the factorisation.
    pub fn finish(&mut self, x: &mut [f64]) -> Option<()> {
        let Fronts { plan: Some(plan), values: panels, local, sorted, .. } = self else { return None };
        if !self.made {
            return None;
        }
        for front in &plan.fronts {
            let panel = &panels[front.panel..][..front.panel_len()];
            for (k, column) in panel.chunks_exact(front.panel_column).take(front.own()).enumerate() {
                sorted[2 * front.first + k] = column[front.right()];
            }
        }
        Fused::best().run(Backward { plan, panels, local, sorted });
        scatter(plan, sorted, x);
        Some(())
    }

    /// Overwrites `x` with A^-1 x.
    pub fn solve(&mut self, x: &mut [f64]) -> Option<()> {
        let Fronts { plan: Some(plan), values: panels, local, sorted, .. } = self else { return None };
        if !self.made {
            return None;
        }
        for (place, &node) in plan.order.iter().enumerate() {
            sorted[2 * place..][..2].copy_from_slice(&x[2 * node as usize..][..2]);
        }
        Fused::best().run(Forward { plan, panels, local, sorted });
        Fused::best().run(Backward { plan, panels, local, sorted });
        scatter(plan, sorted, x);
        Some(())
    }

    /// Values in the factor.
    pub fn fill(&self) -> usize {
        self.plan.as_ref().map_or(0, |p| p.values)
    }

    /// Bytes of values, plan and workspace.
    pub fn bytes(&self) -> usize {
        let buffers = [&self.values, &self.updates, &self.local, &self.sorted].map(Vec::capacity);
        8 * buffers.iter().sum::<usize>() + self.plan.as_ref().map_or(0, Plan::bytes)
    }
}

/// Unknowns by place back to those by node.
fn scatter(plan: &Plan, sorted: &[f64], x: &mut [f64]) {
    for (place, &node) in plan.order.iter().enumerate() {
        x[2 * node as usize..][..2].copy_from_slice(&sorted[2 * place..][..2]);
    }
}

/// The factorisation; whether the matrix is positive definite.
struct Factor<'a> {
    plan: &'a Plan,
    values: &'a [f64],
    rhs: &'a [f64],
    panels: &'a mut [f64],
    updates: &'a mut [f64],
}

impl FusedKernel for Factor<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<A: Arithmetic, const R: usize>(self) -> bool {
        let Factor { plan, values, rhs, panels, updates } = self;
        for front in &plan.fronts {
            let panel = &mut panels[front.panel..][..front.panel_len()];
            enter(plan, front, values, rhs, panel);
            clear(front.update_column, &mut updates[front.update..][..front.update_len()]);
            for &c in &plan.children[front.children.clone()] {
                adopt(plan, front, &plan.fronts[c as usize], panel, updates);
            }
            if !dense::factor::<A, R>(panel, front.panel_column) {
                return false;
            }
            let sizes = [front.panel_column, front.padded, front.own()];
            let update = &mut updates[front.update..][..front.update_len()];
            dense::subtract::<A, R>(panel, sizes, update, front.update_column);
        }
        true
    }
}

/// The columns of the matrix and the right side; padding has a unit diagonal.
#[inline(always)]
fn enter(plan: &Plan, front: &Front, values: &[f64], rhs: &[f64], panel: &mut [f64]) {
    let column = front.panel_column;
    clear(column, panel);
    for e in &plan.entries[front.entries.clone()] {
        let (from, to, stride) = (e.from as usize, e.to as usize, e.stride as usize);
        panel[to] = values[from];
        panel[to + 1] = values[from + 1];
        panel[to + column] = values[from + stride];
        panel[to + column + 1] = values[from + stride + 1];
    }
    for (k, &node) in plan.order[front.first..][..front.nodes].iter().enumerate() {
        for a in 0..2 {
            panel[(2 * k + a) * column + front.right()] = rhs[2 * node as usize + a];
        }
    }
    for k in front.own()..front.padded {
        panel[k * column + k] = 1.0;
    }
}

/// Zeros in the lower triangle by blocks.
#[inline(always)]
fn clear(column: usize, values: &mut [f64]) {
    for (k, values) in values.chunks_exact_mut(column).enumerate() {
        values[k - k % WIDTH..].fill(0.0);
    }
}

/// Adds what a child leaves.
#[inline(always)]
fn adopt(plan: &Plan, front: &Front, child: &Front, panel: &mut [f64], updates: &mut [f64]) {
    let parts = [front.update..front.update + front.update_len(), child.update..child.update + child.update_len()];
    let (pieces, column) = (&plan.pieces[child.pieces.clone()], child.update_column);
    let Ok([update, from]) = updates.get_disjoint_mut(parts) else { return };
    for (k, piece) in pieces.iter().enumerate() {
        // the last row is the right side, which has no column
        let columns = piece.len as usize - usize::from(k + 1 == pieces.len());
        for c in 0..columns {
            let (source, target) = (piece.from as usize + c, piece.to as usize + c);
            let source = &from[source * column..][..column];
            let (target, shift) = if target < front.padded {
                (&mut panel[target * front.panel_column..][..front.panel_column], 0)
            } else {
                let start = (target - front.padded) * front.update_column;
                (&mut update[start..][..front.update_column], front.padded)
            };
            add(target, piece.to as usize + c - shift, &source[piece.from as usize + c..], piece.len as usize - c);
            for p in &pieces[k + 1..] {
                add(target, p.to as usize - shift, &source[p.from as usize..], p.len as usize);
            }
        }
    }
}

#[inline(always)]
fn add(target: &mut [f64], at: usize, source: &[f64], len: usize) {
    target[at..at + len].iter_mut().zip(&source[..len]).for_each(|(t, s)| *t += s);
}

/// Solves L^T x = y, from and to unknowns by place.
struct Backward<'a> {
    plan: &'a Plan,
    panels: &'a [f64],
    local: &'a mut [f64],
    sorted: &'a mut [f64],
}

impl FusedKernel for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arithmetic, const R: usize>(self) {
        let Backward { plan, panels, local, sorted } = self;
        for front in plan.fronts.iter().rev() {
            let x = &mut local[..front.panel_column];
            gather(plan, front, sorted, x);
            dense::backward::<A>(&panels[front.panel..][..front.panel_len()], front.panel_column, x);
            sorted[2 * front.first..][..front.own()].copy_from_slice(&x[..front.own()]);
        }
    }
}

/// The unknowns of a front in the order of its rows; 0 in the padding and for the right side.
#[inline(always)]
fn gather(plan: &Plan, front: &Front, sorted: &[f64], x: &mut [f64]) {
    x.fill(0.0);
    x[..front.own()].copy_from_slice(&sorted[2 * front.first..][..front.own()]);
    for (k, &row) in plan.rows[front.rows.clone()].iter().enumerate() {
        x[front.padded + 2 * k..][..2].copy_from_slice(&sorted[2 * row as usize..][..2]);
    }
}

/// Solves L y = b, from and to unknowns by place.
struct Forward<'a> {
    plan: &'a Plan,
    panels: &'a [f64],
    local: &'a mut [f64],
    sorted: &'a mut [f64],
}

impl FusedKernel for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arithmetic, const R: usize>(self) {
        let Forward { plan, panels, local, sorted } = self;
        for front in &plan.fronts {
            let x = &mut local[..front.panel_column];
            gather(plan, front, sorted, x);
            dense::forward::<A>(&panels[front.panel..][..front.panel_len()], front.panel_column, x);
            sorted[2 * front.first..][..front.own()].copy_from_slice(&x[..front.own()]);
            for (k, &row) in plan.rows[front.rows.clone()].iter().enumerate() {
                sorted[2 * row as usize..][..2].copy_from_slice(&x[front.padded + 2 * k..][..2]);
            }
        }
    }
}
