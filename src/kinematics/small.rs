//! Small strain.

use super::{Kinematics, StrainRate, StrengthMeasure, Trial};
use crate::math::tensor::{Gradient, Voigt};

/// Small strain: e_tr = e + sym(grad du). Nothing turns, no volume changes, and the points keep
/// the places in their cells.
#[derive(Clone, Copy, Debug)]
pub struct Small;

impl Kinematics for Small {
    const NAME: &'static str = "small";
    const FINITE: bool = false;

    #[inline(always)]
    fn trial(e: Voigt, du: Gradient) -> Trial {
        let strain = Voigt::new(e.xx + du.xx, e.yy + du.yy, e.zz, e.xy + 0.5 * (du.xy + du.yx));
        Trial { strain, jacobian: 1.0, inside: true }
    }

    #[inline(always)]
    #[rustfmt::skip]
    fn strain_rate(_: Voigt, _: Voigt, _: Gradient) -> StrainRate {
        StrainRate::new(
            1.0, 0.0, 0.0, 0.0,
            0.0, 0.0, 0.0, 1.0,
            0.0, 0.0, 0.0, 0.0,
            0.0, 1.0, 1.0, 0.0,
        )
    }

    #[inline(always)]
    fn cauchy_factor(_: f64) -> f64 {
        1.0
    }

    #[inline(always)]
    fn kirchhoff_slope(_: f64) -> f64 {
        0.0
    }

    #[inline(always)]
    fn strength_factor(_: StrengthMeasure, _: f64) -> f64 {
        1.0
    }

    #[inline(always)]
    fn strength_slope(_: StrengthMeasure, _: f64) -> f64 {
        0.0
    }

    #[inline(always)]
    fn energy_volume(_: f64) -> f64 {
        1.0
    }

    #[inline(always)]
    fn dilatation(du: Gradient) -> f64 {
        du.xx + du.yy
    }

    #[inline(always)]
    fn dilate(du: Gradient, by: f64) -> Gradient {
        Gradient { xx: du.xx + 0.5 * by, yy: du.yy + 0.5 * by, ..du }
    }
}
