//! How far inertia prevails in the equations of a step, and whether conjugate gradients pay.

use crate::math::sparse::{Pattern, offset_bit};

/// Iterations to 1e-10 are about this over the root of the share of inertia: 5, 7, 14 and 26 for Courant numbers of 1,
/// 2, 5 and 10 on slabs of 1,800 to 129,600 cells, where the shares are 0.70, 0.38, 0.094 and 0.031.
const ITERATIONS: f64 = 4.3;
/// Unknowns of a large system, and the most expected iterations that pay in a small and in a large one: equal in time
/// with L L^T are 11 with 1,800 cells, 18 with 8,100 and 25 from 32,400 on.
const LARGE: usize = 20_000;
const PAY: [f64; 2] = [8.0, 16.0];

/// Most iterations of conjugate gradients that are worth a try on this symmetric system, or `None` if L L^T is expected
/// to be cheaper. The choice depends on the system alone.
pub(super) fn iterations(pattern: &Pattern, values: &[f64]) -> Option<usize> {
    let pay = PAY[usize::from(pattern.dim() >= LARGE)];
    let expected = ITERATIONS / share(pattern, values).sqrt();
    // twice what is expected, as the share is a mean
    (expected <= pay).then_some(2 * pay as usize)
}

/// Nodes that are looked at, spread over all.
const LOOKED_AT: usize = 256;

/// Mean over free unknowns of the sum of a column, over the unknowns of the same axis, in parts of its diagonal:
/// forces of a translation, which strains nothing, are those of inertia. 0 if nothing is free.
fn share(pattern: &Pattern, values: &[f64]) -> f64 {
    let (mut sum, mut free) = (0.0, 0.0);
    for j in (0..pattern.nodes()).step_by((pattern.nodes() / LOOKED_AT).max(1)) {
        let (stride, own) = (pattern.stride(j), pattern.block(j, offset_bit(0, 0)));
        for axis in 0..2 {
            let start = pattern.col_ptr()[2 * j + axis] as usize;
            let column = &values[start..start + stride];
            let total: f64 = column.iter().skip(axis).step_by(2).sum();
            let diagonal = values[own + axis * (stride + 1)];
            // what is held has nothing but its diagonal
            if total != diagonal {
                sum += total / diagonal;
                free += 1.0;
            }
        }
    }
    if free > 0.0 { (sum / free).max(0.0) } else { 0.0 }
}
