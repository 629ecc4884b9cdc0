//! The domains of the points: rectangles along the axes that follow the stretch of the soil.
//!
//! ```text
//! lp_i = lp0 U_ii,   lp0 = 1/2 sqrt(V0),   U = (C + J I) / sqrt(tr C + 2 J),   C = F^T F
//! ```
//! U is the right stretch of the total deformation gradient F: it does not see the rotation, and a
//! sheared domain keeps its size, unlike with F_ii (Coombs, Augarde, Brennan, Brown, Charlton,
//! Knappett, Ghaffari Motlagh & Wang 2020, "On Lagrangian mechanics and the implicit material point
//! method for large deformation elasto-plasticity", eq. 41). Its closed form in the plane follows
//! from the Cayley-Hamilton theorem. A point starts as the square of its volume, which for n x n
//! evenly spaced points a cell has sides of h / n.

use std::ops::Range;

use crate::{
    body::{Body, chunks, load, store},
    space::stencil::{LANES, Lane},
};

/// Half-lengths (m) along x and y of the domains of a block of the committed body.
#[inline(always)]
pub fn half_lengths(body: &Body, range: &Range<usize>) -> [Lane; 2] {
    let mut volume = [1.0; LANES];
    load(&mut volume, &body.volume, range);
    let f = deformation(body, range);
    let mut half = [[0.0; LANES]; 2];
    for i in 0..LANES {
        let stretch = stretch([f[0][i], f[1][i], f[2][i], f[3][i]]);
        let start = 0.5 * volume[i].sqrt();
        half[0][i] = start * stretch[0];
        half[1][i] = start * stretch[1];
    }
    half
}

/// F of a block after a step, (I + grad du) F; `du` is xx, xy, yx, yy.
#[inline(always)]
pub fn deformed(body: &Body, du: &[Lane; 4], range: &Range<usize>) -> [Lane; 4] {
    let f = deformation(body, range);
    let mut new = f;
    for i in 0..LANES {
        for row in 0..2 {
            let (a, b) = (du[2 * row][i], du[2 * row + 1][i]);
            new[2 * row][i] += a * f[0][i] + b * f[2][i];
            new[2 * row + 1][i] += a * f[1][i] + b * f[3][i];
        }
    }
    new
}

/// Deforms the domains of a block by a step; the trial state gets them.
#[inline(always)]
pub fn deform(body: &mut Body, du: &[Lane; 4], range: &Range<usize>) {
    let new = deformed(body, du, range);
    for (lane, column) in new.iter().zip(&mut body.trial.deformation) {
        store(lane, column, range);
    }
}

/// Points of the committed body with a domain of a half-length above `longest` (m).
pub fn longer_than(body: &Body, longest: f64) -> u64 {
    let over = |range: Range<usize>| {
        let [x, y] = half_lengths(body, &range);
        (0..range.len()).filter(|&i| (x[i] > longest) | (y[i] > longest)).count() as u64
    };
    chunks(0..body.len()).map(over).sum()
}

/// Committed F of a block, the identity in lanes past it.
#[inline(always)]
fn deformation(body: &Body, range: &Range<usize>) -> [Lane; 4] {
    let mut f = [[1.0; LANES], [0.0; LANES], [0.0; LANES], [1.0; LANES]];
    for (lane, column) in f.iter_mut().zip(&body.committed.deformation) {
        load(lane, column, range);
    }
    f
}

/// U_xx and U_yy of F = [xx, xy, yx, yy].
#[inline(always)]
fn stretch([xx, xy, yx, yy]: [f64; 4]) -> [f64; 2] {
    let (cxx, cyy) = (xx * xx + yx * yx, xy * xy + yy * yy);
    let j = xx * yy - xy * yx;
    let inverse = 1.0 / (cxx + cyy + 2.0 * j).sqrt();
    [(cxx + j) * inverse, (cyy + j) * inverse]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2], a[2] * b[1] + a[3] * b[3]]
    }

    #[test]
    fn stretch_is_u_of_f_whatever_the_rotation() {
        let u = [1.7, 0.3, 0.3, 0.6];
        for angle in [0.0, 0.4, 2.0, 3.1] {
            let (s, c) = f64::sin_cos(angle);
            let [a, b] = stretch(times([c, -s, s, c], u));
            assert!((a - 1.7).abs() < 1e-14 && (b - 0.6).abs() < 1e-14, "{a} {b}");
        }
    }

    #[test]
    fn a_body_starts_as_squares_and_follows_its_steps() {
        let mut body = crate::body::tests::points(3);
        assert_eq!(half_lengths(&body, &(0..3))[0][2], 0.25);
        let mut du = [[0.0; LANES]; 4];
        du[0] = [0.2; LANES];
        du[1] = [0.1; LANES];
        for _ in 0..2 {
            deform(&mut body, &du, &(0..3));
            body.commit();
        }
        // [1.2, 0.1; 0, 1] squared
        let f: Vec<f64> = body.committed.deformation.iter().map(|c| c[1]).collect();
        assert!(f.iter().zip([1.44, 0.22, 0.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-15), "{f:?}");
        assert_eq!(longer_than(&body, 0.3), 3);
        assert_eq!(longer_than(&body, 0.4), 0);
    }
}
