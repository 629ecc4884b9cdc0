//! What a body looks like at one time, in the fixed order of the points' identities.

use crate::math::tensor::Voigt;

/// State of all points at one time. Every vector has one entry per point, in the order of the
/// points' identities, so that entry `i` is the same point in every snapshot of a run.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Simulated time (s).
    pub time: f64,
    /// Steps done so far.
    pub step: u64,
    /// Current position (m).
    pub position: Vec<[f64; 2]>,
    /// Position at the start (m).
    pub reference: Vec<[f64; 2]>,
    /// Velocity (m/s).
    pub velocity: Vec<[f64; 2]>,
    /// Mass per metre of thickness (t/m).
    pub mass: Vec<f64>,
    /// Initial volume per metre of thickness (m3/m); a point is drawn as a square of this area.
    pub initial_volume: Vec<f64>,
    /// Current volume per initial volume.
    pub jacobian: Vec<f64>,
    /// Cauchy stress (kPa, tension positive).
    pub stress: Vec<Voigt>,
    /// Accumulated plastic shear strain invariant.
    pub plastic_strain: Vec<f64>,
    /// Current cohesion c (kPa); NaN for a material without strength.
    pub strength: Vec<f64>,
    /// Peak cohesion c0 (kPa); NaN for a material without strength.
    pub peak_strength: Vec<f64>,
    /// Stage of the law.
    pub stage: Vec<Stage>,
    /// Index of the material.
    pub material: Vec<u16>,
    /// Elastic strain energy per metre of thickness (kJ/m).
    pub strain_energy: Vec<f64>,
}

impl Snapshot {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Displacement of point `i` since the start (m).
    pub fn displacement(&self, i: usize) -> [f64; 2] {
        let (x, x0) = (self.position[i], self.reference[i]);
        [x[0] - x0[0], x[1] - x0[1]]
    }
}

/// Stage of the constitutive law at a point (Fig. 8(b) of the paper).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Stage {
    /// Has never yielded.
    #[default]
    Elastic = 0,
    /// Has yielded before, is below the yield surface now.
    Unloading = 1,
    /// Yields, strength still falling.
    Softening = 2,
    /// Yields at the residual strength.
    Residual = 3,
}
