//! Correlation of a random field between two points.

/// Shape of the correlation. r^2 = (x / theta_x)^2 + (z / theta_z)^2 is the scaled distance.
///
/// Each is normalised so that theta is Vanmarcke's scale of fluctuation along its axis: the integral of
/// the correlation over all lags on that axis, both signs, is theta.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// exp(-2 r): contours are ellipses.
    Markov,
    /// exp(-2 |x| / theta_x) exp(-2 |z| / theta_z).
    MarkovSeparable,
    /// exp(-pi r^2).
    Gaussian,
    /// 1 - 3/2 h + 1/2 h^3 with h = 3/4 r, 0 from h = 1 on: its integral over a line is 3/4 of its range.
    Spherical,
}

/// A family with its scales of fluctuation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correlation {
    pub family: Family,
    /// Scales of fluctuation (m) along x and along the vertical; may be infinite.
    pub theta: [f64; 2],
}

impl Correlation {
    /// Correlation of two points, `lag` (m) apart along x and the vertical.
    pub fn at(&self, lag: [f64; 2]) -> f64 {
        let [x, z] = [0, 1].map(|k| (lag[k] / self.theta[k]).abs());
        match self.family {
            Family::MarkovSeparable => (-2.0 * (x + z)).exp(),
            radial => radial.radial(x.hypot(z)),
        }
    }
}

impl Family {
    /// Correlation at the scaled distance `r`; of the separable family that along an axis.
    pub(super) fn radial(self, r: f64) -> f64 {
        match self {
            Family::Markov | Family::MarkovSeparable => (-2.0 * r).exp(),
            Family::Gaussian => (-std::f64::consts::PI * r * r).exp(),
            Family::Spherical => {
                let h = (0.75 * r).min(1.0);
                1.0 - h * (1.5 - 0.5 * h * h)
            }
        }
    }

    /// Scaled distance from which on the correlation is below 1e-17.
    pub(super) fn reach(self) -> f64 {
        match self {
            Family::Markov | Family::MarkovSeparable => 20.0,
            Family::Gaussian => 3.6,
            Family::Spherical => 4.0 / 3.0,
        }
    }

    /// Whether all derivatives exist at distance 0.
    pub(super) fn is_smooth(self) -> bool {
        self == Family::Gaussian
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub const ALL: [Family; 4] = [Family::Markov, Family::MarkovSeparable, Family::Gaussian, Family::Spherical];

    /// Midpoint rule in the scaled distance: error h^2 f'(0) / 12 = 4e-8 with h = 5e-4.
    #[test]
    fn theta_is_the_integral_of_the_correlation() {
        for family in ALL {
            for (axis, theta) in [(0, 3.0), (1, 0.5)] {
                let c = Correlation { family, theta: [3.0, 0.5] };
                let h = 5e-4 * theta;
                let sum: f64 = (0..40_000)
                    .map(|i| {
                        let mut lag = [0.0; 2];
                        lag[axis] = -(i as f64 + 0.5) * h;
                        c.at(lag)
                    })
                    .sum();
                assert!((2.0 * h * sum / theta - 1.0).abs() < 1e-7, "{family:?} axis {axis}");
            }
        }
    }

    #[test]
    fn an_infinite_scale_leaves_the_other_axis() {
        for family in ALL {
            let c = Correlation { family, theta: [f64::INFINITY, 2.0] };
            let one = Correlation { family, theta: [1.0, 2.0] };
            assert_eq!(c.at([1e6, 0.7]), one.at([0.0, 0.7]));
            assert_eq!(c.at([5.0, 0.0]), 1.0);
        }
    }
}
