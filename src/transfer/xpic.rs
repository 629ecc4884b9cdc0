//! XPIC(m) (Hammerquist & Nairn 2017): FLIP without the part that the nodes do not see.
//!
//! With S the map from nodes to points and S+ that from points to nodes, FLIP keeps V = S v + (I - S S+) V.
//! XPIC takes that second part down to (I - S S+)^m V:
//! ```text
//! V' = (I - (I - S S+)^m) V + S a dt
//! ```
//! m = 1 is PIC, m -> infinity FLIP. It is a map from nodes: with v = S+ V and V' = S v',
//! ```text
//! v' = sum_(r=1..m) (-1)^(r+1) (m over r) (S+ S)^(r-1) v + a dt = v_new + sum_(r=1..m-1) (I - S+ S)^r v
//! ```
//! the sum of a geometric series both times, of which the second form has no large terms. Each further r
//! is one map to the points and back: m - 1 pairs a step. S+ S keeps the momentum, so the sum has none.

use std::marker::PhantomData;

use super::Rule;
use crate::{
    assembly::{Scratch, collect, deposit, place, response::Kept, spread},
    body::{Body, chunks, load},
    math::simd::{FpPath, Kernel},
    nodes::Nodes,
    space::{Shape, Stencil, stencil::LANES},
};

/// v_p = sum N_i v'_i, with v' of the [`Filter`].
#[derive(Clone, Copy)]
pub struct Xpic<'a> {
    pub filtered: &'a [Vec<f64>; 2],
}

impl Rule for Xpic<'_> {
    const AFFINE: bool = false;

    fn second<'a>(&'a self, _: &'a Nodes) -> &'a [Vec<f64>; 2] {
        self.filtered
    }

    #[inline(always)]
    fn velocity(&self, _: f64, _: f64, filtered: f64) -> f64 {
        filtered
    }
}

/// v' on the nodes, with what it takes to find it; nothing is held before the first use.
#[derive(Default)]
pub struct Filter {
    /// v' (m/s).
    pub filtered: [Vec<f64>; 2],
    /// (I - S+ S)^r v (m/s).
    rest: [Vec<f64>; 2],
    /// Momentum of S (I - S+ S)^r v on the nodes (kN s/m).
    momentum: [Vec<f64>; 2],
}

impl Filter {
    /// Finds v' of order `order`. The stencils are the kept ones where there are, else those of the
    /// committed places.
    pub fn run<S: Shape<N>, const N: usize>(
        &mut self,
        order: u32,
        path: FpPath,
        scratch: &mut Scratch<N>,
        (body, nodes): (&Body, &Nodes),
        kept: Option<&Kept<N>>,
    ) {
        self.begin(nodes);
        for _ in 1..order {
            let n = nodes.count;
            self.momentum.iter_mut().for_each(|p| p[..n].fill(0.0));
            let Filter { rest, momentum, .. } = self;
            let shape = PhantomData::<S>;
            path.run(ThereAndBack { scratch: &mut *scratch, body, nodes, kept, rest, momentum, shape });
            self.add(nodes);
        }
    }

    /// v' = v_new, r = v.
    fn begin(&mut self, nodes: &Nodes) {
        let n = nodes.count;
        for columns in [&mut self.filtered, &mut self.rest, &mut self.momentum] {
            // grows where the columns of the nodes have grown
            columns.iter_mut().filter(|c| c.len() < n).for_each(|c| c.resize(nodes.id.len(), 0.0));
        }
        for axis in 0..2 {
            self.filtered[axis][..n].copy_from_slice(&nodes.velocity[axis][..n]);
            self.rest[axis][..n].copy_from_slice(&nodes.old_velocity[axis][..n]);
        }
    }

    /// r <- r - p / m, v' += r.
    fn add(&mut self, nodes: &Nodes) {
        for axis in 0..2 {
            let columns = self.filtered[axis].iter_mut().zip(&mut self.rest[axis]).zip(&self.momentum[axis]);
            for (((filtered, rest), p), m) in columns.zip(&nodes.mass[..nodes.count]) {
                *rest -= if *m > 0.0 { p / m } else { *rest };
                *filtered += *rest;
            }
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        [&self.filtered, &self.rest, &self.momentum].iter().flat_map(|c| c.iter()).map(|c| 8 * c.capacity()).sum()
    }
}

/// p_i = sum N_i m_p sum N_j r_j.
struct ThereAndBack<'a, S, const N: usize> {
    scratch: &'a mut Scratch<N>,
    body: &'a Body,
    nodes: &'a Nodes,
    kept: Option<&'a Kept<N>>,
    rest: &'a [Vec<f64>; 2],
    momentum: &'a mut [Vec<f64>; 2],
    shape: PhantomData<S>,
}

impl<S: Shape<N>, const N: usize> Kernel for ThereAndBack<'_, S, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let ThereAndBack { scratch: s, body, nodes, kept, rest, momentum, shape: PhantomData } = self;
        let ranges = body.groups.iter().flat_map(|g| chunks(g.range.clone()));
        for (block, range) in ranges.enumerate() {
            if kept.is_none() {
                place::<S, N>(s, body, nodes, &range);
            }
            load(&mut s.mass.0, &body.mass, &range);
            spread(s.runs.of(block), &mut s.nodal, [&rest[0], &rest[1]]);
            let Scratch { stencil, nodal, shares, mass, .. } = &mut *s;
            let stencil: &Stencil<N> = kept.map_or(stencil, |k| &k.stencils[block]);
            for axis in 0..2 {
                let (from, to) = (&nodal[axis], &mut shares[axis]);
                for i in 0..LANES {
                    let mut v = 0.0;
                    for k in 0..N {
                        v += stencil.weight(k, i) * from.0[k][i];
                    }
                    for k in 0..N {
                        to.0[k][i] = stencil.weight(k, i) * (mass.0[i] * v);
                    }
                }
            }
            for run in s.runs.of(block) {
                let slots = run.slots.map(|s| s as usize);
                let [x, y] = &mut *momentum;
                deposit([x, y], &slots, collect(&s.shares[..2], run));
            }
        }
    }
}
