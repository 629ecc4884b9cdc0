//! Prescribed motion of the nodes in a box.

use super::{Clock, Effect, Ledger, Pass, Stages, velocity_of};
use crate::{nodes::Nodes, space::Grid, system::System};

/// Nodes this close to the edge of a box are in it (cells): the sums that place both round.
const EDGE: f64 = 1e-6;

/// Sets components of the velocity of all nodes in a box, which may move with them.
pub struct Drive {
    /// Lower left and upper right corner at the start (m).
    area: [[f64; 2]; 2],
    /// Velocity (m/s) of the driven axes.
    velocity: [Option<f64>; 2],
    moving: bool,
    /// From then on the nodes are held (s); infinite where they move on.
    until: f64,
    /// Active nodes in the box in this step.
    inside: Vec<u32>,
    /// Impulses that give the nodes `inside` their velocity (explicit scheme), with those of supports that the drive has
    /// overruled, until it is known how they move.
    impulses: Vec<[f64; 2]>,
    /// Axes of the nodes `inside` that this drive holds (implicit scheme).
    held: Vec<[bool; 2]>,
    ledger: Ledger,
}

impl Drive {
    /// A box (m) whose nodes have the `velocity` (m/s) of each driven axis up to `until` (s), and
    /// are then held; it goes with them if it is `moving`.
    pub fn new(area: [[f64; 2]; 2], velocity: [Option<f64>; 2], moving: bool, until: f64) -> Self {
        Drive {
            area,
            velocity,
            moving,
            until,
            inside: Vec::new(),
            impulses: Vec::new(),
            held: Vec::new(),
            ledger: Ledger::default(),
        }
    }

    /// The box at a time (m).
    pub fn area_at(&self, time: f64) -> [[f64; 2]; 2] {
        let way =
            |axis: usize| if self.moving { self.velocity[axis].unwrap_or(0.0) * time.min(self.until) } else { 0.0 };
        let way = [way(0), way(1)];
        self.area.map(|corner| [corner[0] + way[0], corner[1] + way[1]])
    }

    /// Mean velocity (m/s) over a step of each driven axis: the way is exact in a step in which
    /// the motion ends.
    pub fn velocity_in(&self, clock: Clock) -> [Option<f64>; 2] {
        let left = self.until - clock.time;
        let part = if left >= clock.dt { 1.0 } else { (left / clock.dt).max(0.0) };
        self.velocity.map(|v| v.map(|v| v * part))
    }

    fn find(&mut self, nodes: &Nodes, clock: Clock) {
        let range = NodeRange::of(&nodes.grid, self.area_at(clock.time + 0.5 * clock.dt));
        self.inside.clear();
        // room for every node there is, so that a step allocates only when they have grown
        self.inside.reserve(nodes.id.len());
        let active = nodes.id[..nodes.count].iter().zip(0u32..);
        self.inside.extend(active.filter(|(id, _)| range.holds(nodes.grid.node_place(**id))).map(|(_, s)| s));
    }

    /// Sets the velocity; what is not a number stays so, to be caught at the points.
    fn set(&mut self, nodes: &mut Nodes, pass: Pass, axis: usize, velocity: f64, dt: f64) {
        for (k, &s) in self.inside.iter().enumerate() {
            let s = s as usize;
            let mass = nodes.mass[s];
            let free = nodes.old_velocity[axis][s] + dt * nodes.force[axis][s] * nodes.inverse_mass[s];
            let v = &mut velocity_of(nodes, pass)[axis][s];
            if pass == Pass::Update {
                self.ledger.step.impulse[axis] += mass * (velocity - *v);
                self.impulses[k][axis] = mass * (velocity - free);
            }
            *v -= *v;
            *v += velocity;
        }
    }
}

impl Effect for Drive {
    fn name(&self) -> &'static str {
        "drive"
    }

    fn stages(&self) -> Stages {
        Stages { constrain: true, account: true, ..Stages::default() }
    }

    fn constrain(&mut self, nodes: &mut Nodes, pass: Pass, clock: Clock) {
        if pass == Pass::Update {
            self.find(nodes, clock);
            self.impulses.clear();
            self.impulses.reserve(nodes.id.len());
            self.impulses.resize(self.inside.len(), [0.0; 2]);
        }
        for (axis, velocity) in self.velocity_in(clock).into_iter().enumerate() {
            if let Some(velocity) = velocity {
                self.set(nodes, pass, axis, velocity, clock.dt);
            }
        }
    }

    /// Force x way: the impulse acts over the step, on a node that moves as all that constrain it have left it. The implicit
    /// scheme has no impulses here.
    fn account(&mut self, nodes: &Nodes, _: Clock) {
        for (&s, impulse) in self.inside.iter().zip(&self.impulses) {
            let work = |axis: usize| impulse[axis] * nodes.velocity[axis][s as usize];
            self.ledger.step.external += work(0) + work(1);
        }
    }

    fn hold(&mut self, nodes: &Nodes, clock: Clock, system: &mut System, iteration: u32) -> u32 {
        if iteration == 0 {
            self.find(nodes, clock);
        }
        let way = self.velocity_in(clock).map(|v| v.map(|v| v * clock.dt));
        let hold = |s: &u32| [0, 1].map(|axis| way[axis].is_some_and(|way| system.hold(*s as usize, axis, way)));
        self.held.clear();
        self.held.extend(self.inside.iter().map(hold));
        0
    }

    fn settle(&mut self, _: &Nodes, clock: Clock, system: &System) {
        for (s, held) in self.inside.iter().zip(&self.held) {
            for axis in (0..2).filter(|&axis| held[axis]) {
                let force = system.reaction(*s as usize, axis);
                self.ledger.step.impulse[axis] += force * clock.dt;
                self.ledger.step.external += force * system.du[axis][*s as usize];
            }
        }
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn ledger_mut(&mut self) -> &mut Ledger {
        &mut self.ledger
    }
}

/// The columns and rows of nodes that lie in a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeRange {
    low: [f64; 2],
    high: [f64; 2],
}

impl NodeRange {
    /// Of a box on a grid; nodes on its edge are in it.
    pub fn of(grid: &Grid, area: [[f64; 2]; 2]) -> Self {
        let cells = |corner: [f64; 2]| [0, 1].map(|a: usize| (corner[a] - grid.origin[a]) / grid.h);
        NodeRange {
            low: cells(area[0]).map(|c| (c - EDGE).ceil().max(0.0)),
            high: [0, 1].map(|a: usize| (cells(area[1])[a] + EDGE).floor().min(f64::from(grid.cells[a]))),
        }
    }

    /// Whether a node lies in it, by its column and row.
    #[inline(always)]
    pub fn holds(&self, place: [u32; 2]) -> bool {
        let [x, y] = place.map(f64::from);
        (x >= self.low[0]) & (x <= self.high[0]) & (y >= self.low[1]) & (y <= self.high[1])
    }

    /// Whether no node lies in it.
    pub fn is_empty(&self) -> bool {
        self.low[0] > self.high[0] || self.low[1] > self.high[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_goes_with_its_nodes_and_stops_with_them() {
        let drive = |moving| Drive::new([[0.0, 1.0], [2.0, 1.0]], [None, Some(-0.5)], moving, 3.0);
        assert_eq!(drive(true).area_at(2.0), [[0.0, 0.0], [2.0, 0.0]]);
        assert_eq!(drive(true).area_at(9.0), [[0.0, -0.5], [2.0, -0.5]]);
        assert_eq!(drive(false).area_at(9.0), [[0.0, 1.0], [2.0, 1.0]]);
    }

    #[test]
    fn the_way_is_exact_where_the_motion_ends() {
        let drive = Drive::new([[0.0; 2]; 2], [Some(2.0), None], true, 1.0);
        let way = |time, dt| drive.velocity_in(Clock { time, dt })[0].unwrap_or(f64::NAN) * dt;
        assert_eq!((way(0.0, 0.5), way(0.75, 1.0), way(2.0, 0.5)), (1.0, 0.5, 0.0));
        assert_eq!(drive.velocity_in(Clock { time: 0.0, dt: 1.0 })[1], None);
    }

    #[test]
    fn a_drive_books_its_impulse_and_its_work() {
        let mut nodes = Nodes::new(Grid { origin: [0.0; 2], h: 1.0, cells: [2, 1] });
        let [s, beside] = nodes.patch(0, &[1, 2]);
        (nodes.mass[s], nodes.velocity[0][s], nodes.velocity[0][beside]) = (2.0, 1.0, 1.0);
        nodes.old_velocity[0][s] = 1.0;
        nodes.strain_velocity[0][s] = 7.0;
        let mut drive = Drive::new([[0.5, -1.0], [1.5, 1.0]], [Some(3.0), None], false, f64::INFINITY);
        let clock = Clock { time: 0.0, dt: 0.1 };
        drive.constrain(&mut nodes, Pass::Update, clock);
        drive.constrain(&mut nodes, Pass::Remap, clock);
        drive.account(&nodes, clock);
        assert_eq!([nodes.velocity[0][s], nodes.strain_velocity[0][s], nodes.velocity[0][beside]], [3.0, 3.0, 1.0]);
        // m (3 - 1), and that over dt times the way 3 dt
        assert_eq!((drive.ledger.step.impulse, drive.ledger.step.external), ([4.0, 0.0], 12.0));
        nodes.velocity[0][s] = f64::NAN;
        drive.constrain(&mut nodes, Pass::Update, clock);
        assert!(nodes.velocity[0][s].is_nan());
    }

    #[test]
    fn a_drive_that_overrules_a_support_does_the_work_of_both() {
        let mut nodes = Nodes::new(Grid { origin: [0.0; 2], h: 1.0, cells: [2, 1] });
        let [s] = nodes.patch(1, &[0]);
        // a support has stopped the node
        (nodes.mass[s], nodes.old_velocity[0][s], nodes.velocity[0][s]) = (2.0, 1.0, 0.0);
        let mut drive = Drive::new([[0.5, -1.0], [1.5, 1.0]], [Some(3.0), None], false, f64::INFINITY);
        let clock = Clock { time: 0.0, dt: 0.1 };
        drive.constrain(&mut nodes, Pass::Update, clock);
        drive.account(&nodes, clock);
        assert_eq!((drive.ledger.step.impulse, drive.ledger.step.external), ([6.0, 0.0], 2.0 * (3.0 - 1.0) * 3.0));
    }

    #[test]
    fn nodes_on_the_edge_of_a_box_are_in_it() {
        let grid = Grid { origin: [-1.0, 0.0], h: 0.1, cells: [30, 10] };
        let range = NodeRange::of(&grid, [[-0.7, 0.3], [-0.4, 0.3]]);
        assert!(range.holds([3, 3]) && range.holds([6, 3]));
        assert!(!range.holds([2, 3]) && !range.holds([7, 3]) && !range.holds([4, 4]));
        assert!(NodeRange::of(&grid, [[-0.69, 0.0], [-0.61, 1.0]]).is_empty());
        assert!(NodeRange::of(&grid, [[2.5, 0.0], [3.0, 1.0]]).is_empty());
    }
}
