//! Integrals of a radial correlation over rectangles, to rounding.
//!
//! Gauss rules on boxes in scaled lags (x / theta_x, z / theta_z). A box is halved while it is large
//! against 1 or, where the correlation has a cusp at lag 0, against its distance from there; and
//! while the circle on which the spherical correlation ends goes through it. So the error is that of a
//! Gauss rule on an analytic function, below 1e-13; of the spherical family below 1e-9, since its
//! second derivative jumps on that circle.

use super::correlation::Family;

/// Abscissae on (0, 1) and weights of sum 1 of Gauss-Legendre rules.
const FOUR: [(f64, f64); 4] =
    symmetric([0.861_136_311_594_052_6, 0.339_981_043_584_856_3], [0.347_854_845_137_453_85, 0.652_145_154_862_546_1]);
const SIX: [(f64, f64); 6] = symmetric(
    [0.932_469_514_203_152, 0.661_209_386_466_264_5, 0.238_619_186_083_196_9],
    [0.171_324_492_379_170_35, 0.360_761_573_048_138_6, 0.467_913_934_572_691_04],
);

/// Largest scaled width of a box for six points an axis, and for four.
const WIDTHS: [f64; 2] = [0.25, 0.05];
/// The same against the distance from a cusp.
const RATIOS: [f64; 2] = [0.5, 0.1];
/// Width below which a box at the cusp is taken as it is: the error is about its cube.
const CUSP: f64 = 1e-5;
/// Width of the boxes on the circle where the spherical correlation ends.
const RIM: f64 = 1e-3;

const fn symmetric<const H: usize, const N: usize>(x: [f64; H], w: [f64; H]) -> [(f64, f64); N] {
    let mut rule = [(0.0, 0.0); N];
    let mut i = 0;
    while i < H {
        rule[i] = (0.5 - 0.5 * x[i], 0.5 * w[i]);
        rule[N - 1 - i] = (0.5 + 0.5 * x[i], 0.5 * w[i]);
        i += 1;
    }
    rule
}

/// A rectangle of lags, in lags of the unit cell it is a part of.
#[derive(Clone, Copy)]
struct Box {
    low: [f64; 2],
    width: [f64; 2],
}

/// Integrals over unit cells of lags.
pub(super) struct Quadrature {
    family: Family,
    /// Cell over theta, along both axes.
    scale: [f64; 2],
}

impl Quadrature {
    /// `scale` is the cell over theta, along both axes.
    pub fn new(family: Family, scale: [f64; 2]) -> Self {
        Quadrature { family, scale }
    }

    /// Integrals of rho times (1-s)(1-t), s(1-t), (1-s)t, st over the cell of lags [i, i+1] x [j, j+1],
    /// s and t being the places in it.
    pub fn moments(&self, i: usize, j: usize) -> [f64; 4] {
        let mut sum = [0.0; 4];
        self.add([i as f64, j as f64], Box { low: [0.0; 2], width: [1.0; 2] }, &mut sum);
        sum
    }

    fn add(&self, cell: [f64; 2], part: Box, sum: &mut [f64; 4]) {
        let near = [0, 1].map(|k| (cell[k] + part.low[k]) * self.scale[k]);
        let size = [0, 1].map(|k| part.width[k] * self.scale[k]);
        let distance = near[0].hypot(near[1]);
        let far = (near[0] + size[0]).hypot(near[1] + size[1]);
        let width = size[0].max(size[1]);
        if distance >= self.family.reach() {
            return;
        }
        if self.is_too_large(distance, far, width) {
            for half in part.halves(usize::from(size[1] > size[0])) {
                self.add(cell, half, sum);
            }
        } else if width <= WIDTHS[1] && (self.family.is_smooth() || width <= RATIOS[1] * distance) {
            self.gauss(&FOUR, cell, part, sum);
        } else {
            self.gauss(&SIX, cell, part, sum);
        }
    }

    fn is_too_large(&self, distance: f64, far: f64, width: f64) -> bool {
        let at_cusp = !self.family.is_smooth() && width > RATIOS[0] * distance && width > CUSP;
        let on_rim = self.family == Family::Spherical && far > self.family.reach() && width > RIM;
        width > WIDTHS[0] || at_cusp || on_rim
    }

    fn gauss(&self, rule: &[(f64, f64)], cell: [f64; 2], part: Box, sum: &mut [f64; 4]) {
        for &(z, wz) in rule {
            let t = part.low[1] + part.width[1] * z;
            let lag = (cell[1] + t) * self.scale[1];
            for &(x, wx) in rule {
                let s = part.low[0] + part.width[0] * x;
                let r2 = ((cell[0] + s) * self.scale[0]).powi(2) + lag * lag;
                let value = self.family.radial(r2.sqrt()) * wx * wz * part.width[0] * part.width[1];
                sum[0] += value * (1.0 - s) * (1.0 - t);
                sum[1] += value * s * (1.0 - t);
                sum[2] += value * (1.0 - s) * t;
                sum[3] += value * s * t;
            }
        }
    }
}

impl Box {
    fn halves(self, axis: usize) -> [Box; 2] {
        let (mut a, mut b) = (self, self);
        a.width[axis] *= 0.5;
        b.width[axis] *= 0.5;
        b.low[axis] += b.width[axis];
        [a, b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// n points integrate polynomials of degree 2 n - 1.
    #[test]
    fn rules_are_those_of_gauss() {
        let check = |rule: &[(f64, f64)]| {
            for power in 0..2 * rule.len() as i32 {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(power)).sum();
                assert!((sum * f64::from(power + 1) - 1.0).abs() < 1e-14, "{} points, x^{power}", rule.len());
            }
        };
        check(&FOUR);
        check(&SIX);
    }
}
