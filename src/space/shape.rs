//! Shape functions. Each fills the stencil of a block; a new one is one more `impl Shape`.

use super::{
    grid::Grid,
    stencil::{LANES, Lane, Stencil},
};

/// Shape functions with `N` nodes a point.
pub trait Shape<const N: usize>: Copy + Send + Sync + 'static {
    const NAME: &'static str;

    /// Weights, gradients and lower left node of each point at (`x`, `y`), for all lanes.
    fn fill(grid: &Grid, x: &Lane, y: &Lane, stencil: &mut Stencil<N>);

    /// Offsets of the patch's nodes from its lower left node, for `row` nodes along x.
    fn offsets(row: u32) -> [u32; N];
}

/// Bilinear shape functions of the four nodes around a point: N = (1 - xi)(1 - eta), ...
#[derive(Clone, Copy, Debug)]
pub struct Linear;

/// Local coordinates are kept this far from the cell's edges. A point on an edge would have
/// weight 0 but a gradient 1/h at the far nodes: force on a node without mass. So close to the
/// edge nothing else changes.
const EDGE: f64 = 1e-10;

/// 2^52 + 2^51: adding it rounds to a whole number, which then stands in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Splits a coordinate in cells into cell number, at most `last`, and local coordinate in
/// [EDGE, 1 - EDGE].
#[inline(always)]
fn split(g: f64, last: f64) -> (u32, f64) {
    let cell = ((g - 0.5) + ROUND) - ROUND;
    let cell = if cell > last { last } else { cell };
    let local = g - cell;
    let clamped = if local < EDGE { EDGE } else { local };
    let clamped = if clamped > 1.0 - EDGE { 1.0 - EDGE } else { clamped };
    ((cell + ROUND).to_bits() as u32, clamped)
}

impl Shape<4> for Linear {
    const NAME: &'static str = "linear";

    #[inline(always)]
    fn fill(grid: &Grid, x: &Lane, y: &Lane, s: &mut Stencil<4>) {
        let ih = 1.0 / grid.h;
        let row = grid.row();
        let [ox, oy] = grid.origin;
        let [last_x, last_y] = grid.cells.map(|n| f64::from(n) - 1.0);
        for i in 0..LANES {
            let (cx, xi) = split((x[i] - ox) * ih, last_x);
            let (cy, eta) = split((y[i] - oy) * ih, last_y);
            s.base[i] = cy.wrapping_mul(row).wrapping_add(cx);
            let (xm, ym) = (1.0 - xi, 1.0 - eta);
            s.weight[0][i] = xm * ym;
            s.weight[1][i] = xi * ym;
            s.weight[2][i] = xm * eta;
            s.weight[3][i] = xi * eta;
            let (gym, gy) = (ym * ih, eta * ih);
            s.grad[0][0][i] = -gym;
            s.grad[0][1][i] = gym;
            s.grad[0][2][i] = -gy;
            s.grad[0][3][i] = gy;
            let (gxm, gx) = (xm * ih, xi * ih);
            s.grad[1][0][i] = -gxm;
            s.grad[1][1][i] = -gx;
            s.grad[1][2][i] = gxm;
            s.grad[1][3][i] = gx;
        }
    }

    #[inline(always)]
    fn offsets(row: u32) -> [u32; 4] {
        [0, 1, row, row + 1]
    }
}

#[cfg(test)]
pub(crate) mod contract {
    //! What every shape function must satisfy.
    use super::*;

    /// Partition of unity, reproduction of linear fields, gradients by finite differences.
    pub fn holds<S: Shape<N>, const N: usize>() {
        let grid = Grid { origin: [-1.0, 2.0], h: 0.5, cells: [12, 9] };
        let mut x = [0.0; LANES];
        let mut y = [0.0; LANES];
        for i in 0..LANES {
            let t = i as f64 / LANES as f64;
            x[i] = 0.03 + 3.9 * t;
            y[i] = 3.04 + 2.4 * ((7.3 * t) % 1.0);
        }
        let stencil = filled::<S, N>(&grid, &x, &y);
        let eps = 1e-6;
        let plus = filled::<S, N>(&grid, &x.map(|v| v + eps), &y);
        for i in 0..LANES {
            let sum = |f: &dyn Fn(usize, [f64; 2]) -> f64| -> f64 {
                (0..N).map(|k| f(k, grid.node_position(stencil.base[i] + S::offsets(grid.row())[k]))).sum()
            };
            assert!((sum(&|k, _| stencil.weight[k][i]) - 1.0).abs() < 1e-14);
            assert!((sum(&|k, n| stencil.weight[k][i] * n[0]) - x[i]).abs() < 1e-9);
            assert!((sum(&|k, n| stencil.weight[k][i] * n[1]) - y[i]).abs() < 1e-9);
            assert!((sum(&|k, n| stencil.grad[0][k][i] * n[0]) - 1.0).abs() < 1e-12);
            assert!(sum(&|k, n| stencil.grad[0][k][i] * n[1]).abs() < 1e-12);
            assert!((sum(&|k, n| stencil.grad[1][k][i] * n[1]) - 1.0).abs() < 1e-12);
            for k in 0..N {
                if plus.base[i] == stencil.base[i] {
                    let fd = (plus.weight[k][i] - stencil.weight[k][i]) / eps;
                    assert!((fd - stencil.grad[0][k][i]).abs() < 1e-5);
                }
            }
        }
    }

    fn filled<S: Shape<N>, const N: usize>(grid: &Grid, x: &Lane, y: &Lane) -> Box<Stencil<N>> {
        let mut s = Box::<Stencil<N>>::default();
        S::fill(grid, x, y, &mut s);
        s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_contract() {
        contract::holds::<Linear, 4>();
    }

    #[test]
    fn points_on_nodes_stay_in_the_grid_with_positive_weights() {
        let grid = Grid { origin: [0.0, 0.0], h: 0.25, cells: [8, 4] };
        let mut s = Box::<Stencil<4>>::default();
        let x = std::array::from_fn(|i| 0.25 * (i % 8) as f64 + 1e-300);
        let y = [0.5; LANES];
        Linear::fill(&grid, &x, &y, &mut s);
        for i in 0..LANES {
            assert!(s.weight.iter().all(|w| w[i] > 0.0));
            assert!((s.base[i] + grid.row() + 1) < grid.nodes() as u32);
        }
    }
}
