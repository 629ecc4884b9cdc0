//! Conjugate gradients (Hestenes & Stiefel 1952) with a preconditioner, for symmetric positive definite systems.

use super::vector::{add_multiple, dot, norm};

/// Iterations after which the mean rate must promise success within the most that are allowed.
const LOOK: usize = 6;

/// Buffers of the iteration, kept between solves.
#[derive(Default)]
pub(super) struct Gradients {
    residual: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    scaled: Vec<f64>,
}

/// How an iteration ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ended {
    pub converged: bool,
    pub iterations: u32,
}

impl Gradients {
    /// Solves A x = b from x = 0 up to |b - A x| <= `tolerance` |b| in at most `most` iterations. `multiply(x, y)` sets
    /// y = A x, `precondition(x)` overwrites x with M^-1 x.
    pub fn solve(
        &mut self,
        b: &[f64],
        x: &mut [f64],
        (tolerance, most): (f64, usize),
        mut multiply: impl FnMut(&[f64], &mut [f64]),
        precondition: impl Fn(&mut [f64]),
    ) -> Ended {
        let Gradients { residual: r, direction: p, image, scaled: z } = self;
        [&mut *r, &mut *p, &mut *z].into_iter().for_each(|v| refill(v, b));
        image.resize(b.len(), 0.0);
        x.fill(0.0);
        precondition(z);
        p.copy_from_slice(z);
        let (first, mut rz) = (norm(b), dot(r, z));
        let mut ended = Ended { converged: false, iterations: 0 };
        while (ended.iterations as usize) < most {
            multiply(p, image);
            let curvature = dot(p, image);
            if curvature.is_nan() || curvature <= 0.0 {
                // the matrix is not positive definite
                return ended;
            }
            let step = rz / curvature;
            add_multiple(x, step, p);
            add_multiple(r, -step, image);
            ended.iterations += 1;
            let reached = norm(r) / first;
            if reached <= tolerance {
                return Ended { converged: true, ..ended };
            }
            if reached.is_nan() || hopeless(reached, tolerance, ended.iterations as usize, most) {
                return ended;
            }
            z.copy_from_slice(r);
            precondition(z);
            let next = dot(r, z);
            let share = next / rz;
            rz = next;
            p.iter_mut().zip(&*z).for_each(|(p, z)| *p = z + share * *p);
        }
        ended
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let buffers = [&self.residual, &self.direction, &self.image, &self.scaled];
        8 * buffers.map(Vec::capacity).iter().sum::<usize>()
    }
}

fn refill(to: &mut Vec<f64>, from: &[f64]) {
    to.clear();
    to.extend_from_slice(from);
}

/// Whether the mean rate so far does not reach the tolerance in the iterations that are allowed.
fn hopeless(reached: f64, tolerance: f64, iterations: usize, most: usize) -> bool {
    iterations >= LOOK && reached.ln() * most as f64 > tolerance.ln() * iterations as f64
}
