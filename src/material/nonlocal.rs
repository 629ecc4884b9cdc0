//! Von Mises plasticity whose cohesion follows an average of the plastic strain around a point (Vermeer &
//! Brinkgreve 1994), and not the plastic strain of the point.

use super::{Columns, Material, PlasticStrain, Standing, Strength, Update, VonMises};
use crate::math::tensor::{Moduli, Voigt};

/// History of a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Softening {
    /// eps_p, accumulated at the point itself.
    pub plastic_strain: f64,
    /// kappa, which the cohesion follows; `assembly::nonlocal` writes it between two steps.
    pub softening_strain: f64,
}

impl Columns for Softening {
    const NAMES: &'static [&'static str] = &["plastic_strain", "softening_strain"];
    #[inline(always)]
    fn read(get: impl Fn(usize) -> f64) -> Self {
        Softening { plastic_strain: get(0), softening_strain: get(1) }
    }
    #[inline(always)]
    fn write(&self, mut put: impl FnMut(usize, f64)) {
        put(0, self.plastic_strain);
        put(1, self.softening_strain);
    }
}

/// The law: within a step the cohesion stays c(kappa), so that the return is that of a perfectly plastic soil and the
/// tangent has no softening in it. What that costs is of order dt: kappa is that of the start of the step.
#[derive(Clone, Copy, Debug, Default)]
pub struct NonlocalVonMises;

/// The soil as it is during a step.
#[inline(always)]
fn held(p: &Strength, s: &Softening) -> Strength {
    Strength { cohesion: p.cohesion_at(s.softening_strain), softening_modulus: 0.0, ..*p }
}

/// An update as the local law has it.
fn local(u: &Update<Softening>) -> Update<PlasticStrain> {
    let Update { stress, strain, state, flow, dissipation } = *u;
    Update { stress, strain, state: PlasticStrain(state.plastic_strain), flow, dissipation }
}

impl Material for NonlocalVonMises {
    type Param = Strength;
    type State = Softening;

    #[inline(always)]
    fn update(&self, p: &Strength, s: &Softening, trial: Voigt, factor: f64) -> Update<Softening> {
        let u = VonMises.update(&held(p, s), &PlasticStrain(s.plastic_strain), trial, factor);
        let Update { stress, strain, state, flow, dissipation } = u;
        Update { stress, strain, state: Softening { plastic_strain: state.0, ..*s }, flow, dissipation }
    }

    #[inline(always)]
    fn stress(&self, p: &Strength, strain: Voigt) -> Voigt {
        VonMises.stress(p, strain)
    }

    fn tangent(&self, p: &Strength, u: &Update<Softening>, factor: f64) -> Moduli {
        VonMises.tangent(&held(p, &u.state), &local(u), factor)
    }

    fn strength_sensitivity(&self, p: &Strength, u: &Update<Softening>, factor: f64) -> Voigt {
        VonMises.strength_sensitivity(&held(p, &u.state), &local(u), factor)
    }

    fn wave_speed(&self, p: &Strength, density: f64) -> f64 {
        VonMises.wave_speed(p, density)
    }

    fn standing(&self, p: &Strength, s: &Softening, strain: Voigt, factor: f64) -> Standing {
        let now = VonMises.standing(&held(p, s), &PlasticStrain(s.plastic_strain), strain, factor);
        let softened = VonMises.standing(p, &PlasticStrain(s.softening_strain), strain, factor);
        Standing { peak_strength: p.cohesion, residual: softened.residual, ..now }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Elasticity, contract};
    use super::*;

    const TRIAL: Voigt = Voigt::new(0.05, -0.04, 0.01, 0.03);

    fn clay() -> Strength {
        Strength {
            elasticity: Elasticity::from_young(1000.0, 0.33),
            cohesion: 20.0,
            residual_cohesion: 4.0,
            softening_modulus: -50.0,
            yield_constant: 3f64.sqrt(),
        }
    }

    #[test]
    fn contract_before_on_and_past_the_slope() {
        for softening_strain in [0.0, 0.1, 0.5] {
            let s = Softening { plastic_strain: 0.2, softening_strain };
            for trial in [TRIAL * 0.01, TRIAL] {
                contract::tangent_is_consistent(NonlocalVonMises, &clay(), &s, trial, 0.93);
                contract::stress_belongs_to_strain(NonlocalVonMises, &clay(), &s, trial, 0.93);
            }
            contract::small_strain_is_elastic(NonlocalVonMises, &clay(), &s);
        }
    }

    #[test]
    fn cohesion_follows_the_average_and_not_the_point() {
        let s = Softening { plastic_strain: 0.3, softening_strain: 0.1 };
        let u = NonlocalVonMises.update(&clay(), &s, TRIAL, 1.0);
        assert!((u.stress.von_mises() - 3f64.sqrt() * 15.0).abs() < 1e-12);
        assert!(u.state.plastic_strain > 0.3 && u.state.softening_strain == 0.1);
        let standing = NonlocalVonMises.standing(&clay(), &u.state, u.strain, 1.0);
        assert!(standing.yielding && !standing.residual);
        assert_eq!((standing.strength, standing.peak_strength), (15.0, 20.0));
    }
}
