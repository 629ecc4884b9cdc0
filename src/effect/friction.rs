//! Coulomb friction at the nodes of a side (Bandara & Soga 2015): |f_t| <= mu f_n.

use std::ops::Range;

use super::{Clock, Effect, Ledger, Pass, Sink, Stages, velocity_of};
use crate::{
    body::Body,
    nodes::Nodes,
    space::{Grid, grid::Side},
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
    /// For each grid node along the side: how near the soil of its cells comes to the side, by the
    /// edge of its points (m); below 0 where they overlap it.
    clearance: Vec<f64>,
    ledger: Ledger,
}

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
            clearance: Vec::new(),
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

    fn update(&mut self, nodes: &mut Nodes, dt: f64) {
        self.contact.clear();
        // room for every node of the side, once
        self.contact.reserve(nodes.grid.cells[1 - self.side.axis()] as usize + 1);
        let (n, t, inward) = (self.side.axis(), 1 - self.side.axis(), self.side.inward());
        for k in 0..nodes.side(self.side).len() {
            let s = nodes.side(self.side)[k] as usize;
            let (mass, vn, vt) = (nodes.mass[s], nodes.velocity[n][s], nodes.velocity[t][s]);
            if !self.touches(nodes, s) {
                self.contact.push(Contact::Away);
                continue;
            }
            let (normal, tangential, contact) = contact_law(vn * inward, vt, self.coefficient, self.separation);
            nodes.velocity[n][s] = normal * inward;
            nodes.velocity[t][s] = tangential;
            let rub = mass * (tangential - vt);
            self.ledger.step.impulse[n] += mass * (normal * inward - vn);
            self.ledger.step.impulse[t] += rub;
            // friction force x way along the side; the impulse acts over the step
            self.ledger.step.dissipated -= rub / dt * (tangential * dt);
            self.contact.push(contact);
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
        Stages { survey: self.separation, constrain: true, ..Stages::default() }
    }

    /// Clearance of the points in the cells along the side; a point is a square of its volume.
    fn survey(&mut self, body: &Body, grid: &Grid) {
        let (n, t) = (self.side.axis(), 1 - self.side.axis());
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

    fn constrain(&mut self, nodes: &mut Nodes, pass: Pass, clock: Clock) {
        match pass {
            Pass::Update => self.update(nodes, clock.dt),
            Pass::Remap => self.remap(nodes),
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
