//! The Jaumann rate.

use super::{Kinematics, StrainRate, StrengthMeasure, Trial, swell, volume_change};
use crate::math::tensor::{Gradient, Voigt};

/// Jaumann rate of the Cauchy stress, for the explicit scheme. Written for the elastic strain
/// e = C^-1 sigma, to which isotropic elasticity carries the rate over:
/// ```text
/// e_tr = e + sym(grad du) + w e - e w,   w = skew(grad du)
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Rate;

impl Kinematics for Rate {
    const NAME: &'static str = "rate";

    #[inline(always)]
    fn trial(e: Voigt, du: Gradient) -> Trial {
        let w = 0.5 * (du.xy - du.yx);
        let shear = 0.5 * (du.xy + du.yx);
        let turn = 2.0 * (w * e.xy);
        Trial {
            strain: Voigt::new(e.xx + (du.xx + turn), e.yy + (du.yy - turn), e.zz, e.xy + (shear + w * (e.yy - e.xx))),
            jacobian: 1.0 + (du.xx + du.yy + (du.xx * du.yy - du.xy * du.yx)),
            inside: true,
        }
    }

    #[inline(always)]
    fn cauchy_factor(_: f64) -> f64 {
        1.0
    }

    #[inline(always)]
    fn strength_factor(measure: StrengthMeasure, jacobian: f64) -> f64 {
        match measure {
            StrengthMeasure::Cauchy => 1.0,
            StrengthMeasure::Kirchhoff => 1.0 / jacobian,
        }
    }

    #[inline(always)]
    fn energy_volume(jacobian: f64) -> f64 {
        jacobian
    }

    /// The trial strain is linear in grad du, and d(grad du) = l F.
    #[rustfmt::skip]
    fn strain_rate(e: Voigt, _: Voigt, du: Gradient) -> StrainRate {
        // d strain / d(grad du); w is half of (xy - yx)
        let (turn, spread) = (e.xy, 0.5 * (e.yy - e.xx));
        let by_du = StrainRate::new(
            1.0, turn, -turn, 0.0,
            0.0, -turn, turn, 1.0,
            0.0, 0.0, 0.0, 0.0,
            0.0, 1.0 + 2.0 * spread, 1.0 - 2.0 * spread, 0.0,
        );
        let (fxx, fxy, fyx, fyy) = (1.0 + du.xx, du.xy, du.yx, 1.0 + du.yy);
        let by_l = StrainRate::new(
            fxx, fyx, 0.0, 0.0,
            fxy, fyy, 0.0, 0.0,
            0.0, 0.0, fxx, fyx,
            0.0, 0.0, fxy, fyy,
        );
        by_du * by_l
    }

    fn kirchhoff_slope(jacobian: f64) -> f64 {
        jacobian
    }

    fn strength_slope(measure: StrengthMeasure, jacobian: f64) -> f64 {
        match measure {
            StrengthMeasure::Cauchy => 0.0,
            StrengthMeasure::Kirchhoff => -1.0 / jacobian,
        }
    }

    fn dilatation(du: Gradient) -> f64 {
        volume_change(du).ln_1p()
    }

    fn dilate(du: Gradient, by: f64) -> Gradient {
        swell(du, by)
    }
}
