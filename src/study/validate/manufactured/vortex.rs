//! A ring that is turned and turned back, most in its middle (after Kamojjala, Brannon, Sadeghirad & Guilkey 2015).
//!
//! The point at radius R goes round the origin by the angle
//! ```text
//! a(R, t) = G h(R) sin(pi t),   h = (1 - 16 s^2)^2,  s = R - 1,   3/4 < R < 5/4;  h = 0 elsewhere
//! ```
//! In the basis that turns with it F = 1 + g e_2 e_1, g = R a'. With m = asinh(g / 2) the stretches are exp(m) and
//! exp(-m), J = 1, and Hencky's stress is
//! ```text
//! s_rr = -s_tt = -2 mu m tanh(m),   s_rt = 2 mu m / cosh(m)
//! rho b_r = -rho R (da/dt)^2 - s_rr' - 2 s_rr / R
//! rho b_t =  rho R d2a/dt2   - s_rt' - 2 s_rt / R
//! ```
//! h' = 0 on both edges of the ring: they are free of stress, and the soil beside them stays at rest.

use std::f64::consts::PI;

use super::motion::{Elastic, Motion};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vortex {
    /// G (rad).
    pub turn: f64,
    pub elastic: Elastic,
}

/// h with its first two derivatives.
fn profile(radius: f64) -> [f64; 3] {
    let s = radius - 1.0;
    if s.abs() >= 0.25 {
        return [0.0; 3];
    }
    [(1.0 - 16.0 * s * s).powi(2), -64.0 * s * (1.0 - 16.0 * s * s), -64.0 + 3072.0 * s * s]
}

impl Motion for Vortex {
    fn place(&self, start: [f64; 2], time: f64) -> [f64; 2] {
        let angle = self.turn * profile(start[0].hypot(start[1]))[0] * (PI * time).sin();
        let (sin, cos) = angle.sin_cos();
        [cos * start[0] - sin * start[1], sin * start[0] + cos * start[1]]
    }

    fn velocity(&self, start: [f64; 2], time: f64) -> [f64; 2] {
        let rate = self.turn * profile(start[0].hypot(start[1]))[0] * PI * (PI * time).cos();
        let [x, y] = self.place(start, time);
        [-rate * y, rate * x]
    }

    /// h and R cannot be largest at once: no more than at the outer edge with h = 1.
    fn fastest(&self) -> f64 {
        1.25 * PI * self.turn
    }

    fn body_force(&self, start: [f64; 2], time: f64) -> [f64; 2] {
        let radius = start[0].hypot(start[1]);
        let [h, slope, curvature] = profile(radius);
        let (sin, cos) = (PI * time).sin_cos();
        let Elastic { mu, density, .. } = self.elastic;
        let (shear, growth) = (radius * self.turn * sin * slope, self.turn * sin * (slope + radius * curvature));
        let m = (0.5 * shear).asinh();
        let (tanh, cosh, rate) = (m.tanh(), m.cosh(), 0.5 * growth / m.cosh());
        let (rr, rt) = (-2.0 * mu * m * tanh, 2.0 * mu * m / cosh);
        let rr_slope = -2.0 * mu * rate * (tanh + m / (cosh * cosh));
        let rt_slope = 2.0 * mu * rate * (1.0 - m * tanh) / cosh;
        let spin = self.turn * h * PI * cos;
        let along = -radius * spin * spin - (rr_slope + 2.0 * rr / radius) / density;
        let across = -radius * self.turn * h * PI * PI * sin - (rt_slope + 2.0 * rt / radius) / density;
        let [x, y] = self.place(start, time).map(|x| x / radius);
        [along * x - across * y, along * y + across * x]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::validate::manufactured::motion::body_force_by_differences;

    #[test]
    fn the_body_force_is_that_of_the_differences() {
        let elastic = Elastic::new(1000.0, 0.3, 1.0);
        for turn in [0.1, 1.0] {
            let motion = Vortex { turn, elastic };
            for (x, t) in [([0.9, 0.1], 0.2), ([0.5, -0.95], 0.5), ([-0.8, 0.8], 0.8), ([0.2, 0.3], 0.4)] {
                let (exact, found) = (motion.body_force(x, t), body_force_by_differences(&motion, &elastic, x, t));
                // second differences of step 1e-4: curvatures of h over its width of 0.25 m, (d / 0.25)^2 = 2e-7, a
                // dozen times over in high derivatives, and rounding of 1e-16 / 1e-8 of the modulus
                let scale = elastic.mu * turn * 64.0;
                (0..2).for_each(|i| assert!((exact[i] - found[i]).abs() < 1e-5 * scale, "{exact:?} {found:?}"));
            }
        }
    }
}
