//! Effects on the nodes. A scene lists the effects it calls for; an absent effect is not in the
//! list, owns no array and does no work.

pub mod body_force;
pub mod damping;
pub mod drive;
pub mod friction;
pub mod ghost;
pub mod gravity;
pub mod inertia;
pub mod load;
pub mod support;

pub use body_force::BodyForce;
pub use damping::{LocalDamping, ViscousDamping};
pub use drive::Drive;
pub use friction::Friction;
pub use ghost::Ghost;
pub use gravity::{Gravity, Schedule};
pub use inertia::{Inertia, TimeScheme};
pub use load::Load;
pub use support::Support;

use self::inertia::Motion;
use crate::{body::Body, nodes::Nodes, space::Grid, system::System};

/// Where a step stands in time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// Time at the start of the step (s).
    pub time: f64,
    /// Length of the step (s).
    pub dt: f64,
}

/// Which nodal velocity is constrained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// The velocity that moves the points.
    Update,
    /// The velocity mapped back from the moved points, which strains them (MUSL).
    Remap,
}

/// Which stages of a step an effect takes part in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stages {
    /// Looks at the points, before the forces.
    pub survey: bool,
    /// Gives forces to the points, and books them when the points have moved.
    pub load: bool,
    pub force: bool,
    pub constrain: bool,
    pub account: bool,
    /// Implicit scheme: adds to residual and tangent itself, in place of `force`.
    pub residual: bool,
    /// Implicit scheme: couples nodes that no point couples.
    pub couple: bool,
}

/// Running totals of what an effect has done to the body, per metre of thickness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Work done on the body from outside (kJ/m).
    pub external: f64,
    /// Energy taken out for good (kJ/m).
    pub dissipated: f64,
    /// Impulse on the body (kN s/m).
    pub impulse: [f64; 2],
}

impl Totals {
    /// Adds what one step did.
    pub fn add(&mut self, step: &Totals) {
        self.external += step.external;
        self.dissipated += step.dissipated;
        self.impulse[0] += step.impulse[0];
        self.impulse[1] += step.impulse[1];
    }
}

/// Totals in two parts: committed steps, and the step under way, which may yet be refused.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ledger {
    committed: Totals,
    /// The step under way.
    pub step: Totals,
}

impl Ledger {
    /// Starts a step; what a refused step left is forgotten.
    pub fn begin(&mut self) {
        self.step = Totals::default();
    }

    /// Accepts the step.
    pub fn commit(&mut self) {
        self.committed.add(&self.step);
        self.step = Totals::default();
    }

    /// Totals of the accepted steps.
    pub fn totals(&self) -> Totals {
        self.committed
    }
}

/// Under which head the energy that an effect dissipates is reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sink {
    /// Sliding on a side.
    Friction,
    /// Damping of the motion.
    Damping,
    /// It dissipates nothing.
    None,
}

/// One effect. Its stages are asked for once; it is then called only in those.
pub trait Effect: Send {
    /// Name in the record.
    fn name(&self) -> &'static str;

    /// The stages it takes part in.
    fn stages(&self) -> Stages;

    /// Where its dissipation is reported.
    fn sink(&self) -> Sink {
        Sink::None
    }

    /// Looks at the points before the nodes move.
    fn survey(&mut self, _body: &Body, _grid: &Grid) {}

    /// Gives forces to points: `push` takes the index of a point in the body and its force (kN/m). The
    /// integrator spreads them to the nodes with the points' shape functions.
    fn load(&mut self, _body: &Body, _clock: Clock, _push: &mut dyn FnMut(usize, [f64; 2])) {}

    /// Reads the way of the points, from the committed to the trial position, for the work of a load.
    fn account_points(&mut self, _body: &Body, _clock: Clock) {}

    /// Adds to the nodal forces.
    fn force(&mut self, _nodes: &mut Nodes, _clock: Clock) {}

    /// Corrects the nodal velocity of a pass.
    fn constrain(&mut self, _nodes: &mut Nodes, _pass: Pass, _clock: Clock) {}

    /// Reads the final nodal velocity for its energy.
    fn account(&mut self, _nodes: &Nodes, _clock: Clock) {}

    /// Implicit scheme: looks at the points and couples nodes beyond those that share a point, before
    /// the structure of a step is fixed. In small strain that is once.
    fn couple(&mut self, _body: &Body, _nodes: &Nodes, _system: &mut System) {}

    /// Implicit scheme: adds to the residual and to the tangent at the present
    /// increment. `motion` gives the accelerations where there is inertia.
    fn residual(&mut self, _nodes: &Nodes, _clock: Clock, _motion: Option<Motion<'_>>, _system: &mut System) {}

    /// Implicit scheme, in place of `constrain`: holds unknowns, or lets them slide. `iteration`
    /// counts from 0 in each step. Returns how many of its choices have changed.
    fn hold(&mut self, _nodes: &Nodes, _clock: Clock, _system: &mut System, _iteration: u32) -> u32 {
        0
    }

    /// Implicit scheme: contacts of the step that were left as they were, since their states refuted
    /// each other to the end.
    fn frozen(&self) -> u64 {
        0
    }

    /// Implicit scheme: the step has converged; books what holding has done.
    fn settle(&mut self, _nodes: &Nodes, _clock: Clock, _system: &System) {}

    /// Its books.
    fn ledger(&self) -> &Ledger;

    /// Its books, to write in.
    fn ledger_mut(&mut self) -> &mut Ledger;
}

/// The velocity columns that a pass constrains.
pub fn velocity_of(nodes: &mut Nodes, pass: Pass) -> &mut [Vec<f64>; 2] {
    match pass {
        Pass::Update => &mut nodes.velocity,
        Pass::Remap => &mut nodes.strain_velocity,
    }
}
