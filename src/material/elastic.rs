//! Isotropic linear elasticity.

use super::{Columns, Material, Standing, Update};
use crate::math::tensor::{Moduli, Voigt};

/// Moduli of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elasticity {
    /// G (kPa).
    pub shear_modulus: f64,
    /// K (kPa).
    pub bulk_modulus: f64,
}

impl Elasticity {
    /// G = E / (2 (1 + nu)), K = E / (3 (1 - 2 nu)).
    pub fn from_young(young_modulus: f64, poisson_ratio: f64) -> Self {
        Elasticity {
            shear_modulus: young_modulus / (2.0 * (1.0 + poisson_ratio)),
            bulk_modulus: young_modulus / (3.0 * (1.0 - 2.0 * poisson_ratio)),
        }
    }

    /// sigma = (K - 2/3 G) tr(e) I + 2 G e.
    #[inline(always)]
    pub fn stress(&self, e: Voigt) -> Voigt {
        let lambda = self.bulk_modulus - self.shear_modulus * (2.0 / 3.0);
        Voigt::diagonal(lambda * e.trace()) + e * (2.0 * self.shear_modulus)
    }

    /// Elastic strain of a stress.
    pub fn strain(&self, s: Voigt) -> Voigt {
        Voigt::diagonal(s.trace() / (9.0 * self.bulk_modulus)) + s.deviator() * (0.5 / self.shear_modulus)
    }

    /// d sigma / d e.
    pub fn moduli(&self) -> Moduli {
        let (k, g) = (self.bulk_modulus, self.shear_modulus);
        let (a, b) = (k + 4.0 / 3.0 * g, k - 2.0 / 3.0 * g);
        Moduli::new(a, b, b, 0.0, b, a, b, 0.0, b, b, a, 0.0, 0.0, 0.0, 0.0, g)
    }

    /// c = sqrt(M / rho), M = K + 4/3 G.
    pub fn wave_speed(&self, density: f64) -> f64 {
        ((self.bulk_modulus + 4.0 / 3.0 * self.shear_modulus) / density).sqrt()
    }
}

impl Columns for Elasticity {
    const NAMES: &'static [&'static str] = &["shear_modulus", "bulk_modulus"];
    #[inline(always)]
    fn read(get: impl Fn(usize) -> f64) -> Self {
        Elasticity { shear_modulus: get(0), bulk_modulus: get(1) }
    }
    #[inline(always)]
    fn write(&self, mut put: impl FnMut(usize, f64)) {
        put(0, self.shear_modulus);
        put(1, self.bulk_modulus);
    }
}

/// The law without strength. It also stands in for other laws while they may not yield yet.
#[derive(Clone, Copy, Debug, Default)]
pub struct Elastic;

impl Material for Elastic {
    type Param = Elasticity;
    type State = ();

    #[inline(always)]
    fn update(&self, p: &Elasticity, _: &(), trial: Voigt, _: f64) -> Update<()> {
        Update { stress: p.stress(trial), strain: trial, state: (), flow: 0.0, dissipation: 0.0 }
    }

    #[inline(always)]
    fn stress(&self, p: &Elasticity, strain: Voigt) -> Voigt {
        p.stress(strain)
    }

    fn tangent(&self, p: &Elasticity, _: &Update<()>, _: f64) -> Moduli {
        p.moduli()
    }

    fn strength_sensitivity(&self, _: &Elasticity, _: &Update<()>, _: f64) -> Voigt {
        Voigt::default()
    }

    fn wave_speed(&self, p: &Elasticity, density: f64) -> f64 {
        p.wave_speed(density)
    }

    fn standing(&self, _: &Elasticity, _: &(), _: Voigt, _: f64) -> Standing {
        Standing { plastic_strain: 0.0, strength: f64::NAN, peak_strength: f64::NAN, yielding: false, residual: false }
    }
}

#[cfg(test)]
mod tests {
    use super::super::contract;
    use super::*;

    #[test]
    fn contract() {
        let p = Elasticity::from_young(1000.0, 0.33);
        let e = Voigt::new(0.01, -0.02, 0.003, 0.015);
        contract::tangent_is_consistent(Elastic, &p, &(), e, 1.0);
        contract::stress_belongs_to_strain(Elastic, &p, &(), e, 1.0);
        contract::small_strain_is_elastic(Elastic, &p, &());
    }

    #[test]
    fn strain_inverts_stress() {
        let p = Elasticity::from_young(1000.0, 0.33);
        let e = Voigt::new(0.01, -0.02, 0.003, 0.015);
        let gap = p.strain(p.stress(e)) - e;
        assert!(gap.dot(gap).sqrt() < 1e-16);
    }

    #[test]
    fn uniaxial_strain_stiffness_is_the_wave_modulus() {
        // M = E (1 - nu) / ((1 + nu)(1 - 2 nu))
        let p = Elasticity::from_young(1000.0, 0.33);
        let m = 1000.0 * 0.67 / (1.33 * 0.34);
        assert!((p.stress(Voigt::new(1.0, 0.0, 0.0, 0.0)).xx - m).abs() < 1e-9);
        assert!((p.wave_speed(2.0) - (m / 2.0).sqrt()).abs() < 1e-12);
    }
}
