//! The passes of a step over a body in parts, side by side on the threads of a team.
//!
//! A part brings its sums to nodes of its own, which are added to those of the body in the order of the parts: what comes
//! of it does not depend on the number of threads. The parts follow from the body alone ([`part::parts`]).

use std::ops::Range;

use crate::{
    assembly::{BodyRuns, Scatter, Scratch, Strain},
    body::{Body, Part, part},
    fault::Fault,
    math::{simd::FpPath, team::Team},
    nodes::{Nodes, add, copy},
    space::{Grid, Shape},
    step::load::{PointForces, Spread},
    transfer::{Carrier, Push, Transfer},
};

/// The parts of a body, and who works on them.
pub struct Crew<S, const N: usize> {
    shape: S,
    path: FpPath,
    team: Team,
    parts: Vec<Share<N>>,
    desks: Vec<Desk<N>>,
}

/// What is kept of a part from pass to pass.
struct Share<const N: usize> {
    stretch: Range<usize>,
    runs: BodyRuns<N>,
    /// The active number in the body of each node of the part.
    map: Vec<u32>,
}

/// Where a part is worked on: buffers that hold nothing between two passes.
struct Desk<const N: usize> {
    scratch: Box<Scratch<N>>,
    /// Nodes of the part. None is active between two passes, and the sums are zero.
    nodes: Nodes,
}

impl<const N: usize> Desk<N> {
    /// A pass over a part by its runs, with room for its nodes.
    fn pass<R>(&mut self, share: &mut Share<N>, work: impl FnOnce(&mut Scratch<N>, &mut Nodes, &[u32]) -> R) -> R {
        std::mem::swap(&mut self.scratch.runs, &mut share.runs);
        self.nodes.reach(share.map.len());
        let result = work(&mut self.scratch, &mut self.nodes, &share.map);
        std::mem::swap(&mut self.scratch.runs, &mut share.runs);
        result
    }
}

/// Adds the sums of a part to those of the body, and clears them.
fn hand_over(whole: &mut [Vec<f64>; 2], part: &mut [Vec<f64>; 2], map: &[u32]) {
    for (whole, part) in whole.iter_mut().zip(part) {
        add(whole, part, map);
        part[..map.len()].fill(0.0);
    }
}

/// Gives a part the columns of the body at its nodes.
fn hand_out(part: &mut [Vec<f64>; 2], whole: &[Vec<f64>; 2], map: &[u32]) {
    part.iter_mut().zip(whole).for_each(|(part, whole)| copy(part, whole, map));
}

impl<S: Shape<N>, const N: usize> Crew<S, N> {
    /// A crew for a body of more than one part; `None` where it is one.
    pub fn of(body: &Body, grid: Grid, shape: S, path: FpPath) -> Option<Self> {
        let share = |stretch| Share { stretch, runs: BodyRuns::default(), map: Vec::new() };
        let parts: Vec<_> = part::parts(body).into_iter().map(share).collect();
        let mut crew = Crew { shape, path, team: Team::default(), parts, desks: Vec::new() };
        crew.join(grid, Team::default());
        (crew.parts.len() > 1).then_some(crew)
    }

    /// Puts the crew on the threads of a team; how many of them find work.
    pub fn join(&mut self, grid: Grid, team: Team) -> usize {
        let desk = |_| Desk { scratch: Box::default(), nodes: Nodes::new(grid) };
        self.desks = (0..team.desks().min(self.parts.len())).map(desk).collect();
        self.team = team;
        self.team.threads().min(self.parts.len())
    }

    /// Runs of equal nodes of the body.
    pub fn runs(&self) -> u64 {
        self.parts.iter().map(|p| p.runs.len() as u64).sum()
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let maps: usize = self.parts.iter().map(|p| p.runs.bytes() + 4 * p.map.capacity()).sum();
        let desks: usize = self.desks.iter().map(|d| size_of::<Scratch<N>>() + d.nodes.bytes()).sum();
        maps + desks
    }

    /// [`Scatter`] of the body. Nodes become active in the order of the parts.
    pub fn scatter(&mut self, body: &Body, nodes: &mut Nodes) {
        let Crew { shape, path, team, parts, desks } = self;
        let work = |desk: &mut Desk<N>, share: &mut Share<N>| {
            let stretch = share.stretch.clone();
            desk.pass(share, |scratch, nodes, _| {
                path.run(Scatter { scratch, body, nodes, cells: None, stretch, shape: *shape });
            });
        };
        let take = |desk: &mut Desk<N>, share: &mut Share<N>| nodes.adopt(&mut desk.nodes, &mut share.map);
        team.in_order(desks, parts.iter_mut(), |desk, share| (work(desk, share), share).1, take);
    }

    /// [`Spread`] of the forces on the points.
    pub fn spread_loads(&mut self, body: &Body, nodes: &mut Nodes, forces: &PointForces) {
        let Crew { shape, path, team, parts, desks } = self;
        let work = |desk: &mut Desk<N>, share: &mut Share<N>| {
            let stretch = share.stretch.clone();
            desk.pass(share, |scratch, nodes, _| {
                path.run(Spread { scratch, body, nodes, forces, stretch, shape: *shape });
            });
        };
        let take =
            |desk: &mut Desk<N>, share: &mut Share<N>| hand_over(&mut nodes.force, &mut desk.nodes.force, &share.map);
        team.in_order(desks, parts.iter_mut(), |desk, share| (work(desk, share), share).1, take);
    }

    /// [`Push`] of the body, by a rule that needs no passes of its own.
    ///
    /// # Errors
    /// The first fault in the order of the parts.
    pub fn push(
        &mut self,
        body: &mut Body,
        nodes: &mut Nodes,
        transfer: Transfer,
        dt: f64,
        remap: bool,
    ) -> Result<(), Fault> {
        let Crew { shape, path, team, parts, desks } = self;
        let mut momentum = std::mem::take(&mut nodes.momentum);
        let whole: &Nodes = nodes;
        let mut outcome = Ok(());
        body.apart(|body, mut trial| {
            let jobs = parts.iter_mut().map(|share| {
                let part = trial.take_front(share.stretch.len());
                (share, part)
            });
            let work = |desk: &mut Desk<N>, share: &mut Share<N>, part| {
                desk.pass(share, |scratch, nodes, map| {
                    hand_out(&mut nodes.velocity, &whole.velocity, map);
                    hand_out(&mut nodes.old_velocity, &whole.old_velocity, map);
                    let pass = Push { scratch, body, part, nodes, dt, remap, shape: *shape };
                    Carrier::new(transfer).push(pass, *path)
                })
            };
            let take = |desk: &mut Desk<N>, (share, result): (&mut Share<N>, Result<(), Fault>)| {
                hand_over(&mut momentum, &mut desk.nodes.momentum, &share.map);
                if outcome.is_ok() {
                    outcome = result;
                }
            };
            team.in_order(
                desks,
                jobs,
                |desk, (share, part)| {
                    let r = work(desk, share, part);
                    (share, r)
                },
                take,
            );
        });
        nodes.momentum = momentum;
        outcome
    }

    /// [`Strain`] of the body; the plastic work (kJ/m), summed in the order of the parts.
    ///
    /// # Errors
    /// The first fault in that order.
    pub fn strain(&mut self, body: &mut Body, nodes: &Nodes, dt: f64) -> Result<f64, Fault> {
        let Crew { shape, path, team, parts, desks } = self;
        let mut outcome = Ok(0.0);
        body.apart(|body, mut trial| {
            let jobs = parts.iter_mut().map(|share| {
                let part = trial.take_front(share.stretch.len());
                (share, part)
            });
            let work = |desk: &mut Desk<N>, (share, part): (&mut Share<N>, Part<'_>)| {
                desk.pass(share, |scratch, own, map| {
                    hand_out(&mut own.strain_velocity, &nodes.strain_velocity, map);
                    path.run(Strain { scratch, body, part, nodes: own, cells: None, dt, shape: *shape })
                })
            };
            let take = |_: &mut Desk<N>, plastic: Result<f64, Fault>| {
                if let Ok(sum) = &mut outcome {
                    match plastic {
                        Ok(plastic) => *sum += plastic,
                        Err(fault) => outcome = Err(fault),
                    }
                }
            };
            team.in_order(desks, jobs, work, take);
        });
        outcome
    }
}
