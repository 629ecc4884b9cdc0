//! Coulomb friction at the nodes of a side (Bandara & Soga 2015): |f_t| <= mu f_n.

use std::ops::Range;

use super::{Clock, Effect, Ledger, Pass, Sink, Stages, velocity_of};
use crate::{
    body::Body,
    nodes::Nodes,
    space::{Grid, grid::Side},
    system::System,
};

/// Frictional side of the grid.
pub struct Friction {
    side: Side,
    /// mu.
    coefficient: f64,
    /// Whether the soil may lift off.
    separation: bool,
    /// For each node of the side in this step: away, leaving, sliding or sticking.
    contact: Vec<Contact>,
    /// Impulse along the side on each of these nodes, until it is known how they move (explicit scheme).
    rubs: Vec<f64>,
    /// For each grid node along the side: how near the soil of its cells comes to the side, by the
    /// edge of its points (m); below 0 where they overlap it.
    clearance: Vec<f64>,
    /// Implicit scheme: what each node of the side is taken to do, in the order of `contact`.
    grips: Vec<Grip>,
    /// The same after the last accepted step, by grid node along the side.
    memory: Vec<Grip>,
    /// Forces of the side in the implicit scheme: slot, axis, and the factor on the reaction along
    /// that axis, or across the side where the node slides.
    forces: Vec<(u32, u8, f64)>,
    ledger: Ledger,
}

/// Contact of a node in the implicit scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grip {
    contact: Contact,
    /// Sign of the force of the side on the soil along the side, where it slides.
    sign: f64,
    /// Changes of mind in this step.
    changes: u32,
}

impl Default for Grip {
    fn default() -> Self {
        Grip { contact: Contact::Stick, sign: 0.0, changes: 0 }
    }
}

/// Changes of mind in one step after which a node stays as it is: two states may lie within
/// rounding of each other.
const MOST_CHANGES: u32 = 8;

/// Contact of one node in one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// No point of its cells reaches the side.
    Away,
    /// Touching, and leaving.
    Open,
    Slip,
    Stick,
}

/// Velocity after contact, and how the node touches.
///
/// In impulses per mass: without contact the node would leave with `normal` (positive off the
/// side) and `tangential`. The side pushes with p_n = -normal, and rubs with at most mu p_n,
/// never past rest.
#[inline]
pub fn contact_law(normal: f64, tangential: f64, coefficient: f64, separation: bool) -> (f64, f64, Contact) {
    // what is not a number must stay so, to be caught at the points
    if normal.is_nan() || (normal >= 0.0 && separation) {
        return (normal, tangential, Contact::Open);
    }
    let push = (-normal).max(0.0);
    let rub = coefficient * push;
    if tangential.abs() <= rub {
        (0.0, 0.0, Contact::Stick)
    } else {
        (0.0, tangential - rub * tangential.signum(), Contact::Slip)
    }
}

/// Clearance, in cells, up to which soil touches the side: rounding of points that start with
/// their edge on it.
const TOUCH: f64 = 0.01;

/// Points looked at together in a survey.
const STRETCH: usize = 64;

impl Friction {
    /// Friction with coefficient mu; with `separation` the soil may lift off.
    pub fn new(side: Side, coefficient: f64, separation: bool) -> Self {
        Friction {
            side,
            coefficient,
            separation,
            contact: Vec::new(),
            rubs: Vec::new(),
            clearance: Vec::new(),
            grips: Vec::new(),
            memory: Vec::new(),
            forces: Vec::new(),
            ledger: Ledger::default(),
        }
    }

    /// Whether soil touches the side at a grid node. Without it a node that has once left the side
    /// would be stopped wherever it is when it comes back: the way up kept, the way down not, and
    /// a sliding body would climb.
    fn touches(&self, nodes: &Nodes, s: usize) -> bool {
        let along = nodes.grid.node_place(nodes.id[s])[1 - self.side.axis()] as usize;
        !self.separation || self.clearance.get(along).is_none_or(|c| *c <= TOUCH * nodes.grid.h)
    }

    fn survey_stretch(&mut self, body: &Body, grid: &Grid, side: f64, range: Range<usize>) {
        let (n, t) = (self.side.axis(), 1 - self.side.axis());
        let state = &body.committed;
        for i in range {
            let distance = (state.x[n][i] - side).abs();
            if distance < grid.h {
                let clearance = distance - 0.5 * (body.volume[i] * state.jacobian[i]).sqrt();
                let cell = ((state.x[t][i] - grid.origin[t]) / grid.h) as usize;
                let cell = cell.min(grid.cells[t] as usize - 1);
                for c in &mut self.clearance[cell..=cell + 1] {
                    *c = c.min(clearance);
                }
            }
        }
    }

    fn update(&mut self, nodes: &mut Nodes) {
        // room for every node of the side, once
        let room = nodes.grid.cells[1 - self.side.axis()] as usize + 1;
        self.contact.clear();
        self.contact.reserve(room);
        self.rubs.clear();
        self.rubs.reserve(room);
        let (n, t, inward) = (self.side.axis(), 1 - self.side.axis(), self.side.inward());
        for k in 0..nodes.side(self.side).len() {
            let s = nodes.side(self.side)[k] as usize;
            let (mass, vn, vt) = (nodes.mass[s], nodes.velocity[n][s], nodes.velocity[t][s]);
            if !self.touches(nodes, s) {
                self.contact.push(Contact::Away);
                self.rubs.push(0.0);
                continue;
            }
            let (normal, tangential, contact) = contact_law(vn * inward, vt, self.coefficient, self.separation);
            nodes.velocity[n][s] = normal * inward;
            nodes.velocity[t][s] = tangential;
            let rub = mass * (tangential - vt);
            self.ledger.step.impulse[n] += mass * (normal * inward - vn);
            self.ledger.step.impulse[t] += rub;
            self.contact.push(contact);
            self.rubs.push(rub);
        }
    }

    /// Grip of the nodes at the start of a step: as in the step before, sticking where new.
    fn begin_grips(&mut self, nodes: &Nodes) {
        self.memory.resize(nodes.grid.cells[1 - self.side.axis()] as usize + 1, Grip::default());
        self.grips.clear();
        for s in nodes.side(self.side) {
            let slot = *s as usize;
            let before = self.memory[self.along(nodes, slot)];
            let before = if before.contact == Contact::Away { Grip::default() } else { before };
            let touches = self.touches(nodes, slot);
            self.grips.push(if touches { before } else { Grip { contact: Contact::Away, ..Grip::default() } });
        }
    }

    /// Number of a node along the side.
    fn along(&self, nodes: &Nodes, slot: usize) -> usize {
        nodes.grid.node_place(nodes.id[slot])[1 - self.side.axis()] as usize
    }

    /// What a node should do, given the increment and the forces as they stand. An open node
    /// closes when it moves into the side, and goes on along it; a closed one opens when it is pulled,
    /// slides when it is rubbed more than mu allows, and sticks when it would slide the way that
    /// friction pushes it.
    fn revise(&self, grip: Grip, slot: usize, system: &System) -> Grip {
        let (n, t, inward) = (self.side.axis(), 1 - self.side.axis(), self.side.inward());
        let push = inward * system.reaction(slot, n);
        let rub = system.reaction(slot, t);
        let limit = self.coefficient * push.max(0.0);
        let next = match grip.contact {
            Contact::Away => grip,
            Contact::Open if inward * system.du[n][slot] < 0.0 => {
                Grip { contact: Contact::Slip, sign: -system.du[t][slot].signum(), ..grip }
            }
            Contact::Open => grip,
            _ if self.separation && push < 0.0 => Grip { contact: Contact::Open, ..grip },
            // another support holds it along the side
            Contact::Stick if system.is_held(slot, t) => grip,
            Contact::Stick if rub.abs() > limit * (1.0 + 1e-9) => {
                Grip { contact: Contact::Slip, sign: rub.signum(), ..grip }
            }
            Contact::Slip if system.du[t][slot] * grip.sign > 0.0 => Grip { contact: Contact::Stick, ..grip },
            Contact::Slip | Contact::Stick => grip,
        };
        Grip { changes: grip.changes + u32::from(next.contact != grip.contact), ..next }
    }

    /// Brings the choices to the system: a closed node is held across the side, a sticking one
    /// along it, and a sliding one gets r_t = sign mu r_n.
    fn apply(&mut self, nodes: &Nodes, system: &mut System) {
        let (n, t, inward) = (self.side.axis(), 1 - self.side.axis(), self.side.inward());
        self.forces.clear();
        for (grip, s) in self.grips.iter().zip(nodes.side(self.side)) {
            let slot = *s as usize;
            if grip.contact == Contact::Away {
                continue;
            }
            (0..2).for_each(|axis| system.damp_impact(slot, axis));
            if grip.contact == Contact::Open {
                continue;
            }
            if system.hold(slot, n, 0.0) {
                self.forces.push((*s, n as u8, 1.0));
            }
            let limit = if inward * system.reaction(slot, n) > 0.0 { self.coefficient } else { 0.0 };
            if grip.contact == Contact::Stick {
                if system.hold(slot, t, 0.0) {
                    self.forces.push((*s, t as u8, 1.0));
                }
            } else if !system.is_held(slot, t) {
                system.slide(slot, t, n, -grip.sign * limit * inward);
                self.forces.push((*s, t as u8, grip.sign * limit * inward));
            }
        }
    }

    /// The mapped velocity keeps what the contact has decided: a closed node does not strain its
    /// cells across the side, and a sticking one not along it. (Clipping only velocities into the
    /// side would keep the outward half of the noise: a column at rest then stretches at its base
    /// and gains energy without end.) No impulse is booked: this velocity strains, it moves nothing.
    fn remap(&self, nodes: &mut Nodes) {
        let (n, t, inward) = (self.side.axis(), 1 - self.side.axis(), self.side.inward());
        for (k, contact) in self.contact.iter().enumerate() {
            let s = nodes.side(self.side)[k] as usize;
            let v = velocity_of(nodes, Pass::Remap);
            if *contact == Contact::Away {
                continue;
            }
            if *contact != Contact::Open || v[n][s] * inward < 0.0 {
                v[n][s] = 0.0;
            }
            if *contact == Contact::Stick {
                v[t][s] = 0.0;
            }
        }
    }
}

impl Effect for Friction {
    fn name(&self) -> &'static str {
        "friction"
    }

    fn sink(&self) -> Sink {
        Sink::Friction
    }

    fn stages(&self) -> Stages {
        Stages { survey: self.separation, constrain: true, account: true, ..Stages::default() }
    }

    /// Clearance of the points in the cells along the side; a point is a square of its volume.
    fn survey(&mut self, body: &Body, grid: &Grid) {
        let (n, t) = (self.side.axis(), 1 - self.side.axis());
        // in small strain the points keep their places among the nodes
        if !self.clearance.is_empty() && !body.groups.iter().any(|g| g.law.finite()) {
            return;
        }
        self.clearance.clear();
        self.clearance.resize(grid.cells[t] as usize + 1, f64::INFINITY);
        let side = if self.side.inward() > 0.0 { grid.origin[n] } else { grid.far()[n] };
        // points are nearly in the order of their cells: most stretches have none at the side
        for (k, stretch) in body.committed.x[n].chunks(STRETCH).enumerate() {
            let near: u64 = stretch.iter().map(|x| u64::from((x - side).abs() < grid.h)).sum();
            if near > 0 {
                self.survey_stretch(body, grid, side, k * STRETCH..k * STRETCH + stretch.len());
            }
        }
    }

    fn constrain(&mut self, nodes: &mut Nodes, pass: Pass, _: Clock) {
        match pass {
            Pass::Update => self.update(nodes),
            Pass::Remap => self.remap(nodes),
        }
    }

    /// Friction x way along the side: the impulse acts over the step, on a node that moves as all that constrain it have
    /// left it. The implicit scheme has no impulses here.
    fn account(&mut self, nodes: &Nodes, _: Clock) {
        let along = &nodes.velocity[1 - self.side.axis()];
        for (s, rub) in nodes.side(self.side).iter().zip(&self.rubs) {
            self.ledger.step.dissipated -= rub * along[*s as usize];
        }
    }

    fn hold(&mut self, nodes: &Nodes, _: Clock, system: &mut System, iteration: u32) -> u32 {
        let mut changed = 0;
        if iteration == 0 {
            self.begin_grips(nodes);
        } else {
            for k in 0..self.grips.len() {
                let grip = self.grips[k];
                if grip.changes < MOST_CHANGES {
                    self.grips[k] = self.revise(grip, nodes.side(self.side)[k] as usize, system);
                    changed += u32::from(self.grips[k].contact != grip.contact);
                }
            }
        }
        self.apply(nodes, system);
        changed
    }

    fn frozen(&self) -> u64 {
        self.grips.iter().filter(|g| g.changes >= MOST_CHANGES).count() as u64
    }

    fn settle(&mut self, nodes: &Nodes, clock: Clock, system: &System) {
        let normal = self.side.axis();
        for (slot, axis, factor) in &self.forces {
            let (slot, axis) = (*slot as usize, usize::from(*axis));
            // a sliding node is rubbed by a share of what presses on it
            let source = if system.is_held(slot, axis) { axis } else { normal };
            let force = factor * system.reaction(slot, source);
            self.ledger.step.impulse[axis] += force * clock.dt;
            self.ledger.step.dissipated -= force * system.du[axis][slot];
        }
        for k in 0..self.grips.len() {
            let along = self.along(nodes, nodes.side(self.side)[k] as usize);
            self.memory[along] = Grip { changes: 0, ..self.grips[k] };
        }
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn ledger_mut(&mut self) -> &mut Ledger {
        &mut self.ledger
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A node pressed on an incline: in one step gravity gives it -g cos dt and g sin dt.
    #[test]
    fn sticks_below_and_slips_above_the_friction_angle_to_one_part_in_a_million() {
        let mu: f64 = 0.4;
        for (factor, expected) in [(1.0 - 1e-6, Contact::Stick), (1.0 + 1e-6, Contact::Slip)] {
            let angle = (mu * factor).atan();
            let (vn, vt, contact) = contact_law(-angle.cos(), angle.sin(), mu, true);
            assert_eq!(contact, expected);
            assert_eq!(vn, 0.0);
            // a = g (sin - mu cos)
            let expect = if contact == Contact::Slip { angle.sin() - mu * angle.cos() } else { 0.0 };
            assert!((vt - expect).abs() < 1e-15);
        }
    }

    #[test]
    fn separation_opens_and_a_closed_side_holds() {
        assert_eq!(contact_law(0.3, 0.2, 0.5, true), (0.3, 0.2, Contact::Open));
        assert_eq!(contact_law(0.3, 0.2, 0.5, false), (0.0, 0.2, Contact::Slip));
        assert_eq!(contact_law(-1.0, -0.9, 0.5, true), (0.0, -0.4, Contact::Slip));
    }
}
