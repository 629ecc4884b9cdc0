//! The linearised explicit step as small dense matrices, built apart from the program's kernels.
//!
//! Notation: N_ip the shape functions at the points, P = N diag(m) the map to the nodes,
//! M = diag(P 1) the lumped mass, Mc = N diag(m) N^T the consistent one, K = sum V B^T C B the
//! stiffness, all for points that stay where they are. A step of FLIP is
//! ```text
//! q   = M^-1 P v_p                        nodal velocity at the start
//! w   = q + dt M^-1 f                     after the forces f = -K u
//! v_p <- v_p + N^T (w - q)                so next time q' = q + dt A M^-1 f,   A = M^-1 Mc
//! ```
//! A has rows that sum to 1 and eigenvalues a in [0, 1]: what goes to the points and comes back is
//! smoothed. MUSL strains with M^-1 P v_p' = q', USL with w:
//! ```text
//! MUSL  u' = u + dt q':   symplectic Euler for the operator A M^-1 K = M^-1 Mc M^-1 K, stable to
//!                         dt = 2 / sqrt(lambda_max(M^-1 Mc M^-1 K))
//! USL   u' = u + dt w:    where A and M^-1 K share a mode, z^2 - (2 - s) z + 1 - s (1 - a) = 0,
//!                         s = dt^2 lambda(M^-1 K): damped by 1 - a, stable to s = 4 / (2 - a)
//! ```
//! so FLIP with USL is stable up to somewhere between sqrt(1/2) and 1 of 2/sqrt(lambda_max(M^-1 K)).
//! With evenly spaced points at 1/4 and 3/4 of a cell, a = 5/8 + 3/8 cos kh and
//! lambda = (2 c/h)^2 sin^2(kh/2): MUSL to sqrt(3) h/c, USL to sqrt(4/7) h/c.
//! A mass floor replaces M by max(M, floor) where it divides a force.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::{sim::Simulation, space::Grid};

/// Isotropic elasticity as the operator needs it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stiffness {
    /// Lame's lambda (kPa).
    pub lambda: f64,
    /// G (kPa).
    pub shear: f64,
}

impl Stiffness {
    pub fn of(e: &crate::case::Elastic) -> Self {
        let (young, nu) = (e.young_modulus, e.poisson_ratio);
        Stiffness { lambda: young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), shear: young / (2.0 * (1.0 + nu)) }
    }
}

/// The matrices over the free nodal components, in coordinates scaled by sqrt(M), in which M is
/// the identity, K symmetric and A symmetric.
pub(super) struct Operator {
    /// M^-1/2 K M^-1/2 (1/s2).
    stiffness: DMatrix<f64>,
    /// M^-1/2 Mc M^-1/2 = M^1/2 A M^-1/2.
    smoothing: DMatrix<f64>,
    /// M / max(M, floor).
    share: DVector<f64>,
}

impl Operator {
    /// Of a body on a grid, with the motion free along the first `axes` axes and held along the
    /// others. `floor` is a mass (t/m).
    pub fn of(sim: &Simulation, grid: &Grid, law: Stiffness, axes: usize, floor: f64, near: Near) -> Self {
        let n = axes * grid.nodes();
        let (mut mass, mut consistent, mut stiffness) = (vec![0.0; n], DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        let body = &sim.body;
        for p in 0..body.len() {
            let x = [body.committed.x[0][p], body.committed.x[1][p]];
            let near = near(grid, x);
            for &(i, wi, gi) in &near {
                for a in 0..axes {
                    mass[axes * i + a] += wi * body.mass[p];
                }
                for &(j, wj, gj) in &near {
                    let k = block(law, gi, gj);
                    for a in 0..axes {
                        consistent[(axes * i + a, axes * j + a)] += wi * wj * body.mass[p];
                        for b in 0..axes {
                            stiffness[(axes * i + a, axes * j + b)] += body.volume[p] * k[a][b];
                        }
                    }
                }
            }
        }
        let active: Vec<usize> = (0..n).filter(|&i| mass[i] > 0.0).collect();
        let scaled = |m: DMatrix<f64>| {
            DMatrix::from_fn(active.len(), active.len(), |r, c| {
                m[(active[r], active[c])] / (mass[active[r]] * mass[active[c]]).sqrt()
            })
        };
        let share = active.iter().map(|&i| mass[i] / mass[i].max(floor));
        Operator {
            share: DVector::from_iterator(active.len(), share),
            stiffness: scaled(stiffness),
            smoothing: scaled(consistent),
        }
    }

    /// 2 / sqrt(lambda_max(M^-1 K)) (s).
    pub fn lumped_limit(&self) -> f64 {
        limit(self.stiffness.clone())
    }

    /// Largest stable step of MUSL (s), without a mass floor: the eigenvalues of A M^-1 K are those of the symmetric
    /// sqrt(A) K sqrt(A).
    pub fn musl_limit(&self) -> f64 {
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(self.smoothing.clone());
        let root =
            &eigenvectors * DMatrix::from_diagonal(&eigenvalues.map(|v| v.max(0.0).sqrt())) * eigenvectors.transpose();
        limit(&root * &self.stiffness * &root)
    }

    /// Largest stable step of USL (s), by bisection: do the powers of the step stay bounded
    /// ```text
    /// (u, dt q) -> (u + dt q - dt^2 S K u,  dt q - dt^2 A S K u),   S = M / max(M, floor)
    /// ```
    pub fn usl_limit(&self) -> f64 {
        let (mut stable, mut unstable) = (0.0, 2.0 * self.lumped_limit() / self.share.min().sqrt());
        while unstable - stable > WIDTH * unstable {
            let dt = 0.5 * (stable + unstable);
            if self.usl_is_stable(dt) { stable = dt } else { unstable = dt }
        }
        stable
    }

    fn usl_is_stable(&self, dt: f64) -> bool {
        let n = self.share.len();
        let push = DMatrix::from_diagonal(&self.share) * &self.stiffness * (dt * dt);
        let kept = &self.smoothing * &push;
        let mut step = DMatrix::identity(2 * n, 2 * n);
        for r in 0..n {
            step[(r, n + r)] = 1.0;
            for c in 0..n {
                step[(r, c)] -= push[(r, c)];
                step[(n + r, c)] = -kept[(r, c)];
            }
        }
        for _ in 0..DOUBLINGS {
            step = &step * &step;
        }
        // a rigid motion grows by 1 a step, which is no instability; an overflow is NaN, and one
        step.amax() < 10.0 * f64::from(1u32 << DOUBLINGS)
    }
}

/// Relative width to which a limit is bisected.
const WIDTH: f64 = 2e-4;

/// The step is raised to the power 2^13: a mode that grows by 0.2 % a step is then seen.
const DOUBLINGS: u32 = 13;

fn limit(symmetric: DMatrix<f64>) -> f64 {
    2.0 / symmetric.symmetric_eigenvalues().max().sqrt()
}

/// Node, weight and gradient of the nodes around a position.
pub(super) type Near = fn(&Grid, [f64; 2]) -> Vec<(usize, f64, [f64; 2])>;

/// Quadratic B-splines, as averages of hats over a cell about the position, cut to end at a side.
pub(super) fn spline(grid: &Grid, x: [f64; 2]) -> Vec<(usize, f64, [f64; 2])> {
    let line = |axis: usize| -> Vec<(usize, f64, f64)> {
        let (g, end) = ((x[axis] - grid.origin[axis]) / grid.h, f64::from(grid.cells[axis]));
        let l = g.min(end - g).min(0.5);
        // the hat and its integral from the left
        let hat = |s: f64| (1.0 - s.abs()).max(0.0);
        let integral = |s: f64| {
            let s = s.clamp(-1.0, 1.0);
            if s < 0.0 { 0.5 * (1.0 + s) * (1.0 + s) } else { 1.0 - 0.5 * (1.0 - s) * (1.0 - s) }
        };
        let of = |i: usize| {
            let (a, b) = (g - l - i as f64, g + l - i as f64);
            (i, (integral(b) - integral(a)) / (2.0 * l), (hat(b) - hat(a)) / (2.0 * l * grid.h))
        };
        (0..=grid.cells[axis] as usize).map(of).filter(|(_, w, _)| *w > 1e-12).collect()
    };
    let (columns, rows) = (line(0), line(1));
    let pair = |&(i, wx, gx): &(usize, f64, f64), &(j, wy, gy): &(usize, f64, f64)| {
        (j * grid.row() as usize + i, wx * wy, [gx * wy, wx * gy])
    };
    rows.iter().flat_map(|r| columns.iter().map(move |c| pair(c, r))).collect()
}

/// The bilinear functions of the four nodes around a position.
pub(super) fn bilinear(grid: &Grid, x: [f64; 2]) -> Vec<(usize, f64, [f64; 2])> {
    let cell = [0, 1].map(|a| ((x[a] - grid.origin[a]) / grid.h).floor());
    let xi = [0, 1].map(|a| (x[a] - grid.origin[a]) / grid.h - cell[a]);
    [[0, 0], [1, 0], [0, 1], [1, 1]]
        .map(|corner: [usize; 2]| {
            let n = [0, 1].map(|a| if corner[a] == 0 { 1.0 - xi[a] } else { xi[a] });
            let d = corner.map(|c| if c == 0 { -1.0 / grid.h } else { 1.0 / grid.h });
            let node = (cell[1] as usize + corner[1]) * grid.row() as usize + cell[0] as usize + corner[0];
            (node, n[0] * n[1], [d[0] * n[1], n[0] * d[1]])
        })
        .to_vec()
}

/// lambda g_i (x) g_j + G g_j (x) g_i + G (g_i . g_j) I.
fn block(law: Stiffness, gi: [f64; 2], gj: [f64; 2]) -> [[f64; 2]; 2] {
    let dot = gi[0] * gj[0] + gi[1] * gj[1];
    [0, 1].map(|a| {
        [0, 1].map(|b| law.lambda * gi[a] * gj[b] + law.shear * (gi[b] * gj[a] + if a == b { dot } else { 0.0 }))
    })
}
