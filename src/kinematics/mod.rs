//! Strain measures: from the displacement gradient of a step to the trial elastic strain, from
//! the law's stress to the stress on the soil, and the derivatives of both.

mod hencky;
mod rate;
mod small;

pub use hencky::Hencky;
pub use rate::Rate;
pub use small::Small;

use nalgebra::SMatrix;

use crate::math::tensor::{Gradient, Voigt};

/// Trial of one step at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// Trial elastic strain.
    pub strain: Voigt,
    /// det F of the step.
    pub jacobian: f64,
    /// Whether the fast form holds; if not, ask [`Kinematics::trial_exact`].
    pub inside: bool,
}

/// The stress that a strength is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrengthMeasure {
    /// q(sigma) <= k c.
    Cauchy,
    /// q(tau) <= k c.
    Kirchhoff,
}

/// d strain / d l: rows xx, yy, zz and the engineering shear 2 xy, columns l_xx, l_xy, l_yx, l_yy.
pub type StrainRate = SMatrix<f64, 4, 4>;

/// A strain measure. Derivatives are by l = d(grad du) F^-1, F = I + grad du, the gradient of a
/// further motion by the position after the step; in small strain F = I.
pub trait Kinematics: Copy + Send + Sync + 'static {
    const NAME: &'static str;

    /// Whether the step deforms what gradients are taken by: F = I + grad du, or I.
    const FINITE: bool = true;

    /// Trial elastic strain, without branches or library calls.
    fn trial(strain: Voigt, du: Gradient) -> Trial;

    /// Trial elastic strain for steps and strains of any size.
    fn trial_exact(strain: Voigt, du: Gradient) -> Trial {
        Self::trial(strain, du)
    }

    /// d trial strain / d l, at the trial strain `trial` that `du` gives.
    fn strain_rate(strain: Voigt, trial: Voigt, du: Gradient) -> StrainRate;

    /// Cauchy stress over the law's stress, at J.
    fn cauchy_factor(jacobian: f64) -> f64;

    /// d(J x cauchy factor) / d ln J.
    fn kirchhoff_slope(jacobian: f64) -> f64;

    /// Factor on the strength that the law sees, at J.
    fn strength_factor(measure: StrengthMeasure, jacobian: f64) -> f64;

    /// d(strength factor) / d ln J.
    fn strength_slope(measure: StrengthMeasure, jacobian: f64) -> f64;

    /// Volume to which an energy density of the law refers, over the initial volume.
    fn energy_volume(jacobian: f64) -> f64;

    /// Dilatation of a step: its part of the in-plane trace of the trial strain.
    fn dilatation(du: Gradient) -> f64;

    /// The step `du` with its dilatation changed by `by`.
    fn dilate(du: Gradient, by: f64) -> Gradient;
}

/// F = I + grad du, or I where the strain measure is not finite.
#[inline(always)]
pub fn deformation<K: Kinematics>(du: Gradient) -> Gradient {
    if K::FINITE {
        Gradient { xx: 1.0 + du.xx, yy: 1.0 + du.yy, ..du }
    } else {
        Gradient { xx: 1.0, xy: 0.0, yx: 0.0, yy: 1.0 }
    }
}

/// exp(by / 2) (I + du) - I: the step with its volume changed by the factor exp(by).
#[inline(always)]
fn swell(du: Gradient, by: f64) -> Gradient {
    let s = (0.5 * by).exp();
    Gradient { xx: s * (1.0 + du.xx) - 1.0, xy: s * du.xy, yx: s * du.yx, yy: s * (1.0 + du.yy) - 1.0 }
}

/// det(I + du) - 1.
#[inline(always)]
fn volume_change(du: Gradient) -> f64 {
    du.xx + du.yy + (du.xx * du.yy - du.xy * du.yx)
}

#[cfg(test)]
mod tests;
