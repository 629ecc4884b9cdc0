//! The explicit integrator of Sulsky & Schreyer (1996): lumped mass, stresses updated last.

mod crew;

use std::marker::PhantomData;

use crew::Crew;

use crate::{
    assembly::{
        Scatter, Scratch, Strain,
        cells::CellMeans,
        nonlocal::{Average, Nonlocal, Soften},
        place,
    },
    body::{Body, chunks, load_varying, set_uniform},
    domain,
    effect::{Clock, Effect, Pass},
    fault::Fault,
    math::{
        simd::{FpPath, Kernel},
        team::Team,
    },
    nodes::Nodes,
    space::{Grid, Shape, Stencil},
    step::{
        Books, Integrator,
        flows::{self, Flows},
        load::{PointForces, Spread, gather},
    },
    transfer::{Carrier, Push, Transfer},
    work::Work,
};

/// When and with which velocity the points are strained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StressUpdate {
    /// With velocities mapped back from the moved points: light nodes do no harm.
    Musl,
    /// With the nodal velocities as they are.
    Usl,
}

/// Settings of the explicit integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    pub stress_update: StressUpdate,
    pub transfer: Transfer,
    /// Safety factor on the Courant step.
    pub courant: f64,
    /// Nodes lighter than this fraction of the mean point mass are accelerated as if they had it.
    pub mass_floor: f64,
    /// Whether the dilatation is smoothed over cells (B-bar).
    pub smooth: bool,
}

impl Settings {
    /// Whether the velocity that strains the points has been to the points and back and is smoother for it:
    /// not with USL, and not with APIC, which maps what is linear over a patch whole.
    fn smooths(&self) -> bool {
        self.stress_update == StressUpdate::Musl && self.transfer != Transfer::Apic
    }
}

/// The integrator for shapes with `N` nodes a point.
pub struct Explicit<S, const N: usize> {
    shape: S,
    settings: Settings,
    nodes: Nodes,
    carrier: Carrier,
    scratch: Box<Scratch<N>>,
    /// Where the body is large enough for several parts, and every pass of the case can go over parts.
    crew: Option<Crew<S, N>>,
    effects: Vec<Box<dyn Effect>>,
    lists: StageLists,
    plastic: f64,
    floor_impulse: [f64; 2],
    flows: Flows,
    path: FpPath,
    runs_when_sorted: u64,
    balance: Box<NodeBalance>,
    /// Empty in a scene without loads.
    point_forces: PointForces,
    /// Where the dilatation is smoothed over cells (B-bar).
    cells: Option<Box<CellMeans>>,
    /// Only where a soil softens nonlocally.
    nonlocal: Option<Box<Nonlocal>>,
}

/// Which effects take part in which stage, found once.
#[derive(Default)]
struct StageLists {
    survey: Vec<usize>,
    load: Vec<usize>,
    force: Vec<usize>,
    constrain: Vec<usize>,
    account: Vec<usize>,
}

/// Sums per active node for the estimate of the stable step.
#[derive(Default)]
struct NodeBalance {
    stiffness: Vec<f64>,
    squares: Vec<f64>,
    mass: Vec<f64>,
    /// Fastest compression wave (m/s), and the square of the fastest point.
    wave: f64,
    particle_squared: f64,
}

impl<S: Shape<N>, const N: usize> Explicit<S, N> {
    /// An integrator on `grid` with the effects in the order in which they act.
    pub fn new(shape: S, grid: Grid, settings: Settings, effects: Vec<Box<dyn Effect>>) -> Self {
        let pick = |f: fn(&dyn Effect) -> bool| {
            effects.iter().enumerate().filter(|(_, e)| f(e.as_ref())).map(|(i, _)| i).collect()
        };
        let lists = StageLists {
            survey: pick(|e| e.stages().survey),
            load: pick(|e| e.stages().load),
            force: pick(|e| e.stages().force),
            constrain: pick(|e| e.stages().constrain),
            account: pick(|e| e.stages().account),
        };
        Explicit {
            shape,
            settings,
            nodes: Nodes::new(grid),
            carrier: Carrier::new(settings.transfer),
            scratch: Box::default(),
            crew: None,
            effects,
            lists,
            plastic: 0.0,
            floor_impulse: [0.0; 2],
            flows: Flows::default(),
            path: FpPath::best(),
            runs_when_sorted: 0,
            balance: Box::default(),
            point_forces: PointForces::default(),
            cells: settings.smooth.then(|| Box::new(CellMeans::new(&grid))),
            nonlocal: None,
        }
    }

    /// Lets large bodies be stepped in parts, on one thread until [`Integrator::share`] says more. Not with XPIC, whose
    /// filter passes over the whole body, nor with smoothed dilatation, whose cells may lie in two parts.
    pub fn in_parts(&mut self, body: &Body) {
        let whole = matches!(self.settings.transfer, Transfer::Xpic { .. }) || self.settings.smooth;
        self.crew = if whole { None } else { Crew::of(body, self.nodes.grid, self.shape, self.path) };
    }

    /// Lets the strength of some groups follow averages from now on.
    pub fn soften_by(&mut self, body: &Body, averages: Vec<Average>) {
        self.nonlocal = Some(Box::new(Nonlocal::new::<S, N>(&self.nodes.grid, body, averages)));
    }

    fn try_step(&mut self, body: &mut Body, clock: Clock, work: &mut Work) -> Result<(), Fault> {
        let runs = self.scatter(body);
        let mean_mass = if self.settings.mass_floor > 0.0 { body.total_mass() / body.len() as f64 } else { 0.0 };
        self.lists.survey.iter().for_each(|&e| self.effects[e].survey(body, &self.nodes.grid));
        work.effect_calls += self.lists.survey.len() as u64;
        let floor = self.update_nodes(body, clock, mean_mass, work);
        self.push(body, clock.dt)?;
        self.lists.load.iter().for_each(|&e| self.effects[e].account_points(body, clock));
        self.strain_velocity(clock, work);
        let flows =
            self.path.run(Weigh { nodes: &self.nodes, stress_update: self.settings.stress_update, dt: clock.dt });
        let plastic = self.strain(body, clock.dt)?;
        self.commit(body, plastic, floor, &flows, work);
        self.soften(body, work);
        self.keep_sorted(body, runs, work);
        Ok(())
    }

    /// The averages of what has been committed, for the next step.
    fn soften(&mut self, body: &mut Body, work: &mut Work) {
        let Explicit { nonlocal: Some(nonlocal), scratch, nodes, path, shape, .. } = self else { return };
        path.run(Soften { scratch: scratch.as_mut(), body, nodes, kept: None, nonlocal, shape: *shape });
        work.effect_calls += 1;
    }

    /// Puts the points back in cell order when too many runs of equal nodes have been broken.
    fn keep_sorted(&mut self, body: &mut Body, runs: u64, work: &mut Work) {
        if self.runs_when_sorted == 0 {
            self.runs_when_sorted = runs;
        } else if runs > self.runs_when_sorted + self.runs_when_sorted / 4 + 8 {
            body.sort(&S::order(&self.nodes.grid));
            self.runs_when_sorted = 0;
            work.sorts += 1;
        }
    }

    fn scatter(&mut self, body: &Body) -> u64 {
        self.nodes.begin();
        let Explicit { scratch, nodes, shape, path, cells, crew, .. } = self;
        if let Some(crew) = crew {
            crew.scatter(body, nodes);
            return crew.runs();
        }
        let (scratch, cells) = (scratch.as_mut(), cells.as_deref_mut());
        path.run(Scatter { scratch, body, nodes, cells, stretch: 0..body.len(), shape: *shape });
        self.scratch.runs.len() as u64
    }

    fn strain(&mut self, body: &mut Body, dt: f64) -> Result<f64, Fault> {
        let Explicit { scratch, nodes, shape, path, cells, crew, .. } = self;
        if let Some(crew) = crew {
            return crew.strain(body, nodes, dt);
        }
        let (scratch, cells) = (scratch.as_mut(), cells.as_deref_mut());
        body.apart(|body, part| path.run(Strain { scratch, body, part, nodes, cells, dt, shape: *shape }))
    }

    /// v = p / m at the start, forces, v += dt f / m, supports.
    fn update_nodes(&mut self, body: &Body, clock: Clock, mean_mass: f64, work: &mut Work) -> [f64; 2] {
        let Explicit { nodes, effects, path, .. } = self;
        effects.iter_mut().for_each(|e| e.ledger_mut().begin());
        invert_mass::<S, N>(nodes);
        let Nodes { old_velocity: out, momentum, inverse_mass, count, .. } = &mut *nodes;
        path.run(Divide { out, momentum, inverse_mass, n: *count });
        if self.settings.stress_update == StressUpdate::Musl {
            let (n, internal) = (nodes.count, nodes.internal.iter_mut());
            internal.zip(&nodes.force).for_each(|(kept, force)| kept[..n].copy_from_slice(&force[..n]));
        }
        let floor = withhold(nodes, clock.dt, self.settings.mass_floor * mean_mass);
        self.spread_loads(body, clock, work);
        let Explicit { nodes, effects, lists, path, .. } = self;
        lists.force.iter().for_each(|&e| effects[e].force(nodes, clock));
        path.run(Accelerate { nodes: &mut *nodes, dt: clock.dt });
        lists.constrain.iter().for_each(|&e| effects[e].constrain(nodes, Pass::Update, clock));
        lists.account.iter().for_each(|&e| effects[e].account(nodes, clock));
        work.effect_calls += (lists.force.len() + lists.constrain.len() + lists.account.len()) as u64;
        floor
    }

    /// Forces on points go to the nodes as they are, after what light nodes withhold: they are shared
    /// by volume, so that they go with the mass as weight does.
    fn spread_loads(&mut self, body: &Body, clock: Clock, work: &mut Work) {
        let Explicit { nodes, effects, lists, path, scratch, shape, point_forces, crew, .. } = self;
        if lists.load.is_empty() {
            return;
        }
        gather(point_forces, effects, &lists.load, body, clock);
        match crew {
            Some(crew) => crew.spread_loads(body, nodes, point_forces),
            None => {
                let (scratch, forces, stretch) = (scratch.as_mut(), &*point_forces, 0..body.len());
                path.run(Spread { scratch, body, nodes, forces, stretch, shape: *shape });
            }
        }
        // for the forces, and for the books once the points have moved
        work.effect_calls += 2 * lists.load.len() as u64;
    }

    fn push(&mut self, body: &mut Body, dt: f64) -> Result<(), Fault> {
        let Explicit { scratch, nodes, carrier, shape, path, settings, crew, .. } = self;
        let remap = settings.stress_update == StressUpdate::Musl;
        if remap {
            let n = nodes.count;
            nodes.momentum.iter_mut().for_each(|m| m[..n].fill(0.0));
        }
        if let Some(crew) = crew {
            return crew.push(body, nodes, settings.transfer, dt, remap);
        }
        let scratch = scratch.as_mut();
        body.apart(|body, part| carrier.push(Push { scratch, body, part, nodes, dt, remap, shape: *shape }, *path))
    }

    /// The velocity that strains the points.
    fn strain_velocity(&mut self, clock: Clock, work: &mut Work) {
        let Explicit { nodes, effects, lists, settings, path, .. } = self;
        match settings.stress_update {
            StressUpdate::Musl => {
                let Nodes { strain_velocity: out, momentum, inverse_mass, count, .. } = &mut *nodes;
                path.run(Divide { out, momentum, inverse_mass, n: *count });
                lists.constrain.iter().for_each(|&e| effects[e].constrain(nodes, Pass::Remap, clock));
                work.effect_calls += lists.constrain.len() as u64;
            }
            StressUpdate::Usl => {
                let n = nodes.count;
                for axis in 0..2 {
                    nodes.strain_velocity[axis][..n].copy_from_slice(&nodes.velocity[axis][..n]);
                }
            }
        }
    }

    fn commit(&mut self, body: &mut Body, plastic: f64, floor: [f64; 2], flows: &Flows, work: &mut Work) {
        body.commit();
        self.effects.iter_mut().for_each(|e| e.ledger_mut().commit());
        self.plastic += plastic;
        self.flows.add(flows);
        self.floor_impulse[0] += floor[0];
        self.floor_impulse[1] += floor[1];
        work.steps += 1;
        work.particle_steps += body.len() as u64;
        work.law_blocks += body.groups.iter().map(|g| chunks(g.range.clone()).count() as u64).sum::<u64>();
        let (growths, high) = self.nodes.growth();
        work.node_growths = growths;
        work.max_active_nodes = high as u64;
        if S::DOMAIN && work.steps.is_multiple_of(CLAMPS_EVERY) {
            let clamped = domain::longer_than(body, S::LONGEST * self.nodes.grid.h * (1.0 + 1e-9));
            work.domain_clamps = work.domain_clamps.max(clamped);
        }
    }
}

/// Steps between two counts of the domains that are longer than the shape takes.
const CLAMPS_EVERY: u64 = 20;

/// 1 / m on the active nodes. Nodes of weight 0 to all points ([`Shape::BARE_NODES`]) have no gradient
/// and so no force either, get 0 and stay at rest.
#[inline(never)]
fn invert_mass<S: Shape<N>, const N: usize>(nodes: &mut Nodes) {
    let n = nodes.count;
    for (inverse, m) in nodes.inverse_mass[..n].iter_mut().zip(&nodes.mass[..n]) {
        *inverse = if S::BARE_NODES && *m == 0.0 { 0.0 } else { 1.0 / m };
    }
}

/// `out = p / m` on the active nodes.
struct Divide<'a> {
    out: &'a mut [Vec<f64>; 2],
    momentum: &'a [Vec<f64>; 2],
    inverse_mass: &'a [f64],
    n: usize,
}

impl Kernel for Divide<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let inverse = &self.inverse_mass[..self.n];
        for axis in 0..2 {
            let (out, momentum) = (&mut self.out[axis][..self.n], &self.momentum[axis][..self.n]);
            for i in 0..self.n {
                out[i] = momentum[i] * inverse[i];
            }
        }
    }
}

/// The sums of [`Flows`].
struct Weigh<'a> {
    nodes: &'a Nodes,
    stress_update: StressUpdate,
    dt: f64,
}

impl Kernel for Weigh<'_> {
    type Output = Flows;

    #[inline(always)]
    fn run(self) -> Flows {
        match self.stress_update {
            StressUpdate::Musl => flows::musl(self.nodes, self.dt),
            StressUpdate::Usl => flows::usl(self.nodes, self.dt),
        }
    }
}

/// Internal forces on nodes lighter than `floor` are scaled by m / floor: the node is accelerated
/// as if it had the mass of the floor. Forces that go with the mass, such as weight, come later
/// and act in full, so that a falling body falls alike everywhere. The impulse that is held back
/// is returned.
fn withhold(nodes: &mut Nodes, dt: f64, floor: f64) -> [f64; 2] {
    let n = nodes.count;
    let mut held = [0.0; 2];
    if floor > 0.0 {
        for axis in 0..2 {
            for (f, &m) in nodes.force[axis][..n].iter_mut().zip(&nodes.mass[..n]) {
                let kept = *f * (m / m.max(floor));
                held[axis] -= dt * (*f - kept);
                *f = kept;
            }
        }
    }
    held
}

/// v = v_old + dt f / m.
struct Accelerate<'a> {
    nodes: &'a mut Nodes,
    dt: f64,
}

impl Kernel for Accelerate<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Accelerate { nodes, dt } = self;
        let n = nodes.count;
        let inverse = &nodes.inverse_mass[..n];
        for axis in 0..2 {
            let (force, old) = (&nodes.force[axis][..n], &nodes.old_velocity[axis][..n]);
            let new = &mut nodes.velocity[axis][..n];
            for i in 0..n {
                new[i] = old[i] + dt * force[i] * inverse[i];
            }
        }
    }
}

impl<S: Shape<N>, const N: usize> Integrator for Explicit<S, N> {
    /// `courant` times the smaller of
    /// - h / (c + |v|), and
    /// - 2 / sqrt(max kappa_i), which light and unevenly loaded nodes lower:
    ///   MUSL: kappa_i = sum(V M |grad N_i|^2) sum(N_i^2 m) / m_i^2, the diagonal of the step's
    ///   operator (mapping to the points and back weighs the force by N);
    ///   USL: kappa_i = 2 sum(V M |grad N_i| sum_j |grad N_j|) / m_i, twice a row sum of M^-1 K
    ///   and so no less than twice its largest eigenvalue. Twice, because FLIP keeps less
    ///   velocity than USL strains with: a mode that it does not keep at all is stable only to
    ///   sqrt(2 / lambda).
    ///
    /// XPIC keeps less than FLIP, so its kappa_i counts twice with MUSL too. APIC maps what is linear over a
    /// patch to the points and back whole, so that MUSL is USL, with the kappa_i of that.
    ///
    /// The validation problem `courant` holds both against the exact limit.
    fn stable_dt(&mut self, body: &Body) -> Option<f64> {
        let kappa = self.largest_kappa(body);
        let speed = self.balance.wave + self.balance.particle_squared.sqrt();
        let courant = self.nodes.grid.h / speed;
        Some(self.settings.courant * courant.min(2.0 / kappa.sqrt()))
    }

    fn step(&mut self, body: &mut Body, clock: Clock, work: &mut Work) -> Result<(), Fault> {
        let result = self.try_step(body, clock, work);
        if result.is_err() {
            // leave the nodes as the committed body has them, not as the refused step did
            self.scatter(body);
            invert_mass::<S, N>(&mut self.nodes);
            let Nodes { velocity, momentum, inverse_mass, count, .. } = &mut self.nodes;
            self.path.run(Divide { out: velocity, momentum, inverse_mass, n: *count });
        }
        result
    }

    fn share(&mut self, team: Team) -> usize {
        self.crew.as_mut().map_or(1, |crew| crew.join(self.nodes.grid, team))
    }

    fn nodal_kinetic_energy(&self) -> f64 {
        self.nodes.kinetic_energy()
    }

    fn books(&self) -> Books {
        let mut books = Books { flows: self.flows, ..Books::of(&self.effects, self.plastic) };
        (0..2).for_each(|axis| books.effects.impulse[axis] += self.floor_impulse[axis]);
        books
    }

    fn bytes(&self) -> usize {
        let loads: usize = self.point_forces.iter().map(|f| 8 * f.capacity()).sum();
        let averages = self.nonlocal.as_ref().map_or(0, |n| n.bytes());
        let runs = self.crew.as_ref().map_or_else(|| self.scratch.runs.bytes(), |c| c.bytes());
        let cells = self.cells.as_ref().map_or(0, |c| c.bytes());
        self.nodes.bytes() + loads + averages + self.carrier.bytes() + cells + runs
    }
}

impl<S: Shape<N>, const N: usize> Explicit<S, N> {
    /// Largest kappa_i over the nodes; see [`Integrator::stable_dt`].
    fn largest_kappa(&mut self, body: &Body) -> f64 {
        self.nodes.begin();
        let n = self.collect_balance(body);
        let NodeBalance { stiffness, squares, mass, .. } = self.balance.as_ref();
        let floor = self.settings.mass_floor * body.total_mass() / body.len().max(1) as f64;
        let (smooth, kept) = (self.settings.smooths(), matches!(self.settings.transfer, Transfer::Flip { .. }));
        let times = if smooth && kept { 1.0 } else { 2.0 };
        let kappa = |i: usize| {
            if S::BARE_NODES && mass[i] == 0.0 {
                0.0
            } else if smooth {
                times * (stiffness[i] * squares[i] / (mass[i] * mass[i]))
            } else {
                times * stiffness[i] / mass[i].max(floor)
            }
        };
        (0..n).map(kappa).fold(0.0, f64::max)
    }

    /// Sums of stiffness (see [`Integrator::stable_dt`]), N^2 m and N m on the nodes.
    fn collect_balance(&mut self, body: &Body) -> usize {
        let Explicit { nodes, balance, scratch, path, settings, .. } = self;
        let (rows, balance) = (!settings.smooths(), balance.as_mut());
        path.run(Balance::<S, N> { scratch: scratch.as_mut(), body, nodes, balance, rows, shape: PhantomData });
        nodes.count
    }
}

/// The sums of [`NodeBalance`], and the fastest wave and point of the body.
struct Balance<'a, S, const N: usize> {
    scratch: &'a mut Scratch<N>,
    body: &'a Body,
    nodes: &'a mut Nodes,
    balance: &'a mut NodeBalance,
    /// Row sums of the stiffness instead of its diagonal (USL, APIC).
    rows: bool,
    shape: PhantomData<S>,
}

impl<S: Shape<N>, const N: usize> Kernel for Balance<'_, S, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Balance { scratch: s, body, nodes, balance: b, rows, .. } = self;
        let offsets = S::offsets(nodes.grid.row());
        b.begin();
        for group in &body.groups {
            set_uniform(&mut s.block, group);
            for range in chunks(group.range.clone()) {
                place::<S, N>(s, body, nodes, &range);
                load_varying(&mut s.block, group, &range);
                s.stencil.find_runs(range.len());
                for run in s.stencil.runs() {
                    let slots = nodes.patch(run.base, &offsets);
                    b.reach(nodes.count);
                    for lane in run.start as usize..run.end as usize {
                        let i = range.start + lane;
                        let (mass, [vx, vy]) = (body.mass[i], [body.committed.v[0][i], body.committed.v[1][i]]);
                        let density = mass / (body.volume[i] * body.committed.jacobian[i]);
                        let c = group.law.wave_speed(&s.block, lane, density);
                        b.wave = b.wave.max(c);
                        b.particle_squared = b.particle_squared.max(vx * vx + vy * vy);
                        b.add(&slots, &s.stencil, lane, mass, mass * c * c, rows);
                    }
                }
            }
        }
    }
}

impl NodeBalance {
    fn begin(&mut self) {
        [&mut self.stiffness, &mut self.squares, &mut self.mass].into_iter().for_each(|c| c.fill(0.0));
        (self.wave, self.particle_squared) = (0.0, 0.0);
    }

    /// Adds one point; `stiffness` is V M = m c^2.
    #[inline(always)]
    fn add<const N: usize>(
        &mut self,
        slots: &[usize; N],
        stencil: &Stencil<N>,
        lane: usize,
        mass: f64,
        stiffness: f64,
        rows: bool,
    ) {
        let mut length = [0.0; N];
        let mut sum = 0.0;
        for k in 0..N {
            let [gx, gy] = stencil.grad(k, lane);
            length[k] = (gx * gx + gy * gy).sqrt();
            sum += length[k];
        }
        for k in 0..N {
            let w = stencil.weight(k, lane);
            self.stiffness[slots[k]] += stiffness * length[k] * if rows { sum } else { length[k] };
            self.squares[slots[k]] += w * w * mass;
            self.mass[slots[k]] += w * mass;
        }
    }

    /// Makes room for `n` nodes.
    #[inline(always)]
    fn reach(&mut self, n: usize) {
        if n > self.mass.len() {
            self.grow(n);
        }
    }

    /// A quarter more than is needed, as the nodes' columns do.
    #[cold]
    fn grow(&mut self, n: usize) {
        let n = (n + n / 4).max(256);
        [&mut self.stiffness, &mut self.squares, &mut self.mass].into_iter().for_each(|c| c.resize(n, 0.0));
    }
}
