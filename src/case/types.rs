//! The resolved case: every key with its value, whether typed or defaulted.
//!
//! Serialising a [`Case`] gives a case file that parses to the same [`Case`]: that is the
//! `case.toml` which a run leaves in its folder. Units are kN, m, s, t (so kPa and kN/m3).

use std::collections::BTreeMap;

use serde::Serialize;

use super::random::{Ensemble, Field};

/// One problem, ready to be turned into a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// A line for people.
    pub title: String,
    /// Master seed of everything random in the case.
    pub seed: u64,
    pub grid: Grid,
    pub points: Points,
    pub solver: Solver,
    pub explicit: Explicit,
    pub implicit: Implicit,
    pub gravity: Gravity,
    pub initial_stress: InitialStress,
    pub damping: Damping,
    pub jitter: Jitter,
    pub end: End,
    pub output: Output,
    /// Sliding distance of a slope; `None` where the case has no crest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slide: Option<Slide>,
    /// Search for the factor of safety; `None`: one run with the strengths as given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength_reduction: Option<StrengthReduction>,
    pub boundary: Boundary,
    /// Materials by name.
    pub material: BTreeMap<String, Material>,
    /// Regions in the order of the file.
    pub region: Vec<Region>,
    /// Dead loads in the order of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub load: Vec<Load>,
    /// Prescribed motions in the order of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub drive: Vec<Drive>,
    /// Which realisation is run, and how many make an ensemble.
    pub ensemble: Ensemble,
    /// Random fields by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub field: BTreeMap<String, Field>,
}

/// The background grid: square cells.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Grid {
    /// Cell size h (m). The file may also give a fraction as text: "5/29".
    pub cell: f64,
    /// Lower left corner (m).
    pub origin: [f64; 2],
    /// Width and height (m); rounded up to whole cells.
    pub size: [f64; 2],
}

/// Where material points start.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Points {
    /// Positions inside a cell.
    pub layout: Layout,
    /// Points per cell and axis: n x n points per full cell.
    pub per_axis: usize,
    /// What happens in cells that a region covers only in part.
    pub cut_cells: CutCells,
}

/// Positions of the points inside a full cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Layout {
    /// Positions of the n-point Gauss rule on each axis, equal volumes.
    Gauss,
    /// Centres of n x n equal squares.
    Even,
}

/// The rule for cells that the outline of the soil cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CutCells {
    /// A cut cell is filled as if it were full (the paper's 1810 cells; a staircase surface).
    Full,
    /// Only the points inside the outline are kept, each with its full volume.
    Inside,
    /// As `inside`, with volumes scaled so that each cell holds its exact area of soil.
    Scaled,
}

/// Integrator, strain measure and the cure for locking.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solver {
    /// How time is stepped. Default `explicit`: its answers are the pinned ones.
    pub scheme: Scheme,
    /// What the strain means. Default `hencky`: exact for motions of any size.
    pub kinematics: Kinematics,
    /// Cure for volumetric locking. Default `none`: plain bilinear cells, as in the paper.
    pub locking: Locking,
    pub shape: ShapeFunctions,
}

/// How time is stepped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// Lumped mass, steps bound by the fastest wave.
    Explicit,
    /// Equilibrium at the end of each step, by Newton's method.
    Implicit,
}

/// Strain measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kinematics {
    /// Logarithmic elastic strain, updated Lagrangian.
    Hencky,
    /// Jaumann rate of the Cauchy stress (explicit only).
    Rate,
    /// Small strain: the points keep their places among the nodes (implicit only).
    Small,
}

/// Cure for volumetric locking.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Locking {
    /// None: bilinear cells are too stiff where the soil keeps its volume.
    None,
    /// Mean dilatation over each cell.
    BBar,
}

/// Shape functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ShapeFunctions {
    /// Bilinear, on the four nodes of a point's cell.
    Linear,
    /// Uniform GIMP on 3 x 3 nodes: domains up to a cell long.
    Gimp,
    /// Uniform GIMP on 4 x 4 nodes: domains up to two cells long.
    GimpWide,
}

/// Keys of the explicit scheme.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explicit {
    pub stress_update: StressUpdate,
    /// Rate (1/s) at which the particle velocity relaxes to the grid velocity (PIC); 0 is pure FLIP.
    pub pic_rate: f64,
    /// Safety factor on the Courant time step.
    pub courant: f64,
    /// A fixed time step (s) in place of the Courant step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_step: Option<f64>,
    /// Nodes lighter than this fraction of the mean point mass are accelerated as if they had
    /// it (never their velocity). 0 switches the floor off; MUSL does not need it.
    pub mass_floor: f64,
}

/// When stresses are updated within a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StressUpdate {
    /// Last, with velocities mapped back from the moved points (modified update-stress-last).
    Musl,
    /// Last, with the nodal velocities as they are (update-stress-last).
    Usl,
}

/// Keys of the implicit scheme.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Implicit {
    /// Default `auto`: a slope is in equilibrium until it fails, and then it is not.
    #[serde(flatten)]
    pub regime: Regime,
    /// First time step (s). Default 0.02: a ramp of gravity over 5 s in 250 steps, and ten times the
    /// explicit step of the paper's slope.
    pub time_step: f64,
    /// A step is not cut below this (s). Default time_step / 1024: ten halvings, as in the explicit
    /// scheme; what does not converge then will not.
    pub min_time_step: f64,
    /// A step does not grow beyond this (s). Default `time_step`: no growth, as the accuracy of a
    /// longer step is the user's to judge.
    pub max_time_step: f64,
    /// Local error of the displacement in a step, in cells, that chooses the time step between its
    /// bounds. Default none: only the number of iterations cuts the step and lets it grow back.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Converged: out-of-balance force over the norm of external forces and reactions. Default 1e-9:
    /// one iteration of Newton's method beyond 1e-5, and well above rounding.
    pub residual: f64,
    /// Converged as well: out-of-balance force below this (kN/m). Default none: the integrator takes
    /// a share of the weight, for steps in which nothing pulls.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub absolute_residual: Option<f64>,
    /// Iterations after which a step is refused and cut. Default 12: convergence is quadratic, and a
    /// step that takes more is cheaper in two halves.
    pub max_iterations: usize,
    /// Shorten an iteration that raises the out-of-balance force. Default true: it costs nothing where
    /// full iterations do well.
    pub line_search: bool,
    /// Rate (1/s) at which the particle velocity relaxes to the grid velocity (PIC); 0 is pure FLIP.
    /// Default 0.5, as in the explicit scheme.
    pub pic_rate: f64,
    /// Order of elimination. Default `auto`: by the number of unknowns.
    pub ordering: Ordering,
    /// Solver of unsymmetric systems (friction). Default `auto`: by the number of unknowns.
    pub unsymmetric: Unsymmetric,
    /// gamma_K, stiffness of the ghost penalty on the faces of boundary cells. Default 0, off: direct
    /// solvers do without. 0.01 bounds the condition of the matrix and changes stresses by less than the
    /// cells do (`rmpm validate cut-cell`).
    pub ghost_stiffness: f64,
    /// gamma_M, mass of the ghost penalty, where there is inertia. Default 0, off: as above.
    pub ghost_mass: f64,
}

/// Whether and how inertia acts. The tag is the key `regime`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "regime", rename_all = "snake_case")]
pub enum Regime {
    /// Quasi-static until the body loses stability, then with inertia.
    Auto {
        #[serde(flatten)]
        inertia: Inertia,
    },
    /// No inertia at any time.
    QuasiStatic,
    /// Newmark's method, beta = 1/4 and gamma = 1/2: no damping of its own.
    Newmark,
    /// Hilber, Hughes & Taylor (1977): the highest modes are damped.
    Hht { hht_alpha: f64 },
    /// Backward Euler: all modes are damped that the step does not resolve.
    BackwardEuler,
}

impl Regime {
    /// The integrator of the motion; `None` where inertia never acts.
    pub fn inertia(self) -> Option<Inertia> {
        match self {
            Regime::Auto { inertia } => Some(inertia),
            Regime::QuasiStatic => None,
            Regime::Newmark => Some(Inertia::Newmark),
            Regime::Hht { hht_alpha } => Some(Inertia::Hht { hht_alpha }),
            Regime::BackwardEuler => Some(Inertia::BackwardEuler),
        }
    }

    /// The word of the case file.
    pub fn word(self) -> &'static str {
        match self {
            Regime::Auto { .. } => "auto",
            Regime::QuasiStatic => "quasi_static",
            Regime::Newmark => "newmark",
            Regime::Hht { .. } => "hht",
            Regime::BackwardEuler => "backward_euler",
        }
    }
}

/// The integrator that `auto` brings in. The tag is the key `inertia`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "inertia", rename_all = "snake_case")]
pub enum Inertia {
    BackwardEuler,
    /// The default: second order, and what a slide loses is then the soil's, not the method's.
    Newmark,
    /// `hht_alpha`, from 0 (Newmark) to 1/3, is 0.1 by default: little loss in the modes that
    /// the step resolves.
    Hht {
        hht_alpha: f64,
    },
}

/// Order of elimination of a sparse factorisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ordering {
    Auto,
    /// Approximate minimum degree.
    Amd,
    NestedDissection,
}

/// Solver of unsymmetric systems.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unsymmetric {
    Auto,
    /// A factorisation of its own.
    Lu,
    /// Iterations, preconditioned by the factorised symmetric part.
    Gmres,
}

/// Gravity: direction and history.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gravity {
    /// g (m/s2); also turns unit weights into densities.
    pub acceleration: f64,
    /// Angle (degrees) by which gravity leans from straight down towards +x: an incline.
    pub tilt: f64,
    #[serde(flatten)]
    pub schedule: GravitySchedule,
}

/// How gravity is brought on. The tag is the key `schedule`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "schedule", rename_all = "snake_case")]
pub enum GravitySchedule {
    /// No gravity.
    None,
    /// Full from the first step.
    AtOnce,
    /// Grows linearly from 0 to full over `ramp_time` (s).
    Ramp { ramp_time: f64 },
    /// For inclines: the part normal to the base grows over `ramp_time`, the soil settles
    /// (with `settle_damping` as local damping) for `settle_time`, and the part along the base
    /// then grows over `tangential_time` (all s).
    NormalFirst { ramp_time: f64, settle_time: f64, settle_damping: f64, tangential_time: f64 },
    /// In-situ phase first: full gravity on an elastic body with `settle_damping` as local
    /// damping, ramped over `ramp_time` and held for `settle_time` (s); then displacements and
    /// velocities are set to zero and the materials may yield.
    ElasticFirst { ramp_time: f64, settle_time: f64, settle_damping: f64 },
}

/// Stress before the first step. The tag is the key `kind`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum InitialStress {
    None,
    /// sigma_yy = -unit weight x depth below the surface straight above, sigma_xx = sigma_zz = k0 sigma_yy.
    K0 {
        k0: f64,
    },
    /// The same Cauchy stress (kPa, tension positive) everywhere.
    Given {
        xx: f64,
        yy: f64,
        zz: f64,
        xy: f64,
    },
}

/// Damping of the motion, off by default.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Damping {
    /// Cundall's local damping: fraction of the out-of-balance force, against the velocity.
    pub local: f64,
    /// Viscous damping: force = -viscous x mass x velocity (1/s).
    pub viscous: f64,
}

/// A tiny random change of strength, to see how much of an answer is chance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Jitter {
    /// Largest relative change of a point's strength (0.0005 is +-0.05 %); 0 is off.
    pub strength: f64,
    /// Which of the jittered runs this is.
    pub realisation: u64,
}

/// When a run is over.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct End {
    /// Latest simulated time (s).
    pub time: f64,
    /// Whether the run may end earlier, at rest.
    pub at_rest: bool,
    /// At rest: nodal kinetic energy below this fraction of its maximum ...
    pub rest_energy: f64,
    /// ... and the sliding distance unchanged for this long (s).
    pub rest_hold: f64,
    /// The run ends when the soil has moved so far since the onset of failure (m). Default in small strain: the
    /// last of `slide.initial_levels`, as nothing beyond it is meant; otherwise none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after_failure: Option<f64>,
}

/// What is written, and how often.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Output {
    /// Interval of rows in history.csv (s).
    pub history: f64,
    /// Interval of frames (s).
    pub frames: f64,
    /// Times of the pictures (s); empty: a choice of six over the run.
    pub pictures: Vec<f64>,
}

/// How the sliding distance is read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Slide {
    /// The crest: x and y (m) of the top of the slope. Default: the right end of the highest
    /// outline of the regions.
    pub crest: [f64; 2],
    /// Horizontal displacement (m) from which a point of the surface counts as slid.
    pub threshold: f64,
    /// Further displacement thresholds (m), reported beside the first.
    pub also: Vec<f64>,
    /// r above this (m) has reached the wall: the slide is flagged as censored.
    pub censored_above: f64,
    /// A plateau of r(t) is a block when r stays the same for this long (s) ...
    pub block_hold: f64,
    /// ... and the block is at least this long (m).
    pub block_length: f64,
    /// Displacements since the onset of failure (m), rising, at which the initial failure is classified. Default
    /// 0.25, 0.5, 1: from the first motion that no settlement explains to where the first block has parted.
    pub initial_levels: Vec<f64>,
    /// The one of them (m) at which a run of small strain reads sliding distance and volume, as what moved before
    /// the onset is settlement. Default: the middle one.
    pub initial_level: f64,
    /// Where there is inertia from the start, failure begins when the nodal kinetic energy comes above this share
    /// of the external work, and stays above it until the lowest level is reached. Default 0.01: the waves of a
    /// slow ramp fall below it long before the soil yields, and a slide passes it within centimetres.
    pub onset_energy: f64,
}

/// The factor of safety: the strengths of all materials, divided by it, are those with which the slope just fails.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StrengthReduction {
    /// A factor with which the slope stands. Default 0.5.
    pub low: f64,
    /// A factor with which it fails. Default 4.
    pub high: f64,
    /// Width of the bracket at which the search ends. Default 0.005: half of the last digit in which factors of
    /// safety are given.
    pub tolerance: f64,
}

/// The four sides of the grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Boundary {
    pub left: Side,
    pub right: Side,
    pub base: Side,
    pub top: Side,
}

/// Support along one side of the grid. The tag is the key `kind`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Side {
    /// Nothing: a point that reaches the side ends the run with a clear fault.
    Free,
    /// No motion across the side, free motion along it.
    Roller,
    /// No motion.
    Fixed,
    /// Coulomb friction at the nodes, |f_t| <= coefficient x f_n; with `separation` the soil
    /// may lift off, without it the side holds the soil in tension too.
    Friction { coefficient: f64, separation: bool },
}

/// A soil. The tag is the key `law`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "law", rename_all = "snake_case")]
pub enum Material {
    /// Isotropic linear elasticity (Hencky's in finite strain).
    Elastic {
        #[serde(flatten)]
        elastic: Elastic,
    },
    /// Von Mises with linear cohesion softening (eq. 4 of the paper).
    VonMises {
        #[serde(flatten)]
        elastic: Elastic,
        #[serde(flatten)]
        strength: Strength,
    },
}

impl Material {
    /// Weight and stiffness, which every law has.
    pub fn elastic(&self) -> &Elastic {
        match self {
            Material::Elastic { elastic } | Material::VonMises { elastic, .. } => elastic,
        }
    }
}

/// Weight and stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Elastic {
    /// Unit weight (kN/m3). The file may give `density` (t/m3) instead.
    pub unit_weight: f64,
    /// E (kPa).
    pub young_modulus: f64,
    /// nu.
    pub poisson_ratio: f64,
}

/// Strength of a von Mises soil.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Strength {
    /// Peak cohesion c0 (kPa).
    pub cohesion: f64,
    /// Residual cohesion c_r (kPa).
    pub residual_cohesion: f64,
    /// H (kPa), slope of cohesion over plastic strain; negative softens, 0 is perfectly plastic.
    pub softening_modulus: f64,
    /// k in q <= k c. sqrt(3): then c is the plane-strain shear strength.
    pub yield_constant: f64,
    pub strength_measure: StrengthMeasure,
}

/// The stress that the strength is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StrengthMeasure {
    /// q(sigma) <= k c.
    Cauchy,
    /// q(tau) <= k c, with tau = J sigma.
    Kirchhoff,
}

/// A part of the soil.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Region {
    pub name: String,
    /// Key of its material.
    pub material: String,
    #[serde(flatten)]
    pub shape: RegionShape,
    /// Initial velocity (m/s).
    pub velocity: [f64; 2],
    /// Initial rotation about a centre, added to `velocity`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spin: Option<Spin>,
    /// Initial standing wave, added to `velocity`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wave: Option<Wave>,
}

/// Outline of a region: the key `polygon` or the key `circle`.
pub use crate::math::outline::Outline as RegionShape;

/// v = rate x (x - center) turned by 90 degrees, counter-clockwise positive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spin {
    /// rad/s.
    pub rate: f64,
    pub center: [f64; 2],
}

/// v = amplitude sin(wave_number . x).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Wave {
    /// m/s.
    pub amplitude: [f64; 2],
    /// rad/m.
    pub wave_number: [f64; 2],
}

/// A dead load: a force on the points that start in a box, shared by their volumes; it keeps its
/// direction and goes with them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Load {
    /// Default: "load" with its number from 1.
    pub name: String,
    /// Lower left and upper right corner (m).
    #[serde(rename = "box")]
    pub area: [[f64; 2]; 2],
    /// Total force over the box (kN/m).
    pub force: [f64; 2],
    /// The force grows linearly from 0 over this time (s). Default 0: at once, as it is the
    /// force that is asked for.
    pub ramp_time: f64,
}

/// A prescribed motion of the grid nodes inside a box. Nodes on its edge are in it; where the box moves
/// away from them they are out of it at once, so a pull needs a margin of at least the way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drive {
    /// Default: "drive" with its number from 1.
    pub name: String,
    /// Lower left and upper right corner at the start (m).
    #[serde(rename = "box")]
    pub area: [[f64; 2]; 2],
    /// m/s. Default none: free along x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_x: Option<f64>,
    /// m/s. Default none: free along y.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_y: Option<f64>,
    /// Whether the box moves with its velocity. Default true: a footing stays with the soil below it.
    pub moving: bool,
    /// Time (s) from which the nodes are held where they are. Default none: they move on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until: Option<f64>,
}
