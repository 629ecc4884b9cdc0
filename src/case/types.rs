//! The resolved case: every key with its value, whether typed or defaulted.
//!
//! Serialising a [`Case`] gives a case file that parses to the same [`Case`]: that is the
//! `case.toml` which a run leaves in its folder. Units are kN, m, s, t (so kPa and kN/m3).

use std::collections::BTreeMap;

use serde::Serialize;

use super::{
    probe::Probe,
    random::{Ensemble, Field},
    scheme::{Explicit, Guard, Implicit, Solver},
    soil::Material,
};

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
    pub guard: Guard,
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
    /// Places that are looked at when the run is over, in the order of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub probe: Vec<Probe>,
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
