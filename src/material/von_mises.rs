//! Von Mises plasticity with linear cohesion softening to a residual value (eq. 4 of Wang,
//! Hicks & Vardon).

use super::{Columns, Elasticity, Material, Standing, Update};
use crate::math::tensor::{Moduli, Voigt};

/// Parameters of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    pub elasticity: Elasticity,
    /// c0, peak cohesion (kPa).
    pub cohesion: f64,
    /// c_r, residual cohesion (kPa).
    pub residual_cohesion: f64,
    /// H (kPa), d c / d eps_p before the residual strength is reached; negative softens.
    pub softening_modulus: f64,
    /// k in q <= k c; sqrt(3) makes c the plane-strain shear strength.
    pub yield_constant: f64,
}

impl Columns for Strength {
    const NAMES: &'static [&'static str] =
        &["shear_modulus", "bulk_modulus", "cohesion", "residual_cohesion", "softening_modulus", "yield_constant"];
    #[inline(always)]
    fn read(get: impl Fn(usize) -> f64) -> Self {
        Strength {
            elasticity: Elasticity { shear_modulus: get(0), bulk_modulus: get(1) },
            cohesion: get(2),
            residual_cohesion: get(3),
            softening_modulus: get(4),
            yield_constant: get(5),
        }
    }
    #[inline(always)]
    fn write(&self, mut put: impl FnMut(usize, f64)) {
        self.elasticity.write(&mut put);
        put(2, self.cohesion);
        put(3, self.residual_cohesion);
        put(4, self.softening_modulus);
        put(5, self.yield_constant);
    }
}

impl Strength {
    /// c(eps_p) = c0 + H eps_p until it reaches c_r (eq. 4). A perfectly plastic soil has H = 0.
    #[inline(always)]
    pub fn cohesion_at(&self, plastic_strain: f64) -> f64 {
        let c = self.cohesion + self.softening_modulus * plastic_strain;
        if self.past_residual(c) { self.residual_cohesion } else { c }
    }

    /// Whether a cohesion on the sloping line lies past c_r, for softening and for hardening.
    #[inline(always)]
    fn past_residual(&self, c: f64) -> bool {
        let past = (c - self.residual_cohesion) * self.softening_modulus;
        (past >= 0.0) & (self.softening_modulus != 0.0)
    }
}

/// Accumulated plastic shear strain invariant, eps_p = int sqrt(2/3 de_p : de_p).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlasticStrain(pub f64);

impl Columns for PlasticStrain {
    const NAMES: &'static [&'static str] = &["plastic_strain"];
    #[inline(always)]
    fn read(get: impl Fn(usize) -> f64) -> Self {
        PlasticStrain(get(0))
    }
    #[inline(always)]
    fn write(&self, mut put: impl FnMut(usize, f64)) {
        put(0, self.0);
    }
}

/// The law.
#[derive(Clone, Copy, Debug, Default)]
pub struct VonMises;

/// Stresses within this relative distance of the yield surface count as on it; the return
/// mapping puts them there to rounding.
const ON_SURFACE: f64 = 1e-10;

impl Material for VonMises {
    type Param = Strength;
    type State = PlasticStrain;

    /// Radial return in closed form. With q_tr the trial von Mises stress, f the strength
    /// factor and c_n the cohesion at the start,
    /// ```text
    /// dl = (q_tr - k f c_n) / (3G + k f H)      on the sloping line,
    /// dl = (q_tr - k f c_r) / (3G)              if that step ends at or past c_r,
    /// s  = (1 - 3G dl / q_tr) s_tr,  eps_p += dl.
    /// ```
    #[inline(always)]
    fn update(&self, p: &Strength, s: &PlasticStrain, trial: Voigt, factor: f64) -> Update<PlasticStrain> {
        let g = p.elasticity.shear_modulus;
        let third = trial.trace() * (1.0 / 3.0);
        let dev = trial - Voigt::diagonal(third);
        let q = 2.0 * g * (1.5 * dev.dot(dev)).sqrt();
        let kf = p.yield_constant * factor;
        let on_line = p.cohesion + p.softening_modulus * s.0;
        let c = if p.past_residual(on_line) { p.residual_cohesion } else { on_line };
        let over = q - kf * c;
        let stiffness = 3.0 * g + kf * p.softening_modulus;
        // where the sloping line ends, times the stiffness: no division for it
        let gap = (on_line - p.residual_cohesion) * stiffness + p.softening_modulus * over;
        let past = (gap * p.softening_modulus >= 0.0) & (p.softening_modulus != 0.0);
        let (excess, slope) = if past { (q - kf * p.residual_cohesion, 3.0 * g) } else { (over, stiffness) };
        let yields = over > 0.0;
        // one division gives flow and flow / q
        let inverse = 1.0 / (slope * q);
        let flow = if yields { excess * (q * inverse) } else { 0.0 };
        let scale = if yields { 1.0 - 3.0 * g * (excess * inverse) } else { 1.0 };
        let pressure = 3.0 * p.elasticity.bulk_modulus * third;
        let elastic = dev * scale;
        let strain = if yields { elastic + Voigt::diagonal(third) } else { trial };
        Update {
            stress: elastic * (2.0 * g) + Voigt::diagonal(pressure),
            strain,
            state: PlasticStrain(s.0 + flow),
            flow,
            dissipation: flow * (q - 3.0 * g * flow),
        }
    }

    #[inline(always)]
    fn stress(&self, p: &Strength, strain: Voigt) -> Voigt {
        p.elasticity.stress(strain)
    }

    /// With N = s / |s|, q_tr = q + 3G dl and H' = k f H (0 at the residual strength)
    /// (de Souza Neto, Peric & Owen 2008, section 7.4.2):
    /// ```text
    /// D = D_e - 6G^2 dl / q_tr I_dev + 6G^2 (dl / q_tr - 1 / (3G + H')) N (x) N
    /// ```
    fn tangent(&self, p: &Strength, u: &Update<PlasticStrain>, factor: f64) -> Moduli {
        let elastic = p.elasticity.moduli();
        if u.flow <= 0.0 {
            return elastic;
        }
        let g = p.elasticity.shear_modulus;
        let ratio = u.flow / (u.stress.von_mises() + 3.0 * g * u.flow);
        let slope = 1.0 / (3.0 * g + p.slope_after(u) * factor);
        let n = direction(u.stress);
        let n = nalgebra::SVector::<f64, 4>::from(n.to_array());
        elastic - deviatoric_projector() * (6.0 * g * g * ratio) + n * n.transpose() * (6.0 * g * g * (ratio - slope))
    }

    /// d s / d f = sqrt(2/3) N 3G k c / (3G + k f H).
    fn strength_sensitivity(&self, p: &Strength, u: &Update<PlasticStrain>, factor: f64) -> Voigt {
        if u.flow <= 0.0 {
            return Voigt::default();
        }
        let g = p.elasticity.shear_modulus;
        let c = p.cohesion_at(u.state.0);
        let rate = 3.0 * g * p.yield_constant * c / (3.0 * g + p.slope_after(u) * factor);
        direction(u.stress) * ((2.0f64 / 3.0).sqrt() * rate)
    }

    fn wave_speed(&self, p: &Strength, density: f64) -> f64 {
        p.elasticity.wave_speed(density)
    }

    fn standing(&self, p: &Strength, s: &PlasticStrain, strain: Voigt, factor: f64) -> Standing {
        let c = p.cohesion_at(s.0);
        let q = self.stress(p, strain).von_mises();
        Standing {
            plastic_strain: s.0,
            strength: c,
            peak_strength: p.cohesion,
            yielding: q >= p.yield_constant * factor * c * (1.0 - ON_SURFACE),
            residual: p.past_residual(p.cohesion + p.softening_modulus * s.0),
        }
    }
}

impl Strength {
    /// k H where the updated point lies on the sloping line, 0 at the residual strength.
    fn slope_after(&self, u: &Update<PlasticStrain>) -> f64 {
        let c = self.cohesion + self.softening_modulus * u.state.0;
        if self.past_residual(c) { 0.0 } else { self.yield_constant * self.softening_modulus }
    }
}

/// N = s / |s|.
fn direction(stress: Voigt) -> Voigt {
    let s = stress.deviator();
    s * (1.0 / s.dot(s).sqrt())
}

/// I_dev, for strains with engineering shear.
fn deviatoric_projector() -> Moduli {
    let (a, b) = (2.0 / 3.0, -1.0 / 3.0);
    Moduli::new(a, b, b, 0.0, b, a, b, 0.0, b, b, a, 0.0, 0.0, 0.0, 0.0, 0.5)
}

#[cfg(test)]
mod tests {
    use super::super::contract;
    use super::*;

    fn clay() -> Strength {
        Strength {
            elasticity: Elasticity::from_young(1000.0, 0.33),
            cohesion: 20.0,
            residual_cohesion: 4.0,
            softening_modulus: -50.0,
            yield_constant: 3f64.sqrt(),
        }
    }

    const TRIAL: Voigt = Voigt::new(0.05, -0.04, 0.01, 0.03);

    #[test]
    fn contract_on_every_branch() {
        let perfect = Strength { softening_modulus: 0.0, residual_cohesion: 20.0, ..clay() };
        let small = TRIAL * 0.1;
        // elastic, sloping line, step over the kink, residual, perfectly plastic
        for (p, start, trial) in [
            (clay(), 0.0, small),
            (clay(), 0.02, TRIAL),
            (clay(), 0.31, TRIAL),
            (clay(), 0.9, TRIAL),
            (perfect, 0.1, TRIAL),
        ] {
            for factor in [1.0, 0.93] {
                contract::tangent_is_consistent(VonMises, &p, &PlasticStrain(start), trial, factor);
                contract::stress_belongs_to_strain(VonMises, &p, &PlasticStrain(start), trial, factor);
            }
        }
        contract::small_strain_is_elastic(VonMises, &clay(), &PlasticStrain(0.1));
    }

    #[test]
    fn returned_stress_lies_on_the_softened_surface() {
        for start in [0.0, 0.1, 0.315, 0.5] {
            let u = VonMises.update(&clay(), &PlasticStrain(start), TRIAL, 0.95);
            let c = clay().cohesion_at(u.state.0);
            assert!((u.stress.von_mises() - 3f64.sqrt() * 0.95 * c).abs() < 1e-12, "start {start}");
            assert!(c >= 4.0);
        }
    }

    #[test]
    fn residual_strength_is_reached_at_0_32() {
        assert!((clay().cohesion_at(0.32 - 1e-9) - 4.0).abs() < 1e-7);
        assert_eq!(clay().cohesion_at(0.32 + 1e-9), 4.0);
    }

    #[test]
    fn cohesion_is_the_plane_strain_shear_strength() {
        // simple shear at constant volume: |tau_xy| = c with k = sqrt(3)
        let u = VonMises.update(&clay(), &PlasticStrain(1.0), Voigt::new(0.0, 0.0, 0.0, 0.1), 1.0);
        assert!((u.stress.xy - 4.0).abs() < 1e-12);
    }

    #[test]
    fn dissipation_is_stress_times_plastic_strain() {
        let u = VonMises.update(&clay(), &PlasticStrain(0.0), TRIAL, 1.0);
        let plastic = TRIAL - u.strain;
        assert!((u.stress.dot(plastic) - u.dissipation).abs() < 1e-13);
        assert!(((2.0 / 3.0 * plastic.dot(plastic)).sqrt() - u.flow).abs() < 1e-15);
    }
}
