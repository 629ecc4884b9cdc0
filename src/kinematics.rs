//! Strain measures: from the displacement gradient of a step to the trial elastic strain, and
//! from the law's stress to the Cauchy stress.

use crate::math::tensor::{Gradient, Voigt, log_strain_exact, log_strain_series};

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

/// A strain measure.
pub trait Kinematics: Copy + Send + Sync + 'static {
    const NAME: &'static str;

    /// Trial elastic strain, without branches or library calls.
    fn trial(strain: Voigt, du: Gradient) -> Trial;

    /// Trial elastic strain for steps and strains of any size.
    fn trial_exact(strain: Voigt, du: Gradient) -> Trial {
        Self::trial(strain, du)
    }

    /// Cauchy stress over the law's stress, at J.
    fn cauchy_factor(jacobian: f64) -> f64;

    /// Factor on the strength that the law sees, at J.
    fn strength_factor(measure: StrengthMeasure, jacobian: f64) -> f64;

    /// Volume to which an energy density of the law refers, over the initial volume.
    fn energy_volume(jacobian: f64) -> f64;
}

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
}

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
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rotate_in_steps<K: Kinematics>(e: Voigt, steps: usize) -> Voigt {
        let angle = std::f64::consts::FRAC_PI_2 / steps as f64;
        let (s, c) = angle.sin_cos();
        let du = Gradient { xx: c - 1.0, xy: -s, yx: s, yy: c - 1.0 };
        (0..steps).fold(e, |e, _| K::trial_exact(e, du).strain)
    }

    fn quarter_turn_error<K: Kinematics>(steps: usize) -> f64 {
        let e = Voigt::new(0.01, -0.02, 0.0, 0.005);
        let turned = rotate_in_steps::<K>(e, steps);
        let gap = turned - Voigt::new(e.yy, e.xx, 0.0, -e.xy);
        gap.dot(gap).sqrt()
    }

    #[test]
    fn hencky_is_objective_for_any_step() {
        assert!(quarter_turn_error::<Hencky>(1) < 1e-15);
        assert!(quarter_turn_error::<Hencky>(7) < 1e-15);
    }

    #[test]
    fn rate_is_objective_to_first_order() {
        // sym(grad du) of a finite rotation is O(dt^2) a step, so O(dt) in all
        let (coarse, fine) = (quarter_turn_error::<Rate>(1000), quarter_turn_error::<Rate>(2000));
        let order = (coarse / fine).log2();
        assert!((order - 1.0).abs() < 0.05, "order {order}");
    }

    #[test]
    fn both_agree_with_small_strain() {
        let e = Voigt::new(1e-4, -2e-4, 1e-4, 3e-4);
        let du = Gradient { xx: 1e-8, xy: 2e-8, yx: -1e-8, yy: 3e-8 };
        let gap = Hencky::trial(e, du).strain - Rate::trial(e, du).strain;
        // they differ by strain x step
        assert!(gap.dot(gap).sqrt() < 1e-4 * 5e-8);
    }
}
