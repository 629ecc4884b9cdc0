//! Shape functions. Each fills the stencil of a block; a new one is one more `impl Shape`.

use super::{
    grid::Grid,
    stencil::{LANES, Lane, Stencil},
};

/// Shape functions with `N` nodes a point.
pub trait Shape<const N: usize>: Copy + Send + Sync + 'static {
    const NAME: &'static str;

    /// Whether a point has a domain over which the shape functions are averaged. Without, no
    /// half-lengths are computed and the body keeps no deformation for them.
    const DOMAIN: bool;

    /// Whether a patch may hold nodes of weight 0. These have gradient 0 too, and the step must expect
    /// active nodes without mass: they take no force, and `1 / m` is 0 there.
    const BARE_NODES: bool;

    /// Nodes of a patch along each axis. A grid needs a cell less than that, at least.
    const SPAN: u32;

    /// Largest half-length of a domain (cells); longer ones are cut to it. 0 without domains.
    const LONGEST: f64;

    /// Weights, gradients and lower left node of each point at (`x`, `y`), for all lanes; `half`
    /// are the half-lengths of the points' domains along x and y (m), read if `DOMAIN`.
    fn fill(grid: &Grid, x: &Lane, y: &Lane, half: &[Lane; 2], stencil: &mut Stencil<N>);

    /// Offsets of the patch's nodes from its lower left node, for `row` nodes along x.
    fn offsets(row: u32) -> [u32; N];

    /// The grid whose cells hold the points that share a patch: points are kept in its order.
    #[inline(always)]
    fn order(grid: &Grid) -> Grid {
        *grid
    }
}

/// Bilinear shape functions of the four nodes around a point: N = (1 - xi)(1 - eta), ...
#[derive(Clone, Copy, Debug)]
pub struct Linear;

/// Local coordinates are kept this far from the cell's edges. A point on an edge would have
/// weight 0 but a gradient 1/h at the far nodes: force on a node without mass. So close to the
/// edge nothing else changes.
pub(super) const EDGE: f64 = 1e-10;

/// 2^52 + 2^51: adding it rounds to a whole number, which then stands in the low bits.
pub(super) const ROUND: f64 = 6_755_399_441_055_744.0;

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
    const DOMAIN: bool = false;
    const BARE_NODES: bool = false;
    const SPAN: u32 = 2;
    const LONGEST: f64 = 0.0;

    #[inline(always)]
    fn fill(grid: &Grid, x: &Lane, y: &Lane, _: &[Lane; 2], s: &mut Stencil<4>) {
        let ih = 1.0 / grid.h;
        let row = grid.row();
        let [ox, oy] = grid.origin;
        let [last_x, last_y] = grid.cells.map(|n| f64::from(n) - 1.0);
        for i in 0..LANES {
            let (cx, xi) = split((x[i] - ox) * ih, last_x);
            let (cy, eta) = split((y[i] - oy) * ih, last_y);
            s.base[i] = cy.wrapping_mul(row).wrapping_add(cx);
            s.set(0, i, [1.0 - xi, xi], [-ih, ih]);
            s.set(1, i, [1.0 - eta, eta], [-ih, ih]);
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

    /// Half-lengths tried (cells): none, some, and longer than any shape takes.
    const HALF: [[f64; 2]; 5] = [[0.0, 0.0], [0.01, 0.3], [0.25, 0.25], [0.5, 0.47], [0.9, 1.7]];

    /// Partition of unity, nodes in the grid, no negative weight, no gradient where there is no
    /// weight, linear fields and their gradients: everywhere. Gradients by finite differences:
    /// where the domain is not cut by a side.
    pub fn holds<S: Shape<N>, const N: usize>() {
        let grid = Grid { origin: [-1.0, 2.0], h: 0.5, cells: [12, 9] };
        for half in HALF {
            let half = half.map(|l| [l * grid.h; LANES]);
            for turn in 0..40 {
                let (x, y) = places(&grid, turn);
                everywhere::<S, N>(&grid, &x, &y, &half);
                inside::<S, N>(&grid, &x, &y, &half);
            }
        }
    }

    /// Points all over the grid, some close to its sides and to the edges of cells.
    pub fn places(grid: &Grid, turn: usize) -> (Lane, Lane) {
        let place = |i: usize, axis: usize, step: f64| {
            let (t, cells) = ((step * (1 + i + LANES * turn) as f64) % 1.0, f64::from(grid.cells[axis]));
            let g = match (i + turn) % 8 {
                0 => 1e-12 + 0.2 * t * t * t,
                1 => cells - 1e-12 - 0.2 * t * t * t,
                2 => (cells * t).round().clamp(1.0, cells - 1.0) + 1e-9 * (t - 0.5),
                _ => cells * t,
            };
            grid.origin[axis] + grid.h * g
        };
        (std::array::from_fn(|i| place(i, 0, 0.618_033_988_7)), std::array::from_fn(|i| place(i, 1, 0.754_877_666_2)))
    }

    fn everywhere<S: Shape<N>, const N: usize>(grid: &Grid, x: &Lane, y: &Lane, half: &[Lane; 2]) {
        let s = filled::<S, N>(grid, x, y, half);
        for i in 0..LANES {
            let nodes = nodes_of::<S, N>(grid, s.base[i]);
            let sum = |f: &dyn Fn(usize) -> f64| -> f64 { (0..N).map(f).sum() };
            assert!((sum(&|k| s.weight(k, i)) - 1.0).abs() < 1e-14);
            for k in 0..N {
                assert!(s.weight(k, i) > 0.0 || (S::BARE_NODES && s.weight(k, i) == 0.0));
                assert!(s.weight(k, i) > 0.0 || (s.grad(k, i) == [0.0; 2]));
            }
            for (axis, at) in [x[i], y[i]].into_iter().enumerate() {
                assert!((sum(&|k| s.weight(k, i) * nodes[k][axis]) - at).abs() < 1e-9);
                assert!(sum(&|k| s.grad(k, i)[axis]).abs() < 1e-13);
                assert!((sum(&|k| s.grad(k, i)[axis] * nodes[k][axis]) - 1.0).abs() < 1e-12);
                assert!(sum(&|k| s.grad(k, i)[axis] * nodes[k][1 - axis]).abs() < 1e-12);
            }
        }
    }

    fn inside<S: Shape<N>, const N: usize>(grid: &Grid, x: &Lane, y: &Lane, half: &[Lane; 2]) {
        let eps = 1e-6;
        let s = filled::<S, N>(grid, x, y, half);
        let [dx, dy] = [
            [filled::<S, N>(grid, &x.map(|v| v + eps), y, half), filled::<S, N>(grid, &x.map(|v| v - eps), y, half)],
            [filled::<S, N>(grid, x, &y.map(|v| v + eps), half), filled::<S, N>(grid, x, &y.map(|v| v - eps), half)],
        ];
        for i in (0..LANES).filter(|&i| domain_inside::<S, N>(grid, [x[i], y[i]], half)) {
            for (axis, at) in [x[i], y[i]].into_iter().enumerate() {
                let pair = if axis == 0 { &dx } else { &dy };
                if pair.iter().any(|p| p.base[i] != s.base[i]) || near_edge(grid, at, axis) {
                    continue;
                }
                for k in 0..N {
                    let fd = (pair[0].weight(k, i) - pair[1].weight(k, i)) / (2.0 * eps);
                    // where an end of the domain crosses a node, its gradient has a kink: eps / (2 lp h)
                    assert!((fd - s.grad(k, i)[axis]).abs() < 4e-4, "{} {fd} {}", S::NAME, s.grad(k, i)[axis]);
                }
            }
        }
    }

    /// Whether the domain and a bit more is inside the grid.
    fn domain_inside<S: Shape<N>, const N: usize>(grid: &Grid, x: [f64; 2], half: &[Lane; 2]) -> bool {
        (0..2).all(|a| {
            let l = half[a][0].min(S::LONGEST * grid.h) + 0.01 * grid.h;
            x[a] - l > grid.origin[a] && x[a] + l < grid.far()[a]
        })
    }

    /// Within the finite difference's reach of an edge, where the gradient of a small domain jumps.
    fn near_edge(grid: &Grid, x: f64, axis: usize) -> bool {
        let g = (x - grid.origin[axis]) / grid.h;
        (g - g.round()).abs() < 2e-3
    }

    fn nodes_of<S: Shape<N>, const N: usize>(grid: &Grid, base: u32) -> [[f64; 2]; N] {
        S::offsets(grid.row()).map(|o| {
            let (first, place) = (grid.node_place(base), grid.node_place(base + o));
            assert!(place[0] >= first[0] && place[0] < first[0] + S::SPAN && place[1] < first[1] + S::SPAN);
            assert!(place[1] <= grid.cells[1]);
            grid.node_position(base + o)
        })
    }

    /// Whether all weights and gradients are numbers.
    pub fn finite<const N: usize>(s: &Stencil<N>) -> bool {
        let sound = |k, i| s.weight(k, i).is_finite() && s.grad(k, i).iter().all(|g| g.is_finite());
        (0..N).all(|k| (0..LANES).all(|i| sound(k, i)))
    }

    /// The stencil of a block.
    pub fn filled<S: Shape<N>, const N: usize>(grid: &Grid, x: &Lane, y: &Lane, half: &[Lane; 2]) -> Box<Stencil<N>> {
        let mut s = Box::<Stencil<N>>::default();
        S::fill(grid, x, y, half, &mut s);
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
        let x = std::array::from_fn(|i| 0.25 * (i % 8) as f64 + 1e-300);
        let y = [0.5; LANES];
        let s = contract::filled::<Linear, 4>(&grid, &x, &y, &[[0.0; LANES]; 2]);
        for i in 0..LANES {
            assert!((0..4).all(|k| s.weight(k, i) > 0.0));
            assert!((s.base[i] + grid.row() + 1) < grid.nodes() as u32);
        }
    }
}
