//! Shape functions of the uniform generalised interpolation material point method.
//!
//! A point is a rectangle, its domain, and its weights are the bilinear hats averaged over it:
//! ```text
//! S_i = 1/(b - a) int_a^b N_i dx,   dS_i/dx = 1/(b - a) int_a^b dN_i/dx dx,   [a, b] = x_p -+ lp
//! ```
//! along each axis, and their product in the plane (Bardenhagen & Kober 2004, eq. 29; as cases of
//! the position in Coombs et al. 2020, table 1). Here the integral is taken cell by cell. A cell c
//! that holds the part f of the domain, with its middle at m in (0, 1), gives
//! ```text
//! S_c += f (1 - m),  S_c+1 += f m,   dS_c/dx -= f / h,  dS_c+1/dx += f / h
//! ```
//! which needs no cases and loses no digits however small lp is.
//!
//! - A domain does not stick out of the grid: beside a side the half-length across it is at most
//!   the distance of the point. So the weights are symmetric about the point, reproduce linear
//!   fields everywhere, and a point at a support moves as the support does. (Clipping to the part
//!   inside gives the velocity at the middle of that part: points then went through supports.)
//! - Half-lengths below [`SHORTEST`] count as that, those above [`Shape::LONGEST`] as that.
//! - A patch is as large as the longest domain needs, so a node may have weight 0. It then has
//!   gradient 0 too ([`Shape::BARE_NODES`]).

use super::{
    grid::Grid,
    shape::{EDGE, ROUND, Shape},
    stencil::{LANES, Lane, Stencil},
};

/// Smallest half-length of a domain (cells).
pub const SHORTEST: f64 = 1e-3;

/// Nearest that a point counts to a side (cells): there the domain is clipped.
const NEAREST: f64 = 2.0 * EDGE;

/// GIMP on patches of 3 x 3 nodes, for domains up to a cell long: half-lengths to h/2.
#[derive(Clone, Copy, Debug)]
pub struct Gimp;

/// GIMP on patches of 4 x 4 nodes, for domains up to two cells long: half-lengths to h.
#[derive(Clone, Copy, Debug)]
pub struct GimpWide;

impl Shape<9> for Gimp {
    const NAME: &'static str = "gimp";
    const DOMAIN: bool = true;
    const BARE_NODES: bool = true;
    const SPAN: u32 = 3;
    const LONGEST: f64 = 0.5;

    #[inline(always)]
    fn fill(grid: &Grid, x: &Lane, y: &Lane, half: &[Lane; 2], stencil: &mut Stencil<9>) {
        // around the nearest node: the domain reaches at most a cell to both sides of it
        fill::<Gimp, 9, 3>(grid, [x, y], half, stencil, 0.0);
    }

    #[inline(always)]
    fn offsets(row: u32) -> [u32; 9] {
        std::array::from_fn(|k| k as u32 % 3 + row * (k as u32 / 3))
    }

    /// Cells around the nodes.
    #[inline(always)]
    fn order(grid: &Grid) -> Grid {
        grid.around_nodes()
    }
}

impl Shape<16> for GimpWide {
    const NAME: &'static str = "gimp_wide";
    const DOMAIN: bool = true;
    const BARE_NODES: bool = true;
    const SPAN: u32 = 4;
    const LONGEST: f64 = 1.0;

    #[inline(always)]
    fn fill(grid: &Grid, x: &Lane, y: &Lane, half: &[Lane; 2], stencil: &mut Stencil<16>) {
        // around the point's cell: the domain reaches at most a cell to both sides of it
        fill::<GimpWide, 16, 4>(grid, [x, y], half, stencil, 0.5);
    }

    #[inline(always)]
    fn offsets(row: u32) -> [u32; 16] {
        std::array::from_fn(|k| k as u32 % 4 + row * (k as u32 / 4))
    }
}

/// Fills a stencil of `M` x `M` nodes whose first one is the node nearest to g - `shift`, less 1.
#[inline(always)]
fn fill<S: Shape<N>, const N: usize, const M: usize>(
    grid: &Grid,
    place: [&Lane; 2],
    half: &[Lane; 2],
    s: &mut Stencil<N>,
    shift: f64,
) {
    let x = line::<S, N, M>(grid, 0, place[0], &half[0], s, shift);
    let y = line::<S, N, M>(grid, 1, place[1], &half[1], s, shift);
    let row = grid.row();
    for i in 0..LANES {
        s.base[i] = y[i].wrapping_mul(row).wrapping_add(x[i]);
    }
}

/// Sets the factors along an axis; returns the first node of each patch along it.
#[inline(always)]
fn line<S: Shape<N>, const N: usize, const M: usize>(
    grid: &Grid,
    axis: usize,
    x: &Lane,
    half: &Lane,
    s: &mut Stencil<N>,
    shift: f64,
) -> [u32; LANES] {
    let (origin, ih, end) = (grid.origin[axis], 1.0 / grid.h, f64::from(grid.cells[axis]));
    let last = end - (M as f64 - 1.0);
    let mut nodes = [0; LANES];
    for i in 0..LANES {
        let g = clamp((x[i] - origin) * ih, 0.0, end);
        let room = if g < end - g { g } else { end - g };
        let l = clamp(clamp(half[i] * ih, SHORTEST, S::LONGEST), 0.0, if room > NEAREST { room } else { NEAREST });
        let first = clamp(((g - shift) + ROUND) - ROUND - 1.0, 0.0, last);
        let (a, b) = (clamp(g - l, 0.0, end) - first, clamp(g + l, 0.0, end) - first);
        let (weight, slope) = average::<M>(a, b);
        s.set(axis, i, weight, slope.map(|v| v * ih));
        nodes[i] = (first + ROUND).to_bits() as u32;
    }
    nodes
}

/// `low` if v is below it or not a number, `high` if it is above.
#[inline(always)]
fn clamp(v: f64, low: f64, high: f64) -> f64 {
    let v = if v > low { v } else { low };
    if v < high { v } else { high }
}

/// Averages over [a, b] of the hats of the nodes 0 .. M - 1 and of their slopes; see the head of
/// this file. Parts of less than [`EDGE`] count as none: such a node would have next to no mass.
#[inline(always)]
fn average<const M: usize>(a: f64, b: f64) -> ([f64; M], [f64; M]) {
    let (mut part, mut middle) = ([0.0; M], [0.0; M]);
    let mut length = 0.0;
    for c in 0..M - 1 {
        let (low, high) = (c as f64, c as f64 + 1.0);
        let (from, to) = (clamp(a, low, high), clamp(b, low, high));
        let inside = to - from;
        part[c] = if inside < EDGE { 0.0 } else { inside };
        middle[c] = 0.5 * (from + to) - low;
        length += part[c];
    }
    let inverse = 1.0 / length;
    let (mut weight, mut slope) = ([0.0; M], [0.0; M]);
    for c in 0..M - 1 {
        let f = part[c] * inverse;
        weight[c] += f * (1.0 - middle[c]);
        weight[c + 1] += f * middle[c];
        slope[c] -= f;
        slope[c + 1] += f;
    }
    (weight, slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::shape::contract;

    #[test]
    fn contracts() {
        contract::holds::<Gimp, 9>();
        contract::holds::<GimpWide, 16>();
    }

    /// Weights and gradients in one dimension as the cases of Coombs et al. (2020), table 1, h = 1;
    /// lp <= 1/2.
    fn cases(d: f64, l: f64) -> [f64; 2] {
        let (r, sign) = (d.abs(), d.signum());
        if r <= l {
            [1.0 - (r * r + l * l) / (2.0 * l), -d / l]
        } else if r <= 1.0 - l {
            [1.0 - r, -sign]
        } else if r < 1.0 + l {
            let rest = 1.0 + l - r;
            [rest * rest / (4.0 * l), -sign * rest / (2.0 * l)]
        } else {
            [0.0, 0.0]
        }
    }

    #[test]
    fn weights_are_those_of_the_published_cases() {
        for l in [0.001, 0.05, 0.25, 0.4, 0.5] {
            for step in 0..=200 {
                let g = 0.5 + f64::from(step) / 200.0;
                let (weight, slope) = average::<3>(g - l, g + l);
                for k in 0..3 {
                    let [w, s] = cases(g - k as f64, l);
                    assert!((weight[k] - w).abs() < 1e-12, "{g} {l}");
                    assert!((slope[k] - s).abs() < 1e-10, "{g} {l}");
                }
            }
        }
    }

    /// Averages by the midpoint rule, for any domain.
    #[test]
    fn weights_are_averages_of_hats() {
        let hat = |x: f64, k: usize| (1.0 - (x - k as f64).abs()).max(0.0);
        for (a, b) in [(0.0, 0.2), (0.0, 1.3), (0.7, 2.6), (1.2, 3.0), (2.9, 3.0), (0.5, 2.5)] {
            let (weight, slope) = average::<4>(a, b);
            let n = 100_000;
            for k in 0..4 {
                let at = |i: usize| a + (b - a) * (i as f64 + 0.5) / n as f64;
                let mean = (0..n).map(|i| hat(at(i), k)).sum::<f64>() / n as f64;
                assert!((weight[k] - mean).abs() < 1e-9);
                assert!((slope[k] - (hat(b, k) - hat(a, k)) / (b - a)).abs() < 1e-12);
            }
        }
    }

    /// A domain that ends all but on a node gives that part to nobody, not a force without mass.
    #[test]
    fn slivers_have_neither_weight_nor_gradient() {
        for sliver in [0.0, 1e-17, 1e-12, 0.99e-10] {
            let (weight, slope) = average::<3>(0.5, 1.0 + sliver);
            assert_eq!((weight[2], slope[2]), (0.0, 0.0));
        }
        let (weight, slope) = average::<3>(0.5, 1.0 + 1.1e-10);
        assert!(weight[2] > 0.0 && slope[2] > 0.0);
    }

    /// At a side a point moves as the side's node does, however large its domain is.
    #[test]
    fn a_point_at_a_side_moves_with_the_side() {
        let grid = Grid { origin: [0.0, 0.0], h: 1.0, cells: [200, 200] };
        let gap = [1e-13, 1e-10, 1e-6, 1e-3];
        let x: Lane = std::array::from_fn(|i| if i < 4 { gap[i] } else { 200.0 - gap[i % 4] });
        let y = [7.3; LANES];
        let s = contract::filled::<GimpWide, 16>(&grid, &x, &y, &[[0.8; LANES]; 2]);
        for i in 0..LANES {
            let side = if i < 4 { 0 } else { 3 };
            let there: f64 = (0..4).map(|row| s.weight(side + 4 * row, i)).sum();
            assert!((1.0 - there - gap[i % 4]).abs() < 2e-10, "{} {there}", x[i]);
        }
    }

    #[test]
    fn lanes_of_garbage_stay_finite() {
        let grid = Grid { origin: [100.0, -5.0], h: 0.5, cells: [4, 4] };
        let x: Lane = std::array::from_fn(|i| [0.0, 1e9, -1e9, 101.0][i % 4]);
        let half = [[f64::NAN; LANES], [1e300; LANES]];
        let s = contract::filled::<Gimp, 9>(&grid, &x, &x, &half);
        assert!(contract::finite(&s));
    }
}
