//! Symmetric tensors in plane strain, and the logarithmic strain of a finite step.

use std::ops::{Add, Mul, Sub};

use nalgebra::SMatrix;

/// Components (xx, yy, zz, xy) of a symmetric tensor in plane strain; xy is the tensor
/// component, not the engineering shear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Voigt {
    pub xx: f64,
    pub yy: f64,
    pub zz: f64,
    pub xy: f64,
}

/// Components (xx, xy, yx, yy) of an in-plane gradient: `xy` is d u_x / d y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gradient {
    pub xx: f64,
    pub xy: f64,
    pub yx: f64,
    pub yy: f64,
}

/// d stress / d strain in the order (xx, yy, zz, xy). Rows are tensor components of stress; the
/// last column is the derivative by the engineering shear 2 e_xy.
pub type Moduli = SMatrix<f64, 4, 4>;

impl Voigt {
    pub const fn new(xx: f64, yy: f64, zz: f64, xy: f64) -> Self {
        Voigt { xx, yy, zz, xy }
    }

    /// The same value on the diagonal.
    #[inline(always)]
    pub const fn diagonal(value: f64) -> Self {
        Voigt { xx: value, yy: value, zz: value, xy: 0.0 }
    }

    #[inline(always)]
    pub fn trace(self) -> f64 {
        self.xx + self.yy + self.zz
    }

    /// Deviator in three dimensions.
    #[inline(always)]
    pub fn deviator(self) -> Self {
        self - Voigt::diagonal(self.trace() / 3.0)
    }

    /// Double contraction a : b.
    #[inline(always)]
    pub fn dot(self, b: Self) -> f64 {
        self.xx * b.xx + self.yy * b.yy + self.zz * b.zz + 2.0 * (self.xy * b.xy)
    }

    /// Von Mises equivalent q = sqrt(3/2 s : s).
    #[inline(always)]
    pub fn von_mises(self) -> f64 {
        let s = self.deviator();
        (1.5 * s.dot(s)).sqrt()
    }

    /// Components in the order (xx, yy, zz, xy).
    #[inline(always)]
    pub const fn to_array(self) -> [f64; 4] {
        [self.xx, self.yy, self.zz, self.xy]
    }

    #[inline(always)]
    pub const fn from_array(a: [f64; 4]) -> Self {
        Voigt { xx: a[0], yy: a[1], zz: a[2], xy: a[3] }
    }
}

impl Add for Voigt {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Voigt::new(self.xx + b.xx, self.yy + b.yy, self.zz + b.zz, self.xy + b.xy)
    }
}

impl Sub for Voigt {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Voigt::new(self.xx - b.xx, self.yy - b.yy, self.zz - b.zz, self.xy - b.xy)
    }
}

impl Mul<f64> for Voigt {
    type Output = Self;
    #[inline(always)]
    fn mul(self, k: f64) -> Self {
        Voigt::new(self.xx * k, self.yy * k, self.zz * k, self.xy * k)
    }
}

/// Result of a finite step on the elastic logarithmic strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogStrainStep {
    /// Trial elastic logarithmic strain.
    pub strain: Voigt,
    /// J = det(I + grad du) of the step.
    pub jacobian: f64,
    /// Whether the arguments of the series were inside their bounds.
    pub inside: bool,
}

/// |dev 2e|^2 up to which the polynomial of tanhc holds to rounding.
const SHEAR_BOUND: f64 = 0.0196;
/// (|dev B| / (tr B / 2))^2 up to which the polynomial of atanhc holds to rounding.
const STRETCH_BOUND: f64 = 0.0256;
/// |det F - 1| up to which the series of ln(det F) holds: its first term left out is 1e-17 of it.
const VOLUME_BOUND: f64 = 0.02;

/// tanh(sqrt x) / sqrt x, x <= `SHEAR_BOUND`: its Taylor series, Chebyshev economised.
#[inline(always)]
fn tanhc_series(x: f64) -> f64 {
    const C: [f64; 6] = [
        1.0,
        -0.333_333_333_332_976_6,
        0.133_333_333_120_861_1,
        -0.053_968_207_661_156_07,
        0.021_864_921_785_266_764,
        -0.008_655_126_948_342_552,
    ];
    horner(&C, x)
}

/// atanh(sqrt y) / sqrt y, y <= `STRETCH_BOUND`: its Taylor series, Chebyshev economised.
#[inline(always)]
fn atanhc_series(y: f64) -> f64 {
    const C: [f64; 7] = [
        1.0,
        0.333_333_333_333_090_3,
        0.200_000_000_151_741_28,
        0.142_857_107_376_493_45,
        0.111_115_054_624_591_05,
        0.090_684_848_021_107_37,
        0.083_194_524_124_983_8,
    ];
    horner(&C, y)
}

/// ln(1 + u) = 2 atanh(z) with z = u / (2 + u), |u| <= `VOLUME_BOUND`.
#[inline(always)]
fn log1p_series(z: f64) -> f64 {
    const C: [f64; 4] = [2.0, 2.0 / 3.0, 2.0 / 5.0, 2.0 / 7.0];
    z * horner(&C, z * z)
}

#[inline(always)]
fn horner<const N: usize>(c: &[f64; N], x: f64) -> f64 {
    let mut sum = c[N - 1];
    let mut k = N - 1;
    while k > 0 {
        k -= 1;
        sum = sum * x + c[k];
    }
    sum
}

/// `f(sqrt x) / sqrt x` by the library, 1 at x = 0.
fn ratio(x: f64, f: fn(f64) -> f64) -> f64 {
    let s = x.sqrt();
    if s > 0.0 { f(s) / s } else { 1.0 }
}

/// The three functions of the closed form, by series or by the library.
trait Functions {
    fn tanhc(x: f64) -> f64;
    fn atanhc(y: f64) -> f64;
    /// ln(1 + u); z = u / (2 + u).
    fn log1p(u: f64, z: f64) -> f64;
}

struct Series;
struct Library;

impl Functions for Series {
    #[inline(always)]
    fn tanhc(x: f64) -> f64 {
        tanhc_series(x)
    }
    #[inline(always)]
    fn atanhc(y: f64) -> f64 {
        atanhc_series(y)
    }
    #[inline(always)]
    fn log1p(_: f64, z: f64) -> f64 {
        log1p_series(z)
    }
}

impl Functions for Library {
    fn tanhc(x: f64) -> f64 {
        ratio(x, f64::tanh)
    }
    fn atanhc(y: f64) -> f64 {
        ratio(y, f64::atanh)
    }
    fn log1p(u: f64, _: f64) -> f64 {
        u.ln_1p()
    }
}

/// eps_tr = 1/2 ln(F exp(2 e) F^T), F = I + grad du, in closed form (no eigenvectors).
///
/// In the plane, with D = dev(2e) and x = D_xx^2 + D_xy^2:
/// ```text
/// exp(2e)  = exp(tr e) cosh(sqrt x) (I + tanhc(x) D)
/// B        = F (I + tanhc(x) D) F^T,   m = tr B / 2,   y = |dev B|^2 / m^2
/// eps_tr   = 1/2 (tr e + ln J) I + 1/2 atanhc(y) dev B / m
/// ```
/// since det(I + tanhc(x) D) = 1 / cosh^2(sqrt x) takes the factor of exp(2e) out again. The
/// zz component does not change in plane strain.
#[inline(always)]
fn closed_form<F: Functions>(e: Voigt, du: Gradient) -> LogStrainStep {
    let (d1, d2) = (e.xx - e.yy, 2.0 * e.xy);
    let x = d1 * d1 + d2 * d2;
    let t = F::tanhc(x);
    let (a11, a12, a22) = (1.0 + t * d1, t * d2, 1.0 - t * d1);
    let (fa, fb, fc, fd) = (1.0 + du.xx, du.xy, du.yx, 1.0 + du.yy);
    // rows of F A
    let (g11, g12) = (fa * a11 + fb * a12, fa * a12 + fb * a22);
    let (g21, g22) = (fc * a11 + fd * a12, fc * a12 + fd * a22);
    let bxx = g11 * fa + g12 * fb;
    let byy = g21 * fc + g22 * fd;
    let bxy = g11 * fc + g12 * fd;
    let m = 0.5 * (bxx + byy);
    let dev = 0.5 * (bxx - byy);
    let u = du.xx + du.yy + (du.xx * du.yy - du.xy * du.yx);
    // one division for 1 / m and for u / (2 + u)
    let inverse = 1.0 / (m * (2.0 + u));
    let (im, z) = (inverse * (2.0 + u), (inverse * m) * u);
    let (rx, ry) = (dev * im, bxy * im);
    let y = rx * rx + ry * ry;
    let iso = 0.5 * (e.xx + e.yy + F::log1p(u, z));
    let k = 0.5 * F::atanhc(y);
    LogStrainStep {
        strain: Voigt::new(iso + k * rx, iso - k * rx, e.zz, k * ry),
        jacobian: 1.0 + u,
        inside: (x <= SHEAR_BOUND) & (y <= STRETCH_BOUND) & (u.abs() <= VOLUME_BOUND),
    }
}

/// Trial elastic logarithmic strain of a step with displacement gradient `du` (by the position
/// at its start), by series: no branch, no library call. Only valid if `inside`; otherwise use
/// [`log_strain_exact`].
#[inline(always)]
pub fn log_strain_series(e: Voigt, du: Gradient) -> LogStrainStep {
    closed_form::<Series>(e, du)
}

/// As [`log_strain_series`], for any strain and any step with det F > 0.
pub fn log_strain_exact(e: Voigt, du: Gradient) -> LogStrainStep {
    LogStrainStep { inside: true, ..closed_form::<Library>(e, du) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, SymmetricEigen};
    use proptest::prelude::*;

    /// 1/2 ln(F exp(2e) F^T) by eigenvectors: the definition.
    fn by_eigenvectors(e: Voigt, du: Gradient) -> Voigt {
        let map = |m: Matrix2<f64>, f: fn(f64) -> f64| {
            let eig = SymmetricEigen::new(m);
            eig.eigenvectors * Matrix2::from_diagonal(&eig.eigenvalues.map(f)) * eig.eigenvectors.transpose()
        };
        let b = map(Matrix2::new(e.xx, e.xy, e.xy, e.yy) * 2.0, f64::exp);
        let f = Matrix2::new(1.0 + du.xx, du.xy, du.yx, 1.0 + du.yy);
        let l = map(f * b * f.transpose(), f64::ln) * 0.5;
        Voigt::new(l[(0, 0)], l[(1, 1)], e.zz, l[(0, 1)])
    }

    fn close(a: Voigt, b: Voigt, tolerance: f64) -> bool {
        a.to_array().iter().zip(b.to_array()).all(|(x, y)| (x - y).abs() <= tolerance)
    }

    proptest! {
        #[test]
        fn series_equals_closed_form_where_it_claims_to(
            e in prop::array::uniform4(-0.06..0.06f64), l in prop::array::uniform4(-0.05..0.05f64)) {
            let e = Voigt::new(e[0], e[1], e[2], e[3]);
            let du = Gradient { xx: l[0], xy: l[1], yx: l[2], yy: l[3] };
            let (fast, exact) = (log_strain_series(e, du), log_strain_exact(e, du));
            if fast.inside {
                // rounding of a few operations on numbers near 1
                prop_assert!(close(fast.strain, exact.strain, 4e-16), "{fast:?} {exact:?}");
            }
            prop_assert!((fast.jacobian - exact.jacobian).abs() < 1e-15);
        }

        #[test]
        fn closed_form_equals_eigenvectors(
            e in prop::array::uniform4(-0.8..0.8f64), l in prop::array::uniform4(-0.4..0.4f64)) {
            let e = Voigt::new(e[0], e[1], e[2], e[3]);
            let du = Gradient { xx: l[0], xy: l[1], yx: l[2], yy: l[3] };
            // conditioning: the exact route squares the strain, so allow exp(2 * 0.8 * 2) roundings
            prop_assert!(close(log_strain_exact(e, du).strain, by_eigenvectors(e, du), 2e-13));
        }
    }

    #[test]
    fn small_strains_are_inside_and_large_ones_are_not() {
        let du = Gradient { xx: 1e-3, xy: 2e-3, yx: 0.0, yy: -1e-3 };
        assert!(log_strain_series(Voigt::new(0.03, -0.03, 0.0, 0.01), du).inside);
        assert!(!log_strain_series(Voigt::new(0.2, -0.2, 0.0, 0.0), du).inside);
        assert!(!log_strain_series(Voigt::default(), Gradient { xx: f64::NAN, ..du }).inside);
    }

    #[test]
    fn pure_rotation_keeps_the_principal_strains() {
        let (s, c) = 0.7f64.sin_cos();
        let du = Gradient { xx: c - 1.0, xy: -s, yx: s, yy: c - 1.0 };
        let e = Voigt::new(0.04, -0.01, 0.02, 0.0);
        let r = log_strain_exact(e, du).strain;
        assert!((r.trace() - e.trace()).abs() < 1e-15);
        assert!((r.dot(r) - e.dot(e)).abs() < 1e-15);
    }
}
