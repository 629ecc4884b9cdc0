//! Types of `[solver]`, `[explicit]`, `[implicit]` and `[guard]`.

use serde::{Serialize, Serializer};

/// Integrator, strain measure and the cure for locking.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solver {
    /// How time is stepped. Default `explicit`: its answers are the pinned ones.
    pub scheme: Scheme,
    /// What the strain means. Default `hencky`: exact for motions of any size.
    pub kinematics: Kinematics,
    /// Cure for volumetric locking. Default `none`: plain bilinear cells, as in the paper.
    pub locking: Locking,
    /// Shape functions. Default `linear`: those of the paper, and the cheapest.
    pub shape: ShapeFunctions,
    /// From the grid back to the points. Default `flip`, with the `pic_rate` of the scheme: the pinned
    /// answers are its.
    #[serde(flatten)]
    pub transfer: Transfer,
}

/// What the velocity of the points becomes of. The tag is the key `transfer`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "transfer", rename_all = "snake_case")]
pub enum Transfer {
    /// What the nodes gain is added to what the points have; a rate of PIC takes the noise out.
    Flip,
    /// Points take the velocity of the nodes and carry its gradient, so that its linear part is not
    /// lost. Angular momentum is kept; 64 bytes a point more.
    Apic,
    /// Points keep of their velocity what `xpic_order` - 1 maps to the nodes and back leave: 1 is PIC,
    /// many are FLIP.
    Xpic {
        /// From 1 to 10, by default 5: a motion of which a map leaves 80 % then loses 0.2^5 = 0.03 % a step,
        /// where 2 takes 4 % and each passes over the points once more.
        xpic_order: u32,
    },
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
    /// Quadratic B-splines on 3 x 3 nodes: as GIMP with domains that stay a cell long.
    Bspline,
}

impl ShapeFunctions {
    /// All of them.
    pub const ALL: [ShapeFunctions; 4] =
        [ShapeFunctions::Linear, ShapeFunctions::Gimp, ShapeFunctions::GimpWide, ShapeFunctions::Bspline];

    /// The word of the case file.
    pub fn word(self) -> &'static str {
        match self {
            ShapeFunctions::Linear => "linear",
            ShapeFunctions::Gimp => "gimp",
            ShapeFunctions::GimpWide => "gimp_wide",
            ShapeFunctions::Bspline => "bspline",
        }
    }
}

/// Keys of the explicit scheme.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explicit {
    pub stress_update: StressUpdate,
    /// Rate (1/s) at which the particle velocity relaxes to the grid velocity (PIC); 0 is pure FLIP. A key
    /// of `transfer = "flip"`, none with another. Default 0.5.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pic_rate: Option<f64>,
    /// Safety factor on the Courant time step.
    pub courant: f64,
    /// A fixed time step (s) in place of the Courant step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_step: Option<f64>,
    /// Nodes lighter than this fraction of the mean point mass are accelerated as if they had
    /// it (never their velocity). 0 switches the floor off: the default of MUSL, which does not need it.
    /// Default 1e-3 with USL, and 1e-2 with APIC, which gives light nodes their velocity back whole: at 1e-3
    /// they made 27 % of the energy of the paper's slope on bilinear cells of 0.5 m, at 1e-2 to 0.1 none.
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
    /// Rate (1/s) at which the particle velocity relaxes to the grid velocity (PIC); 0 is pure FLIP. A key
    /// of `transfer = "flip"`, none with another. Default 0.5, as in the explicit scheme.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pic_rate: Option<f64>,
    /// Order of elimination. Default `auto`: by the number of unknowns.
    pub ordering: Ordering,
    /// Solver of symmetric systems (no friction, strength by Kirchhoff stress). Default `auto`: conjugate gradients where
    /// few iterations are expected, as in steps of a Courant number of some units; they measure faster there.
    pub symmetric: Symmetric,
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

/// Solver of symmetric systems.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Symmetric {
    Auto,
    /// A factorisation.
    Direct,
    /// Conjugate gradients with an incomplete factor, and a factorisation where these fail.
    Pcg,
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

/// Levels of the drift of the energy: the larger of what the books cannot explain and of what the scheme has made, over
/// the largest energy supplied so far. It is looked at every 256 explicit steps, after every implicit step and at the end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Guard {
    /// From here on the record warns; `false`: never. Default 0.02: the integration in time leaves 0.9 to 1.5 % on slopes
    /// that fail, with bilinear functions at the default step (half of it at half the step, 0.02 % with GIMP).
    #[serde(serialize_with = "level")]
    pub warning: Option<f64>,
    /// From here on the run ends with a fault; `false`: never. Default 0.1: a tenth of the energy decides how far a slide
    /// goes, and an instability, which grows with each step, passes from 2 to 10 % at once.
    #[serde(serialize_with = "level")]
    pub fault: Option<f64>,
}

fn level<S: Serializer>(level: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    match level {
        Some(share) => serializer.serialize_f64(*share),
        None => serializer.serialize_bool(false),
    }
}
