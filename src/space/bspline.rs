//! Quadratic B-splines centred on the nodes (Steffen, Kirby & Berzins 2008).
//!
//! Around the nearest node, at the distance t in (-1/2, 1/2) from it (cells), along each axis
//! ```text
//! N_-1 = (1/2 - t)^2 / 2,   N_0 = 3/4 - t^2,   N_1 = (1/2 + t)^2 / 2
//! ```
//! and their product in the plane: gradients are continuous, so that no force jumps where a point
//! changes its cell. This is GIMP (`space::gimp`) with half-lengths that stay at h/2: no domains, no
//! deformation to keep.
//!
//! - Beside a side there is no node beyond. Within half a cell of it the spline goes on along its
//!   tangent, which is the bilinear function of the side's node and the next: gradients stay continuous,
//!   linear fields are reproduced up to the side, and a point at a support moves as the support does.
//!   (Steffen et al. change the splines of the first three nodes for that, Gan, Sun, Chen, Liu & Wei 2018
//!   move the nodes; here the functions of the nodes inside stay what they are.)
//! - A point that lies half-way between nodes to within `EDGE` is half-way: a node so far away would
//!   have next to no mass.
//! - So a patch may hold nodes of weight 0, as with GIMP: one in the half cell at a side, and half-way.

use super::{
    grid::Grid,
    shape::{EDGE, ROUND, Shape},
    stencil::{LANES, Lane, Stencil},
};

/// Nearest that a point counts to a side (cells): as for the other shapes.
const NEAREST: f64 = 2.0 * EDGE;

/// Quadratic B-splines on patches of 3 x 3 nodes.
#[derive(Clone, Copy, Debug)]
pub struct BSpline;

impl Shape<9> for BSpline {
    const NAME: &'static str = "bspline";
    const DOMAIN: bool = false;
    const BARE_NODES: bool = true;
    const SPAN: u32 = 3;
    const LONGEST: f64 = 0.0;

    #[inline(always)]
    fn fill(grid: &Grid, x: &Lane, y: &Lane, _: &[Lane; 2], s: &mut Stencil<9>) {
        let ih = 1.0 / grid.h;
        let row = grid.row();
        let [end_x, end_y] = grid.cells.map(f64::from);
        for i in 0..LANES {
            let (first_x, wx, gx) = line((x[i] - grid.origin[0]) * ih, end_x);
            let (first_y, wy, gy) = line((y[i] - grid.origin[1]) * ih, end_y);
            s.base[i] = first_y.wrapping_mul(row).wrapping_add(first_x);
            s.set(0, i, wx, gx.map(|g| ih * g));
            s.set(1, i, wy, gy.map(|g| ih * g));
        }
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

/// First node of the patch, weights and slopes (1 / cell) at the coordinate `g` (cells) along an axis
/// that ends at `end`.
#[inline(always)]
fn line(g: f64, end: f64) -> (u32, [f64; 3], [f64; 3]) {
    let g = clamp(g, NEAREST, end - NEAREST);
    let first = clamp((g + ROUND) - ROUND - 1.0, 0.0, end - 2.0);
    let (t, beyond) = split(g - first - 1.0);
    let (low, high) = (0.5 - t, 0.5 + t);
    let slope = [-low, -2.0 * t, high];
    let at = [0.5 * low * low, 0.75 - t * t, 0.5 * high * high];
    ((first + ROUND).to_bits() as u32, std::array::from_fn(|k| at[k] + beyond * slope[k]), slope)
}

/// A distance from the middle of a patch as the one at which the spline is taken, in [-1/2, 1/2], and
/// what goes on from there along the tangent.
#[inline(always)]
fn split(d: f64) -> (f64, f64) {
    let t = if d > 0.5 - EDGE { 0.5 } else { d };
    let t = if t < EDGE - 0.5 { -0.5 } else { t };
    (t, d - t)
}

/// `low` if v is below it or not a number, `high` if it is above.
#[inline(always)]
fn clamp(v: f64, low: f64, high: f64) -> f64 {
    let v = if v > low { v } else { low };
    if v < high { v } else { high }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Gimp, shape::contract};

    #[test]
    fn contract() {
        contract::holds::<BSpline, 9>();
    }

    /// Everywhere, also beside the sides, where GIMP cuts its domains. To rounding, but for the
    /// [`EDGE`] within which GIMP gives up a part of the domain.
    #[test]
    fn it_is_gimp_with_half_lengths_of_half_a_cell() {
        let grid = Grid { origin: [-1.0, 2.0], h: 0.5, cells: [5, 3] };
        for turn in 0..200 {
            let (x, y) = contract::places(&grid, turn);
            let spline = contract::filled::<BSpline, 9>(&grid, &x, &y, &[[0.0; LANES]; 2]);
            let gimp = contract::filled::<Gimp, 9>(&grid, &x, &y, &[[0.5 * grid.h; LANES]; 2]);
            assert_eq!(spline.base, gimp.base);
            for (k, i) in (0..9).flat_map(|k| (0..LANES).map(move |i| (k, i))) {
                assert!((spline.weight(k, i) - gimp.weight(k, i)).abs() < 2.0 * EDGE);
                let gap = |axis: usize| (spline.grad(k, i)[axis] - gimp.grad(k, i)[axis]).abs();
                assert!(gap(0).max(gap(1)) < 4.0 * EDGE / grid.h, "{} {}", x[i], y[i]);
            }
        }
    }

    /// Weight and slope run through where the nearest node changes, and where the side begins.
    #[test]
    fn gradients_are_continuous() {
        let end = 6.0;
        let at = |g: f64| {
            let (first, weight, slope) = line(g, end);
            let mut nodes = [[0.0; 2]; 7];
            (0..3).for_each(|k| nodes[first as usize + k] = [weight[k], slope[k]]);
            nodes
        };
        for half in 0..6 {
            let g = 0.5 + f64::from(half);
            let (before, after) = (at(g - 1e-9), at(g + 1e-9));
            let gap = before.iter().flatten().zip(after.iter().flatten()).map(|(a, b)| (a - b).abs());
            assert!(gap.fold(0.0, f64::max) < 5e-9, "{g}");
        }
    }

    /// A point at a side moves as the side's node does.
    #[test]
    fn it_interpolates_at_the_sides() {
        for gap in [0.0, 1e-12, 1e-6, 1e-3, 0.3] {
            let ((_, low, _), (_, high, _)) = (line(gap, 6.0), line(6.0 - gap, 6.0));
            assert!((1.0 - low[0] - gap).abs() < 1e-9 && (1.0 - high[2] - gap).abs() < 1e-9);
            assert_eq!((low[2], high[0]), (0.0, 0.0));
        }
    }

    #[test]
    fn half_way_there_is_neither_weight_nor_gradient_beyond() {
        for sliver in [0.0, 1e-17, 0.9 * EDGE] {
            let (_, weight, slope) = line(2.5 + sliver, 6.0);
            let far = if weight[0] == 0.0 { 0 } else { 2 };
            assert_eq!((weight[far], slope[far]), (0.0, 0.0));
        }
    }

    #[test]
    fn lanes_of_garbage_stay_finite() {
        let grid = Grid { origin: [100.0, -5.0], h: 0.5, cells: [4, 4] };
        let x: Lane = std::array::from_fn(|i| [0.0, 1e300, -1e300, f64::NAN][i % 4]);
        let s = contract::filled::<BSpline, 9>(&grid, &x, &x, &[[0.0; LANES]; 2]);
        assert!(contract::finite(&s));
    }
}
