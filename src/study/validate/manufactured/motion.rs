//! A motion that is chosen, and the force that makes it the solution.

/// An exact motion x(X, t), with X the place at the start.
pub(super) trait Motion: Copy + Send + 'static {
    /// x (m).
    fn place(&self, start: [f64; 2], time: f64) -> [f64; 2];

    /// dx / dt (m/s).
    fn velocity(&self, start: [f64; 2], time: f64) -> [f64; 2];

    /// Largest velocity of any point at any time (m/s).
    fn fastest(&self) -> f64;

    /// b = a - Div P / rho0 (m/s2), with P = tau F^-T and tau = D : ln(F F^T) / 2 (plane strain, Hencky).
    fn body_force(&self, start: [f64; 2], time: f64) -> [f64; 2];
}

/// An elastic material.
#[derive(Clone, Copy, Debug)]
pub(super) struct Elastic {
    /// Lame's constants lambda and mu (kPa).
    pub lambda: f64,
    pub mu: f64,
    /// Density at the start (t/m3).
    pub density: f64,
}

impl Elastic {
    /// From Young's modulus (kPa), Poisson's ratio and density (t/m3).
    pub fn new(young: f64, nu: f64, density: f64) -> Self {
        Elastic { lambda: young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), mu: 0.5 * young / (1.0 + nu), density }
    }

    /// Velocity of a wave in a thin bar, sqrt(E / rho) (m/s).
    pub fn bar_wave(&self) -> f64 {
        let young = self.mu * (3.0 * self.lambda + 2.0 * self.mu) / (self.lambda + self.mu);
        (young / self.density).sqrt()
    }

    /// Velocity of the fastest wave (m/s).
    pub fn wave(&self) -> f64 {
        ((self.lambda + 2.0 * self.mu) / self.density).sqrt()
    }
}

/// The body force by differences alone: of the motion for a and F, and of P(F) for Div P.
#[cfg(test)]
pub(super) fn body_force_by_differences<M: Motion>(m: &M, e: &Elastic, x: [f64; 2], t: f64) -> [f64; 2] {
    let d = 1e-4;
    let at = |dx: f64, dy: f64| [x[0] + dx, x[1] + dy];
    let (later, now, before) = (m.place(x, t + d), m.place(x, t), m.place(x, t - d));
    let (right, left) = (stress(m, e, at(d, 0.0), t), stress(m, e, at(-d, 0.0), t));
    let (up, down) = (stress(m, e, at(0.0, d), t), stress(m, e, at(0.0, -d), t));
    [0, 1].map(|i| {
        let acceleration = (later[i] - 2.0 * now[i] + before[i]) / (d * d);
        let divergence = (right[i][0] - left[i][0] + up[i][1] - down[i][1]) / (2.0 * d);
        acceleration - divergence / e.density
    })
}

/// P = tau F^-T, with F by differences and ln b from the eigenvalues of b.
#[cfg(test)]
fn stress<M: Motion>(m: &M, e: &Elastic, x: [f64; 2], t: f64) -> [[f64; 2]; 2] {
    let d = 1e-4;
    let column = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| (a[i] - b[i]) / (2.0 * d));
    let f1 = column(m.place([x[0] + d, x[1]], t), m.place([x[0] - d, x[1]], t));
    let f2 = column(m.place([x[0], x[1] + d], t), m.place([x[0], x[1] - d], t));
    let b = |i: usize, j: usize| f1[i] * f1[j] + f2[i] * f2[j];
    let (mean, half, off) = (0.5 * (b(0, 0) + b(1, 1)), 0.5 * (b(0, 0) - b(1, 1)), b(0, 1));
    let radius = half.hypot(off);
    let (l1, l2) = (0.5 * (mean + radius).ln(), 0.5 * (mean - radius).ln());
    // tau = (lambda tr e + 2 mu (l1 + l2) / 2) 1 + mu (l1 - l2) (deviator of b over its radius)
    let (sum, difference) = ((e.lambda + e.mu) * (l1 + l2), e.mu * (l1 - l2));
    let (c, s) = if radius > 0.0 { (half / radius, off / radius) } else { (0.0, 0.0) };
    let tau = [[sum + difference * c, difference * s], [difference * s, sum - difference * c]];
    let det = f1[0] * f2[1] - f2[0] * f1[1];
    // rows of F^-1
    let inverse = [[f2[1] / det, -f2[0] / det], [-f1[1] / det, f1[0] / det]];
    let entry = |i: usize, j: usize| tau[i][0] * inverse[j][0] + tau[i][1] * inverse[j][1];
    [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
}
