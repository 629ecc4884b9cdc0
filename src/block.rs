//! A block of points in the hot stages, and the law over a block: material x kinematics.

use crate::{
    fault::{Fault, FaultKind},
    kinematics::{Kinematics, StrainRate, StrengthMeasure, Trial},
    material::{Columns, Material, Standing},
    math::{
        simd::{FpPath, Kernel},
        tensor::{Gradient, Voigt},
    },
    space::stencil::{LANES, Lane},
};

/// Most parameter columns of any law.
pub const MAX_PARAMS: usize = 8;
/// Most history columns of any law.
pub const MAX_STATES: usize = 2;

/// What the law reads and writes for the points of one block. Lanes past `len` hold harmless
/// numbers, so that the loops always run over all lanes.
#[repr(align(64))]
pub struct Block {
    /// Points in use.
    pub len: usize,
    /// Displacement gradient of the step: xx, xy, yx, yy.
    pub du: [Lane; 4],
    /// Committed elastic strain.
    pub strain: [Lane; 4],
    /// Committed J.
    pub jacobian: Lane,
    /// Elastic strain after the step.
    pub trial_strain: [Lane; 4],
    /// J after the step.
    pub trial_jacobian: Lane,
    /// Cauchy stress (kPa), out.
    pub stress: [Lane; 4],
    /// Parameters.
    pub param: [Lane; MAX_PARAMS],
    /// Committed history.
    pub state: [Lane; MAX_STATES],
    /// History after the step.
    pub trial_state: [Lane; MAX_STATES],
    /// Plastic work of the step per initial volume (kPa), out.
    pub dissipation: Lane,
    /// 1 where the fast kinematics held and the result is sound, else 0.
    sound: Lane,
}

impl Default for Block {
    fn default() -> Self {
        Block {
            len: 0,
            du: [[0.0; LANES]; 4],
            strain: [[0.0; LANES]; 4],
            jacobian: [1.0; LANES],
            trial_strain: [[0.0; LANES]; 4],
            trial_jacobian: [1.0; LANES],
            trial_state: [[0.0; LANES]; MAX_STATES],
            stress: [[0.0; LANES]; 4],
            param: [[1.0; LANES]; MAX_PARAMS],
            state: [[0.0; LANES]; MAX_STATES],
            dissipation: [0.0; LANES],
            sound: [0.0; LANES],
        }
    }
}

impl Block {
    #[inline(always)]
    fn du(&self, i: usize) -> Gradient {
        Gradient { xx: self.du[0][i], xy: self.du[1][i], yx: self.du[2][i], yy: self.du[3][i] }
    }

    #[inline(always)]
    fn set_du(&mut self, i: usize, du: Gradient) {
        for (column, value) in self.du.iter_mut().zip([du.xx, du.xy, du.yx, du.yy]) {
            column[i] = value;
        }
    }

    #[inline(always)]
    fn strain(&self, i: usize) -> Voigt {
        Voigt::new(self.strain[0][i], self.strain[1][i], self.strain[2][i], self.strain[3][i])
    }

    #[inline(always)]
    fn trial_strain(&self, i: usize) -> Voigt {
        Voigt::from_array(std::array::from_fn(|c| self.trial_strain[c][i]))
    }

    #[inline(always)]
    fn set_trial_strain(&mut self, i: usize, e: Voigt) {
        for (column, value) in self.trial_strain.iter_mut().zip(e.to_array()) {
            column[i] = value;
        }
    }

    #[inline(always)]
    fn set_stress(&mut self, i: usize, s: Voigt) {
        for (column, value) in self.stress.iter_mut().zip(s.to_array()) {
            column[i] = value;
        }
    }
}

/// d(J sigma) / d l for each lane: rows xx, yy, xy, columns l_xx, l_xy, l_yx, l_yy.
pub type Moduli3 = [[Lane; 4]; 3];

/// The law of one material over a block. Made once, from any material and kinematics; the body
/// makes one virtual call per block.
pub trait Law: Send + Sync {
    /// Names of the parameter columns.
    fn params(&self) -> &'static [&'static str];

    /// Names of the history columns.
    fn states(&self) -> &'static [&'static str];

    /// Trial strain, return mapping, Cauchy stress. A fault names the lane in `point`.
    fn update(&self, block: &mut Block) -> Result<(), Fault>;

    /// As [`Law::update`], for who does not read the stress: `block.stress` is left as it is.
    fn advance(&self, block: &mut Block) -> Result<(), Fault>;

    /// d(J sigma) / d l at the step in the block, consistent with [`Law::update`]. Returns whether
    /// the tangent that follows is symmetric.
    fn linearise(&self, block: &Block, out: &mut Moduli3) -> bool;

    /// Whether strains are finite: gradients are then taken by the position after the step.
    fn finite(&self) -> bool;

    /// Dilatation of the step `block.du`, for each lane.
    fn dilatation(&self, block: &Block, out: &mut Lane);

    /// Changes the dilatation of the step `block.du` by `by`.
    fn dilate(&self, block: &mut Block, by: &Lane);

    /// Cauchy stress of the strain in the block.
    fn stress(&self, block: &mut Block);

    /// Speed of the compression wave (m/s) of lane `i` for a density (t/m3).
    fn wave_speed(&self, block: &Block, i: usize, density: f64) -> f64;

    /// Where lane `i` stands.
    fn standing(&self, block: &Block, i: usize) -> Standing;

    /// Elastic energy of lane `i` per initial volume (kPa).
    fn strain_energy(&self, block: &Block, i: usize) -> f64;

    /// Elastic strain of lane `i` that belongs to a Cauchy stress at its J.
    fn strain_of(&self, block: &Block, i: usize, cauchy: Voigt) -> Voigt;
}

/// Any material with any kinematics.
#[derive(Clone, Copy, Debug)]
pub struct PointLaw<M, K> {
    material: M,
    kinematics: std::marker::PhantomData<K>,
    measure: StrengthMeasure,
    path: FpPath,
}

impl<M: Material, K: Kinematics> PointLaw<M, K> {
    /// The law on the best instruction path of this processor.
    pub fn new(material: M, measure: StrengthMeasure) -> Self {
        PointLaw { material, kinematics: std::marker::PhantomData, measure, path: FpPath::best() }
    }

    /// The law on another path.
    pub fn on(self, path: FpPath) -> Self {
        PointLaw { path, ..self }
    }

    #[inline(always)]
    fn param(block: &Block, i: usize) -> M::Param {
        M::Param::read(|k| block.param[k][i])
    }

    #[inline(always)]
    fn state(block: &Block, i: usize) -> M::State {
        M::State::read(|k| block.state[k][i])
    }

    /// One point: return, and stress if wanted, all into the block's trial columns.
    #[inline(always)]
    fn point<const STRESS: bool>(&self, b: &mut Block, i: usize, trial: Trial) {
        let j = b.jacobian[i] * trial.jacobian;
        let (p, s) = (Self::param(b, i), Self::state(b, i));
        let u = self.material.update(&p, &s, trial.strain, K::strength_factor(self.measure, j));
        // a stress that is no number comes of a strain that is none, or of a flow that is none
        let mut sum = u.strain.xx + u.strain.yy + u.strain.zz + u.strain.xy + u.dissipation + j;
        if STRESS {
            let cauchy = u.stress * K::cauchy_factor(j);
            sum = cauchy.xx + cauchy.yy + cauchy.zz + cauchy.xy;
            b.set_stress(i, cauchy);
        }
        let sound = trial.inside & (trial.jacobian > 0.0) & (sum.abs() < f64::MAX);
        b.sound[i] = if sound { 1.0 } else { 0.0 };
        b.set_trial_strain(i, u.strain);
        b.dissipation[i] = u.dissipation * K::energy_volume(j);
        u.state.write(|k, v| b.trial_state[k][i] = v);
        b.trial_jacobian[i] = j;
    }

    /// A lane that the fast path refused: computed from its committed values by the library
    /// functions, or a fault.
    #[cold]
    fn mend(&self, b: &mut Block, i: usize) -> Result<(), Fault> {
        let (e, du) = (b.strain(i), b.du(i));
        let trial = K::trial_exact(e, du);
        if trial.jacobian <= 0.0 {
            return Err(Fault::new(FaultKind::Inverted).with("det_f", trial.jacobian).at(i as u32, [f64::NAN; 2]));
        }
        self.point::<true>(b, i, trial);
        if b.sound[i] > 0.0 {
            return Ok(());
        }
        let fault = Fault::new(FaultKind::NonFinite)
            .with("det_f", trial.jacobian)
            .with("du_xx", du.xx)
            .with("du_yy", du.yy)
            .with("sigma_xx", b.stress[0][i])
            .with("sigma_yy", b.stress[1][i]);
        Err(fault.at(i as u32, [f64::NAN; 2]))
    }
}

struct UpdateKernel<'a, M, K, const STRESS: bool> {
    law: &'a PointLaw<M, K>,
    block: &'a mut Block,
}

impl<M: Material, K: Kinematics, const STRESS: bool> Kernel for UpdateKernel<'_, M, K, STRESS> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let (law, b) = (self.law, self.block);
        // two short loops overlap better in the processor than one long one
        let mut volume = [0.0; LANES];
        let mut inside = [0.0; LANES];
        for i in 0..LANES {
            let trial = K::trial(b.strain(i), b.du(i));
            b.set_trial_strain(i, trial.strain);
            volume[i] = trial.jacobian;
            inside[i] = if trial.inside { 1.0 } else { 0.0 };
        }
        for i in 0..LANES {
            law.point::<STRESS>(
                b,
                i,
                Trial { strain: b.trial_strain(i), jacobian: volume[i], inside: inside[i] > 0.0 },
            );
        }
        let sound: f64 = b.sound[..b.len].iter().fold(1.0, |a, &v| if v < a { v } else { a });
        if sound > 0.0 {
            return Ok(());
        }
        for i in 0..b.len {
            if b.sound[i] == 0.0 {
                law.mend(b, i)?;
            }
        }
        Ok(())
    }
}

struct StressKernel<'a, M, K> {
    law: &'a PointLaw<M, K>,
    block: &'a mut Block,
}

impl<M: Material, K: Kinematics> Kernel for StressKernel<'_, M, K> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let b = self.block;
        for i in 0..LANES {
            let p = PointLaw::<M, K>::param(b, i);
            let s = self.law.material.stress(&p, b.strain(i)) * K::cauchy_factor(b.jacobian[i]);
            b.set_stress(i, s);
        }
    }
}

struct TangentKernel<'a, M, K> {
    law: &'a PointLaw<M, K>,
    block: &'a Block,
    out: &'a mut Moduli3,
}

impl<M: Material, K: Kinematics> Kernel for TangentKernel<'_, M, K> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let mut symmetric = true;
        for i in 0..self.block.len {
            let (moduli, own) = self.law.point_moduli(self.block, i);
            symmetric &= own;
            for (row, from) in self.out.iter_mut().zip([0, 1, 3]) {
                for (column, k) in row.iter_mut().zip(0..4) {
                    column[i] = moduli[(from, k)];
                }
            }
        }
        symmetric
    }
}

impl<M: Material, K: Kinematics> PointLaw<M, K> {
    /// With s the law's stress, k = J x cauchy factor, f the strength factor and e the trial strain,
    /// ```text
    /// d(k s) / d l = k (ds/de de/dl + ds/df df/dlnJ tr) + s dk/dlnJ tr
    /// ```
    /// Without the terms with tr it leads to a symmetric tangent.
    #[inline(always)]
    fn point_moduli(&self, b: &Block, i: usize) -> (StrainRate, bool) {
        let (e, du) = (b.strain(i), b.du(i));
        let fast = K::trial(e, du);
        let trial = if fast.inside { fast } else { K::trial_exact(e, du) };
        let j = b.jacobian[i] * trial.jacobian;
        let (p, s) = (Self::param(b, i), Self::state(b, i));
        let factor = K::strength_factor(self.measure, j);
        let u = self.material.update(&p, &s, trial.strain, factor);
        let k = j * K::cauchy_factor(j);
        let mut out = self.material.tangent(&p, &u, factor) * K::strain_rate(e, trial.strain, du) * k;
        let by_strength = self.material.strength_sensitivity(&p, &u, factor);
        let by_volume = by_strength * (k * K::strength_slope(self.measure, j)) + u.stress * K::kirchhoff_slope(j);
        for (row, value) in by_volume.to_array().into_iter().enumerate() {
            out[(row, 0)] += value;
            out[(row, 3)] += value;
        }
        (out, by_volume == Voigt::default())
    }
}

impl<M: Material, K: Kinematics> Law for PointLaw<M, K> {
    fn params(&self) -> &'static [&'static str] {
        M::Param::NAMES
    }

    fn states(&self) -> &'static [&'static str] {
        M::State::NAMES
    }

    fn update(&self, block: &mut Block) -> Result<(), Fault> {
        self.path.run(UpdateKernel::<_, _, true> { law: self, block })
    }

    fn advance(&self, block: &mut Block) -> Result<(), Fault> {
        self.path.run(UpdateKernel::<_, _, false> { law: self, block })
    }

    fn linearise(&self, block: &Block, out: &mut Moduli3) -> bool {
        self.path.run(TangentKernel { law: self, block, out })
    }

    fn finite(&self) -> bool {
        K::FINITE
    }

    fn dilatation(&self, block: &Block, out: &mut Lane) {
        for i in 0..block.len {
            out[i] = K::dilatation(block.du(i));
        }
    }

    fn dilate(&self, block: &mut Block, by: &Lane) {
        for i in 0..block.len {
            let du = K::dilate(block.du(i), by[i]);
            block.set_du(i, du);
        }
    }

    fn stress(&self, block: &mut Block) {
        self.path.run(StressKernel { law: self, block });
    }

    fn wave_speed(&self, b: &Block, i: usize, density: f64) -> f64 {
        self.material.wave_speed(&Self::param(b, i), density)
    }

    fn standing(&self, b: &Block, i: usize) -> Standing {
        let factor = K::strength_factor(self.measure, b.jacobian[i]);
        self.material.standing(&Self::param(b, i), &Self::state(b, i), b.strain(i), factor)
    }

    fn strain_energy(&self, b: &Block, i: usize) -> f64 {
        let e = b.strain(i);
        0.5 * self.material.stress(&Self::param(b, i), e).dot(e) * K::energy_volume(b.jacobian[i])
    }

    fn strain_of(&self, b: &Block, i: usize, cauchy: Voigt) -> Voigt {
        let elasticity = crate::material::Elasticity::read(|k| b.param[k][i]);
        elasticity.strain(cauchy * (1.0 / K::cauchy_factor(b.jacobian[i])))
    }
}
