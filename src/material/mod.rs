//! Constitutive laws at a point, in small-strain format: elastic strain in, stress out.
//!
//! A law is a pure function. The kinematics decide what the strain means: logarithmic strain
//! and Kirchhoff stress, or the small-strain pair. A new law is one file here and one line in
//! `scene`.

pub mod elastic;
pub mod nonlocal;
pub mod von_mises;

pub use elastic::{Elastic, Elasticity};
pub use nonlocal::NonlocalVonMises;
pub use von_mises::{PlasticStrain, Strength, VonMises};

use crate::math::tensor::{Moduli, Voigt};

/// A small record of numbers stored as columns over points.
pub trait Columns: Copy {
    /// Names of the columns, in order.
    const NAMES: &'static [&'static str];
    /// From the value of each column.
    fn read(get: impl Fn(usize) -> f64) -> Self;
    /// Into each column.
    fn write(&self, put: impl FnMut(usize, f64));
}

impl Columns for () {
    const NAMES: &'static [&'static str] = &[];
    #[inline(always)]
    fn read(_: impl Fn(usize) -> f64) -> Self {}
    #[inline(always)]
    fn write(&self, _: impl FnMut(usize, f64)) {}
}

/// What a law makes of a trial strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update<S> {
    /// Stress work-conjugate to the strain (kPa).
    pub stress: Voigt,
    /// Elastic strain after the return.
    pub strain: Voigt,
    /// History after the return.
    pub state: S,
    /// Plastic multiplier of the step; 0 if elastic.
    pub flow: f64,
    /// Plastic work per volume, stress : plastic strain increment (kPa).
    pub dissipation: f64,
}

/// Where a point stands, for pictures and measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// Accumulated plastic shear strain invariant.
    pub plastic_strain: f64,
    /// Current and peak cohesion (kPa); NaN without strength.
    pub strength: f64,
    pub peak_strength: f64,
    /// Whether the stress lies on the yield surface.
    pub yielding: bool,
    /// Whether the strength is at its residual value.
    pub residual: bool,
}

/// A law at a point: pure, pointwise, written without branches where that is easy, so that the
/// loop over a block becomes vector code.
pub trait Material: Copy + Send + Sync + 'static {
    /// Parameters of a point. The first two columns are always the shear and the bulk modulus.
    type Param: Columns;
    /// History of a point.
    type State: Columns;

    /// Return mapping from the trial elastic strain. `factor` multiplies the strength: J where
    /// the strain is logarithmic and the strength is a Cauchy strength, otherwise 1.
    fn update(&self, p: &Self::Param, s: &Self::State, trial: Voigt, factor: f64) -> Update<Self::State>;

    /// Stress of an elastic strain.
    fn stress(&self, p: &Self::Param, strain: Voigt) -> Voigt;

    /// Consistent tangent d stress / d trial strain of `u = update(p, .., factor)`.
    fn tangent(&self, p: &Self::Param, u: &Update<Self::State>, factor: f64) -> Moduli;

    /// d stress / d factor of `u = update(p, .., factor)`, at fixed trial strain.
    fn strength_sensitivity(&self, p: &Self::Param, u: &Update<Self::State>, factor: f64) -> Voigt;

    /// Speed of the compression wave (m/s) for a density (t/m3).
    fn wave_speed(&self, p: &Self::Param, density: f64) -> f64;

    /// Where a point stands, given its elastic strain and history.
    fn standing(&self, p: &Self::Param, s: &Self::State, strain: Voigt, factor: f64) -> Standing;
}

#[cfg(test)]
pub(crate) mod contract {
    //! What every law must satisfy; each law's tests call this.
    use super::*;

    fn shifted(e: Voigt, k: usize, by: f64) -> Voigt {
        let mut a = e.to_array();
        // the last column of the moduli is by the engineering shear
        a[k] += if k == 3 { 0.5 * by } else { by };
        Voigt::from_array(a)
    }

    /// Central differences of `update` agree with `tangent` and `strength_sensitivity`.
    /// The error of a central difference is h^2 f''' + rounding / h; at h = 1e-6 both are below
    /// 1e-7 of the stiffness.
    pub fn tangent_is_consistent<M: Material>(m: M, p: &M::Param, s: &M::State, trial: Voigt, factor: f64) {
        let u = m.update(p, s, trial, factor);
        let d = m.tangent(p, &u, factor);
        let h = 1e-6;
        let scale = d.amax();
        for k in 0..4 {
            let plus = m.update(p, s, shifted(trial, k, h), factor).stress;
            let minus = m.update(p, s, shifted(trial, k, -h), factor).stress;
            let fd = ((plus - minus) * (0.5 / h)).to_array();
            for (row, value) in fd.iter().enumerate() {
                assert!((d[(row, k)] - value).abs() < 1e-7 * scale, "D[{row},{k}] = {} but {value}", d[(row, k)]);
            }
        }
        let plus = m.update(p, s, trial, factor + h).stress;
        let minus = m.update(p, s, trial, factor - h).stress;
        let fd = (plus - minus) * (0.5 / h);
        let exact = m.strength_sensitivity(p, &u, factor);
        let gap = fd - exact;
        assert!(gap.dot(gap).sqrt() < 1e-7 * scale.max(1.0), "{fd:?} but {exact:?}");
    }

    /// The stress of the returned elastic strain is the returned stress.
    pub fn stress_belongs_to_strain<M: Material>(m: M, p: &M::Param, s: &M::State, trial: Voigt, factor: f64) {
        let u = m.update(p, s, trial, factor);
        let gap = m.stress(p, u.strain) - u.stress;
        assert!(gap.dot(gap).sqrt() <= 1e-12 * u.stress.dot(u.stress).sqrt().max(1.0));
    }

    /// Below yield a law is its elasticity, and does no plastic work.
    pub fn small_strain_is_elastic<M: Material>(m: M, p: &M::Param, s: &M::State) {
        let e = Voigt::new(1e-6, -2e-6, 0.5e-6, 1e-6);
        let u = m.update(p, s, e, 1.0);
        assert_eq!((u.strain, u.flow, u.dissipation), (e, 0.0, 0.0));
    }
}
