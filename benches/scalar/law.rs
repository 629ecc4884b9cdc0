//! The two constitutive updates, one point at a time.

/// Elastic and softening constants of one von Mises soil.
#[derive(Clone, Copy, Debug)]
pub struct Soil {
    /// First Lamé constant (kPa).
    pub lame: f64,
    /// Shear modulus (kPa).
    pub shear: f64,
    /// Slope of strength against plastic strain, negative where the soil softens (kPa).
    pub hardening: f64,
}

impl Soil {
    pub fn new(young_modulus: f64, poisson: f64, hardening: f64) -> Self {
        let shear = young_modulus / (2.0 * (1.0 + poisson));
        let lame = 2.0 * shear * poisson / (1.0 - 2.0 * poisson);
        Self { lame, shear, hardening }
    }
}

/// What a law changes at one point.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// xx, yy, zz, xy: elastic log strain (`Hencky`) or Cauchy stress in kPa (`Rate`).
    pub tensor: [f64; 4],
    /// det F since the start.
    pub jacobian: f64,
    /// Accumulated sqrt(2/3 dep:dep).
    pub plastic: f64,
}

/// A constitutive law with its kinematics.
pub trait Law {
    /// State after the displacement gradient `l` = xx, xy, yx, yy; `cohesion` = peak, residual (kPa).
    fn update(soil: &Soil, cohesion: [f64; 2], state: State, l: [f64; 4]) -> State;

    /// Stress integrated over the point, xx, yy, xy, of a point of reference volume `volume`.
    fn resultant(soil: &Soil, volume: f64, state: &State) -> [f64; 3];
}

/// Logarithmic elastic strain; `KIRCHHOFF` says which stress the strength is compared with.
pub struct Hencky<const KIRCHHOFF: bool = false>;

/// Jaumann rate of the Cauchy stress.
pub struct Rate<const KIRCHHOFF: bool = false>;

impl<const KIRCHHOFF: bool> Law for Hencky<KIRCHHOFF> {
    #[inline(always)]
    fn update(soil: &Soil, cohesion: [f64; 2], state: State, l: [f64; 4]) -> State {
        let (trial, det) = hencky_trial(state.tensor, l);
        let jacobian = state.jacobian * det;
        let [xx, yy, zz, xy] = trial;
        let mean = (xx + yy + zz) * (1.0 / 3.0);
        let (dx, dy, dz) = (xx - mean, yy - mean, zz - mean);
        let norm2 = dx * dx + dy * dy + dz * dz + 2.0 * (xy * xy);
        let factor = if KIRCHHOFF { 1.0 } else { jacobian };
        // q^2 = 6 G^2 e:e
        let q2 = 6.0 * soil.shear * soil.shear * norm2;
        let flow = radial_return(soil, cohesion, state.plastic, q2, factor);
        let r = flow.removed;
        let tensor = [xx - r * dx, yy - r * dy, zz - r * dz, xy - r * xy];
        State { tensor, jacobian, plastic: flow.plastic }
    }

    #[inline(always)]
    fn resultant(soil: &Soil, volume: f64, state: &State) -> [f64; 3] {
        // Cauchy stress times current volume is Kirchhoff stress times reference volume.
        let [xx, yy, zz, xy] = state.tensor;
        let p = volume * soil.lame * (xx + yy + zz);
        let g = volume * (2.0 * soil.shear);
        [p + g * xx, p + g * yy, g * xy]
    }
}

impl<const KIRCHHOFF: bool> Law for Rate<KIRCHHOFF> {
    #[inline(always)]
    fn update(soil: &Soil, cohesion: [f64; 2], state: State, l: [f64; 4]) -> State {
        let [lxx, lxy, lyx, lyy] = l;
        let jacobian = state.jacobian * (1.0 + (lxx + lyy + (lxx * lyy - lxy * lyx)));
        let [old_xx, old_yy, old_zz, old_xy] = state.tensor;
        let p = soil.lame * (lxx + lyy);
        let g = 2.0 * soil.shear;
        let spin = 0.5 * (lxy - lyx);
        let turn = 2.0 * spin * old_xy;
        let xx = old_xx + (p + g * lxx) + turn;
        let yy = old_yy + (p + g * lyy) - turn;
        let zz = old_zz + p;
        let xy = old_xy + soil.shear * (lxy + lyx) + spin * (old_yy - old_xx);
        let mean = (xx + yy + zz) * (1.0 / 3.0);
        let (dx, dy, dz) = (xx - mean, yy - mean, zz - mean);
        let q2 = 1.5 * (dx * dx + dy * dy + dz * dz + 2.0 * (xy * xy));
        let factor = if KIRCHHOFF { 1.0 / jacobian } else { 1.0 };
        let flow = radial_return(soil, cohesion, state.plastic, q2, factor);
        let r = flow.removed;
        let tensor = [xx - r * dx, yy - r * dy, zz - r * dz, xy - r * xy];
        State { tensor, jacobian, plastic: flow.plastic }
    }

    #[inline(always)]
    fn resultant(_: &Soil, volume: f64, state: &State) -> [f64; 3] {
        let v = volume * state.jacobian;
        let [xx, yy, _, xy] = state.tensor;
        [v * xx, v * yy, v * xy]
    }
}

struct Flow {
    /// Fraction of the deviator that the return takes away.
    removed: f64,
    plastic: f64,
}

/// Radial return to q = sqrt(3) `factor` c, with c falling linearly from peak to residual.
#[inline(always)]
fn radial_return(soil: &Soil, [peak, residual]: [f64; 2], plastic: f64, q2: f64, factor: f64) -> Flow {
    let c = (peak + soil.hardening * plastic).max(residual);
    let strength = factor * c;
    if q2 <= 3.0 * (strength * strength) {
        return Flow { removed: 0.0, plastic };
    }
    let k = 3f64.sqrt() * factor;
    let q = q2.sqrt();
    let stiff = 3.0 * soil.shear;
    let mut step = (q - k * c) * (1.0 / (stiff + k * soil.hardening));
    // The strength would pass its residual value inside this step.
    if c + soil.hardening * step < residual {
        step = (q - k * residual) * (1.0 / stiff);
    }
    Flow { removed: stiff * step * (1.0 / q), plastic: plastic + step }
}

/// Bounds inside which the polynomials are good to 2e-16 relative.
const TANHC_MAX: f64 = 0.0196;
const ATANHC_MAX: f64 = 0.0256;
const LOG_MAX: f64 = 0.02;

/// tanh(sqrt x) / sqrt x on [0, `TANHC_MAX`], Chebyshev economised.
#[inline(always)]
pub fn tanhc(x: f64) -> f64 {
    const A: [f64; 5] = [
        -0.333_333_333_332_976_6,
        0.133_333_333_120_861_1,
        -0.053_968_207_661_156_07,
        0.021_864_921_785_266_764,
        -0.008_655_126_948_342_552,
    ];
    1.0 + x * (A[0] + x * (A[1] + x * (A[2] + x * (A[3] + x * A[4]))))
}

/// artanh(sqrt y) / sqrt y on [0, `ATANHC_MAX`], Chebyshev economised.
#[inline(always)]
pub fn atanhc(y: f64) -> f64 {
    const A: [f64; 6] = [
        0.333_333_333_333_090_3,
        0.200_000_000_151_741_28,
        0.142_857_107_376_493_45,
        0.111_115_054_624_591_05,
        0.090_684_848_021_107_37,
        0.083_194_524_124_983_8,
    ];
    1.0 + y * (A[0] + y * (A[1] + y * (A[2] + y * (A[3] + y * (A[4] + y * A[5])))))
}

/// ln(1 + z) for |z| <= `LOG_MAX`: 2 artanh(z / (2 + z)).
#[inline(always)]
pub fn log1p(z: f64) -> f64 {
    let w = z / (2.0 + z);
    let s = w * w;
    let w = w + w;
    w + w * (s * (1.0 / 3.0 + s * (1.0 / 5.0 + s * (1.0 / 7.0))))
}

/// Trial elastic log strain 1/2 ln(F exp(2e) F^T) and det F, for F = I + `l`.
///
/// In the plane exp(2e) is, up to an isotropic factor, I + tanhc(|D|^2) D with D = dev 2e. With
/// B = F (I + tanhc D) F^T = m I + dev B, dev ln B = artanhc(|dev B|^2 / m^2) dev B / m, and the trace
/// of the strain grows by ln det F.
#[inline(always)]
pub fn hencky_trial(e: [f64; 4], l: [f64; 4]) -> ([f64; 4], f64) {
    let [lxx, lxy, lyx, lyy] = l;
    let dxx = e[0] - e[1];
    let dxy = e[3] + e[3];
    let x = dxx * dxx + dxy * dxy;
    let z = lxx + lyy + (lxx * lyy - lxy * lyx);
    let (m, a, b) = stretch(dxx, dxy, tanhc(x), l);
    let scale = 1.0 / m;
    let (a, b) = (a * scale, b * scale);
    let y = a * a + b * b;
    if !(x <= TANHC_MAX && y <= ATANHC_MAX && z.abs() <= LOG_MAX) {
        return hencky_trial_exact(e, l);
    }
    let half = 0.5 * atanhc(y);
    let mean = 0.5 * (e[0] + e[1] + log1p(z));
    ([mean + half * a, mean - half * a, e[2], half * b], 1.0 + z)
}

/// The same with library functions, for strains of any size.
#[cold]
#[inline(never)]
pub fn hencky_trial_exact(e: [f64; 4], l: [f64; 4]) -> ([f64; 4], f64) {
    let [lxx, lxy, lyx, lyy] = l;
    let dxx = e[0] - e[1];
    let dxy = 2.0 * e[3];
    let s = dxx.hypot(dxy);
    let z = lxx + lyy + (lxx * lyy - lxy * lyx);
    assert!(z > -1.0, "a point is turned inside out: det F = {}", 1.0 + z);
    let (m, a, b) = stretch(dxx, dxy, if s > 0.0 { s.tanh() / s } else { 1.0 }, l);
    let (a, b) = (a / m, b / m);
    let r = a.hypot(b);
    let half = if r > 0.0 { 0.5 * r.atanh() / r } else { 0.5 };
    let mean = 0.5 * (e[0] + e[1] + z.ln_1p());
    ([mean + half * a, mean - half * a, e[2], half * b], 1.0 + z)
}

/// Mean, (xx - yy) / 2 and xy of B = F (I + t D) F^T.
#[inline(always)]
fn stretch(dxx: f64, dxy: f64, t: f64, [lxx, lxy, lyx, lyy]: [f64; 4]) -> (f64, f64, f64) {
    let (p, pxy) = (t * dxx, t * dxy);
    let (pxx, pyy) = (1.0 + p, 1.0 - p);
    let (fxx, fyy) = (1.0 + lxx, 1.0 + lyy);
    let (axx, axy) = (fxx * pxx + lxy * pxy, fxx * pxy + lxy * pyy);
    let (ayx, ayy) = (lyx * pxx + fyy * pxy, lyx * pxy + fyy * pyy);
    let bxx = axx * fxx + axy * lxy;
    let byy = ayx * lyx + ayy * fyy;
    let bxy = axx * lyx + axy * fyy;
    (0.5 * (bxx + byy), 0.5 * (bxx - byy), bxy)
}
