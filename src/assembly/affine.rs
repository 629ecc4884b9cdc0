//! Points that carry an affine velocity, v(x) = v_p + C_p (x - x_p) (Jiang, Schroeder, Selle, Teran &
//! Stomakhin 2015), to the nodes and back.
//!
//! ```text
//! (m v)_i += N_i m_p C_p (x_i - x_p),   C_p = B D^-1,
//! B = sum N_i v_i (x_i - x_p)^T,   D = sum N_i (x_i - x_p)(x_i - x_p)^T
//! ```
//! Shapes are products of functions of x and of y that reproduce linear fields, so D is diagonal, and each
//! column of C needs sums along one axis only. With W_a = sum N_i and P_a = sum N_i v_i over the nodes at
//! place a of the patch along it,
//! ```text
//! D = h^2 sum_(a<b) (b - a)^2 W_a W_b,   B = h sum_(a<b) (b - a) (W_a P_b - W_b P_a)
//! ```
//! which needs no x_p and loses no digits where a point comes close to a node and D to 0. With bilinear
//! functions it is sum v_i grad N_i.
//!
//! The points keep C, not B. Where D is the same everywhere, as with quadratic B-splines away from the
//! sides (h^2 / 4), that is the same, and the angular momentum
//! ```text
//! sum m (x cross v + C_yx D_xx - C_xy D_yy)
//! ```
//! is kept to rounding. Where D goes with the place of the point in its cell, as with bilinear functions,
//! to keep B would keep the angular momentum too, but C = B D^-1 has no bound: a point that comes near a
//! node would hand momentum to nodes that it gives no mass.

use std::ops::Range;

use super::{Patch, Scratch, Spread, collect, deposit, response::Kept};
use crate::{
    body::{Body, chunks, load, store},
    math::simd::Kernel,
    space::{
        Shape, Stencil,
        stencil::{LANES, Lane},
    },
};

/// C of a block (1/s): xx, xy, yx, yy.
pub type Affine = [Lane; 4];

/// Committed C of a block.
#[inline(always)]
pub fn committed(body: &Body, range: &Range<usize>) -> Affine {
    let mut c = [[0.0; LANES]; 4];
    for (lane, column) in c.iter_mut().zip(&body.committed.affine) {
        load(lane, column, range);
    }
    c
}

/// Stores C in the trial state.
#[inline(always)]
pub fn keep(c: &Affine, body: &mut Body, range: &Range<usize>) {
    for (lane, column) in c.iter().zip(&mut body.trial.affine) {
        store(lane, column, range);
    }
}

/// Place of node `k` of a patch along an axis: patches are numbered row by row ([`Shape::offsets`]).
#[inline(always)]
const fn place<S: Shape<N>, const N: usize>(k: usize, axis: usize) -> usize {
    let span = S::SPAN as usize;
    if axis == 0 { k % span } else { k / span }
}

/// Widest patch, nodes along an axis.
const WIDEST: usize = 4;

/// C of a block from the velocities of the nodes: component, node of the patch, point.
#[inline(always)]
pub fn fit<S: Shape<N>, const N: usize>(stencil: &Stencil<N>, velocity: [&Spread<N>; 2], h: f64) -> Affine {
    let mut c = [[0.0; LANES]; 4];
    for along in 0..2 {
        for i in 0..LANES {
            let (mut w, mut p) = ([0.0; WIDEST], [[0.0; WIDEST]; 2]);
            for k in 0..N {
                let (a, weight) = (place::<S, N>(k, along), stencil.weight(k, i));
                w[a] += weight;
                p[0][a] += weight * velocity[0].0[k][i];
                p[1][a] += weight * velocity[1].0[k][i];
            }
            let (mut d, mut b) = (0.0, [0.0; 2]);
            for low in 0..S::SPAN as usize {
                for high in low + 1..S::SPAN as usize {
                    let apart = (high - low) as f64;
                    d += apart * apart * w[low] * w[high];
                    b[0] += apart * (w[low] * p[0][high] - w[high] * p[0][low]);
                    b[1] += apart * (w[low] * p[1][high] - w[high] * p[1][low]);
                }
            }
            let inverse = 1.0 / (h * d);
            c[along][i] = b[0] * inverse;
            c[2 + along][i] = b[1] * inverse;
        }
    }
    c
}

/// Adds N_i m C (x_i - x_p) to the shares of momentum, along x and y. x_p is sum N_i x_i: what goes to the
/// nodes sums to 0 to rounding.
#[inline(always)]
pub fn add<S: Shape<N>, const N: usize>(
    shares: [&mut Patch<N>; 2],
    stencil: &Stencil<N>,
    mass: &Lane,
    c: &Affine,
    h: f64,
) {
    let [px, py] = shares;
    for i in 0..LANES {
        let mut at = [0.0; 2];
        for k in 0..N {
            let weight = stencil.weight(k, i);
            at[0] += weight * place::<S, N>(k, 0) as f64;
            at[1] += weight * place::<S, N>(k, 1) as f64;
        }
        let scale = h * mass[i];
        for k in 0..N {
            let share = scale * stencil.weight(k, i);
            let (dx, dy) = (place::<S, N>(k, 0) as f64 - at[0], place::<S, N>(k, 1) as f64 - at[1]);
            px.0[k][i] += share * (c[0][i] * dx + c[1][i] * dy);
            py.0[k][i] += share * (c[2][i] * dx + c[3][i] * dy);
        }
    }
}

/// The affine part of the momentum of the committed body, to the nodes by the kept stencils.
pub struct Spin<'a, S, const N: usize> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a Body,
    pub kept: &'a Kept<N>,
    pub out: &'a mut [Vec<f64>; 2],
    pub h: f64,
    pub shape: S,
}

impl<S: Shape<N>, const N: usize> Kernel for Spin<'_, S, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Spin { scratch: s, body, kept, out, h, .. } = self;
        let ranges = body.groups.iter().flat_map(|g| chunks(g.range.clone()));
        for (block, range) in ranges.enumerate() {
            load(&mut s.mass.0, &body.mass, &range);
            let [px, py, ..] = &mut s.shares;
            [&mut *px, &mut *py].into_iter().for_each(|p| p.0.iter_mut().for_each(|lane| lane.fill(0.0)));
            add::<S, N>([px, py], &kept.stencils[block], &s.mass.0, &committed(body, &range), h);
            for run in s.runs.of(block) {
                let slots = run.slots.map(|s| s as usize);
                let [x, y] = &mut *out;
                deposit([x, y], &slots, collect(&s.shares[..2], run));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{BSpline, Gimp, GimpWide, Grid, Linear, shape::contract};

    const GRADIENT: [f64; 4] = [0.3, -1.7, 0.9, 2.1];

    /// Nodal velocities of the linear field with [`GRADIENT`] and a mean, in the patch of each point.
    fn linear_field<S: Shape<N>, const N: usize>(grid: &Grid, s: &Stencil<N>) -> [Spread<N>; 2] {
        let mut out = [Spread::default(), Spread::default()];
        for i in 0..LANES {
            for (k, offset) in S::offsets(grid.row()).into_iter().enumerate() {
                let x = grid.node_position(s.base[i] + offset);
                for c in 0..2 {
                    out[c].0[k][i] = 5.0 + GRADIENT[2 * c] * x[0] + GRADIENT[2 * c + 1] * x[1];
                }
            }
        }
        out
    }

    /// The gradient of a linear field comes back whole, also from points 1e-12 cells from a node, where
    /// D is 1e-10 h^2; and to the nodes it gives momentum that sums to 0 and is C (x_i - x_p).
    fn there_and_back<S: Shape<N>, const N: usize>() {
        let grid = Grid { origin: [-1.0, 2.0], h: 0.5, cells: [12, 9] };
        for turn in 0..40 {
            let (x, y) = contract::places(&grid, turn);
            let s = contract::filled::<S, N>(&grid, &x, &y, &[[0.25 * grid.h; LANES]; 2]);
            let [vx, vy] = linear_field::<S, N>(&grid, &s);
            let c = fit::<S, N>(&s, [&vx, &vy], grid.h);
            // differences of velocities of order 10 over h
            let rounding = 40.0 * f64::EPSILON * 10.0 / grid.h;
            for (lane, exact) in c.iter().zip(GRADIENT) {
                assert!(lane.iter().all(|v| (v - exact).abs() < rounding), "{} {lane:?}", S::NAME);
            }
            let (mut px, mut py) = (Patch::<N>::default(), Patch::<N>::default());
            add::<S, N>([&mut px, &mut py], &s, &[2.0; LANES], &c, grid.h);
            for i in 0..LANES {
                assert!(px.0.iter().map(|p| p[i]).sum::<f64>().abs() < 1e-14);
                for (k, offset) in S::offsets(grid.row()).into_iter().enumerate() {
                    let node = grid.node_position(s.base[i] + offset);
                    let exact =
                        2.0 * s.weight(k, i) * (GRADIENT[2] * (node[0] - x[i]) + GRADIENT[3] * (node[1] - y[i]));
                    assert!((py.0[k][i] - exact).abs() < 1e-9, "{}", S::NAME);
                }
            }
        }
    }

    #[test]
    fn a_linear_field_comes_back_with_every_shape() {
        there_and_back::<Linear, 4>();
        there_and_back::<Gimp, 9>();
        there_and_back::<GimpWide, 16>();
        there_and_back::<BSpline, 9>();
    }

    #[test]
    fn with_bilinear_functions_it_is_the_gradient() {
        let grid = Grid { origin: [0.0, 0.0], h: 0.5, cells: [4, 4] };
        let x: Lane = std::array::from_fn(|i| 0.01 + 0.06 * i as f64);
        let y: Lane = std::array::from_fn(|i| 0.61 + 0.03 * i as f64);
        let s = contract::filled::<Linear, 4>(&grid, &x, &y, &[[0.0; LANES]; 2]);
        let mut v = [Spread::<4>::default(), Spread::default()];
        for k in 0..4 {
            v[0].0[k].fill([0.3, -0.8, 1.1, 0.2][k]);
            v[1].0[k].fill([1.3, 0.7, -0.4, 0.9][k]);
        }
        let c = fit::<Linear, 4>(&s, [&v[0], &v[1]], grid.h);
        for i in 0..LANES {
            for (row, axis) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let gradient: f64 = (0..4).map(|k| v[row].0[k][i] * s.grad(k, i)[axis]).sum();
                assert!((c[2 * row + axis][i] - gradient).abs() < 1e-13);
            }
        }
    }
}
