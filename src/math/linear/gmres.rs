//! Restarted GMRES (Saad & Schultz 1986) with a preconditioner on the right (flexible, Saad 1993).

use super::vector::{add_multiple, dot, norm};

/// Directions kept before a restart.
const RESTART: usize = 20;
/// Iterations after which the observed rate must promise success within [`MOST`].
const LOOK: usize = 6;
/// Most iterations: about the cost of an LU factorisation instead.
const MOST: usize = 30;

/// Buffers of the iteration, kept between solves.
#[derive(Default)]
pub(super) struct Gmres {
    /// Orthonormal directions v_k, and z_k = M^-1 v_k.
    basis: Vec<Vec<f64>>,
    images: Vec<Vec<f64>>,
    work: Vec<f64>,
    /// Columns of the triangular factor, the rotations, and the rotated right side.
    columns: Vec<[f64; RESTART + 1]>,
    rotations: Vec<[f64; 2]>,
    right: Vec<f64>,
}

/// How an iteration ended.
pub(super) struct Ended {
    pub converged: bool,
    pub iterations: u32,
}

impl Gmres {
    /// Solves A x = b from x = 0 up to |b - A x| <= `tolerance` |b|. `multiply(x, y)` sets y = A x,
    /// `precondition(x)` overwrites x with M^-1 x.
    pub fn solve(
        &mut self,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
        mut multiply: impl FnMut(&[f64], &mut [f64]),
        mut precondition: impl FnMut(&mut [f64]),
    ) -> Ended {
        self.resize(b.len());
        x.fill(0.0);
        let goal = tolerance * norm(b);
        self.work.copy_from_slice(b);
        let first = norm(b);
        let (mut size, mut iterations) = (first, 0);
        while size > goal && iterations < MOST {
            self.start(size);
            let mut k = 0;
            while k < RESTART && size > goal && iterations < MOST {
                size = self.extend(k, &mut multiply, &mut precondition);
                k += 1;
                iterations += 1;
                if !size.is_finite() || hopeless(size / first, tolerance, iterations) {
                    return Ended { converged: false, iterations: iterations as u32 };
                }
            }
            self.advance(k, x);
            multiply(x, &mut self.work);
            self.work.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
            size = norm(&self.work);
        }
        Ended { converged: size <= goal, iterations: iterations as u32 }
    }

    fn resize(&mut self, n: usize) {
        self.basis.resize(RESTART + 1, Vec::new());
        self.images.resize(RESTART, Vec::new());
        self.basis.iter_mut().chain(&mut self.images).for_each(|v| v.resize(n, 0.0));
        self.work.resize(n, 0.0);
    }

    /// The first direction is the residual, in `work`, whose size is `size`.
    fn start(&mut self, size: f64) {
        self.columns.clear();
        self.rotations.clear();
        self.right.clear();
        self.right.push(size);
        for (v, r) in self.basis[0].iter_mut().zip(&self.work) {
            *v = r / size;
        }
    }

    /// One Arnoldi step; returns the size of the residual it leads to.
    fn extend(
        &mut self,
        k: usize,
        multiply: &mut impl FnMut(&[f64], &mut [f64]),
        precondition: &mut impl FnMut(&mut [f64]),
    ) -> f64 {
        self.images[k].copy_from_slice(&self.basis[k]);
        precondition(&mut self.images[k]);
        multiply(&self.images[k], &mut self.work);
        let mut column = [0.0; RESTART + 1];
        for (h, v) in column.iter_mut().zip(&self.basis[..=k]) {
            *h = dot(&self.work, v);
            add_multiple(&mut self.work, -*h, v);
        }
        let length = norm(&self.work);
        // without a remainder the space holds the solution, and the next direction is not used
        let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
        for (v, w) in self.basis[k + 1].iter_mut().zip(&self.work) {
            *v = w * scale;
        }
        self.rotate(k, column, length)
    }

    /// Givens rotations make the new column triangular.
    fn rotate(&mut self, k: usize, mut column: [f64; RESTART + 1], length: f64) -> f64 {
        for (i, &[c, s]) in self.rotations.iter().enumerate() {
            (column[i], column[i + 1]) = (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let radius = column[k].hypot(length);
        let [c, s] = [column[k] / radius, length / radius];
        column[k] = radius;
        self.rotations.push([c, s]);
        self.columns.push(column);
        let last = self.right[k];
        self.right[k] = c * last;
        self.right.push(-s * last);
        (s * last).abs()
    }

    /// x += Z y with the y of least residual in the first `k` directions.
    fn advance(&mut self, k: usize, x: &mut [f64]) {
        for i in (0..k).rev() {
            let known: f64 = (i + 1..k).map(|j| self.columns[j][i] * self.right[j]).sum();
            self.right[i] = (self.right[i] - known) / self.columns[i][i];
        }
        for (z, &y) in self.images[..k].iter().zip(&self.right) {
            add_multiple(x, y, z);
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        8 * self.basis.iter().chain(&self.images).chain([&self.work]).map(Vec::capacity).sum::<usize>()
    }
}

/// Whether the mean rate so far does not reach the tolerance in the iterations that are left.
fn hopeless(reached: f64, tolerance: f64, iterations: usize) -> bool {
    iterations >= LOOK && reached.ln() * MOST as f64 > tolerance.ln() * iterations as f64
}
