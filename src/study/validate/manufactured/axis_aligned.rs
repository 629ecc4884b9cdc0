//! A square that is stretched and squeezed along its sides.
//!
//! ```text
//! u_i = A sin(pi X_i) sin(w t + phi_i),   w = pi sqrt(E / rho),   phi = (0, pi)
//! ```
//! F is diagonal with the stretches l_i = 1 + A pi cos(pi X_i) s_i, s_i = sin(w t + phi_i). With
//! tau_i = (L + 2 mu) ln l_i + L ln l_j and P_i = tau_i / l_i only l_i depends on X_i, so that
//! ```text
//! (Div P)_i = l_i' (L + 2 mu - tau_i) / l_i^2,   l_i' = -A pi^2 sin(pi X_i) s_i
//! ```
//! On the sides of the unit square the motion across them is zero and so is the shear stress: rollers.

use std::f64::consts::PI;

use super::motion::{Elastic, Motion};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisAligned {
    /// A (m).
    pub amplitude: f64,
    /// w (rad/s).
    pub frequency: f64,
    pub elastic: Elastic,
}

impl AxisAligned {
    fn phase(&self, axis: usize, time: f64) -> f64 {
        self.frequency * time + PI * axis as f64
    }

    fn stretch(&self, start: [f64; 2], time: f64, axis: usize) -> f64 {
        1.0 + self.amplitude * PI * (PI * start[axis]).cos() * self.phase(axis, time).sin()
    }
}

impl Motion for AxisAligned {
    fn place(&self, start: [f64; 2], time: f64) -> [f64; 2] {
        [0, 1].map(|i| start[i] + self.amplitude * (PI * start[i]).sin() * self.phase(i, time).sin())
    }

    fn velocity(&self, start: [f64; 2], time: f64) -> [f64; 2] {
        [0, 1].map(|i| self.amplitude * self.frequency * (PI * start[i]).sin() * self.phase(i, time).cos())
    }

    fn fastest(&self) -> f64 {
        self.amplitude * self.frequency
    }

    fn body_force(&self, start: [f64; 2], time: f64) -> [f64; 2] {
        let Elastic { lambda, mu, density } = self.elastic;
        let stretch = [0, 1].map(|i| self.stretch(start, time, i));
        [0, 1].map(|i| {
            let u = self.amplitude * (PI * start[i]).sin() * self.phase(i, time).sin();
            let tau = (lambda + 2.0 * mu) * stretch[i].ln() + lambda * stretch[1 - i].ln();
            let divergence = -PI * PI * u * (lambda + 2.0 * mu - tau) / (stretch[i] * stretch[i]);
            -self.frequency * self.frequency * u - divergence / density
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::validate::manufactured::motion::body_force_by_differences;

    #[test]
    fn the_body_force_is_that_of_the_differences() {
        let elastic = Elastic::new(1e4, 0.3, 1.0);
        let motion = AxisAligned { amplitude: 0.05, frequency: 100.0 * PI, elastic };
        let scale = motion.amplitude * motion.frequency.powi(2);
        for (x, t) in [([0.2, 0.7], 0.003), ([0.4, 0.1], 0.011), ([0.9, 0.55], 0.0175)] {
            let (exact, found) = (motion.body_force(x, t), body_force_by_differences(&motion, &elastic, x, t));
            // second differences of step 1e-4 in time: (w d)^2 / 12 = 8e-5 of the acceleration
            (0..2).for_each(|i| assert!((exact[i] - found[i]).abs() < 2e-4 * scale, "{exact:?} {found:?}"));
        }
    }
}
