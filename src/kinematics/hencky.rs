//! Logarithmic strain.

use super::{Kinematics, StrainRate, StrengthMeasure, Trial, swell, volume_change};
use crate::math::tensor::{Gradient, Voigt, log_strain_exact, log_strain_series};

/// Logarithmic elastic strain, updated Lagrangian: eps_tr = 1/2 ln(dF exp(2 eps) dF^T). The law
/// gives the Kirchhoff stress; sigma = tau / J.
#[derive(Clone, Copy, Debug)]
pub struct Hencky;

impl Kinematics for Hencky {
    const NAME: &'static str = "hencky";

    #[inline(always)]
    fn trial(strain: Voigt, du: Gradient) -> Trial {
        let s = log_strain_series(strain, du);
        Trial { strain: s.strain, jacobian: s.jacobian, inside: s.inside }
    }

    fn trial_exact(strain: Voigt, du: Gradient) -> Trial {
        let s = log_strain_exact(strain, du);
        Trial { strain: s.strain, jacobian: s.jacobian, inside: true }
    }

    #[inline(always)]
    fn cauchy_factor(jacobian: f64) -> f64 {
        1.0 / jacobian
    }

    #[inline(always)]
    fn strength_factor(measure: StrengthMeasure, jacobian: f64) -> f64 {
        match measure {
            StrengthMeasure::Cauchy => jacobian,
            StrengthMeasure::Kirchhoff => 1.0,
        }
    }

    #[inline(always)]
    fn energy_volume(_: f64) -> f64 {
        1.0
    }

    /// With E = in-plane deviator of the trial strain, D and w the deviator and the spin of l, and
    /// E' = E turned by a quarter (in the plane of (xx - yy) / 2 and xy),
    /// ```text
    /// d e = 1/2 tr l I + D + (e coth e - 1) / |E|^2 E' (E' . D) + 2 w E',   e = 2 |E|
    /// ```
    /// the derivative of 1/2 ln b along db = l b + b l^T in principal axes; there is no division by
    /// a difference of stretches.
    #[inline(always)]
    #[rustfmt::skip]
    fn strain_rate(_: Voigt, trial: Voigt, _: Gradient) -> StrainRate {
        let (e1, e2) = (0.5 * (trial.xx - trial.yy), trial.xy);
        let (p1, p2) = (-e2, e1);
        let g = turning(e1 * e1 + e2 * e2);
        // dE = T D + 2 w E'
        let (t11, t12, t22) = (1.0 + g * p1 * p1, g * p1 * p2, 1.0 + g * p2 * p2);
        let row = |t1: f64, t2: f64, p: f64| [0.5 * t1, 0.5 * t2 - p, 0.5 * t2 + p, -0.5 * t1];
        let (d1, d2) = (row(t11, t12, p1), row(t12, t22, p2));
        StrainRate::new(
            0.5 + d1[0], d1[1], d1[2], 0.5 + d1[3],
            0.5 - d1[0], -d1[1], -d1[2], 0.5 - d1[3],
            0.0, 0.0, 0.0, 0.0,
            2.0 * d2[0], 2.0 * d2[1], 2.0 * d2[2], 2.0 * d2[3],
        )
    }

    #[inline(always)]
    fn kirchhoff_slope(_: f64) -> f64 {
        0.0
    }

    #[inline(always)]
    fn strength_slope(measure: StrengthMeasure, jacobian: f64) -> f64 {
        match measure {
            StrengthMeasure::Cauchy => jacobian,
            StrengthMeasure::Kirchhoff => 0.0,
        }
    }

    /// ln det F.
    #[inline(always)]
    fn dilatation(du: Gradient) -> f64 {
        volume_change(du).ln_1p()
    }

    #[inline(always)]
    fn dilate(du: Gradient, by: f64) -> Gradient {
        swell(du, by)
    }
}

/// (e coth e - 1) / |E|^2 with e = 2 |E|, from |E|^2.
#[inline(always)]
fn turning(square: f64) -> f64 {
    let x = 4.0 * square;
    if x < 0.04 {
        // 4 / x (x / 3 - x^2 / 45 + 2 x^3 / 945 - ...); what is left out is below 1e-12
        4.0 * (1.0 / 3.0 + x * (-1.0 / 45.0 + x * (2.0 / 945.0 + x * (-1.0 / 4725.0 + x * (2.0 / 93555.0)))))
    } else {
        let e = x.sqrt();
        (e / e.tanh() - 1.0) / square
    }
}
