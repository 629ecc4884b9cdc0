//! Ghost penalty on the faces of boundary cells, for the implicit scheme: nodes that hardly any
//! soil reaches take their stiffness and mass from the cell next door.
//!
//! The matrix of a step is ill-conditioned where a cell at the boundary of the body holds few points
//! that lie close to its inner corner. Burman (2010) cures that for cut finite elements, Coombs (2022)
//! for material points, by penalising the jump [.] of the normal derivative across faces F of the
//! background grid:
//! ```text
//! K: gamma_K E   h/3   int_F [dn du] . [dn du] ds
//! M: gamma_M rho h^3/3 int_F [dn a]  . [dn a]  ds
//! ```
//! Which faces: those between two cells with points, one of which has an empty cell across one of its
//! four faces. A side of the grid is no empty cell: soil there ends on a grid line or is held.
//!
//! Closed form. With bilinear functions the nodes u_ab of the two cells, a = 0, 1, 2 across the face
//! (a = 1 on it) and b = 0, 1 along it, give at t in (0, 1) along the face
//! ```text
//! [dn u] = (1 - t) g_0 + t g_1,   g_b = (u_0b - 2 u_1b + u_2b) / h
//! int_F [dn u]^2 ds = h (g_0^2 + g_0 g_1 + g_1^2) / 3 = h g^T (1/3 1/6; 1/6 1/3) g
//! ```
//! so with s = (1, -2, 1) and m = (1/3 1/6; 1/6 1/3) the block of nodes ab and cd is
//! `gamma_K E / 3 s_a s_c m_bd` on both axes, and `gamma_M rho h^2 / 3 s_a s_c m_bd` for the mass. Shapes
//! with domains use the same bilinear jump: it is a statement about nodes, not about points.
//!
//! The penalty vanishes for a linear field (s sums to 0 and has no first moment), its rows sum to
//! zero (no momentum), it is symmetric and nowhere negative.
//!
//! - **On the increment**, and forgotten at the end of a step: the penalty leaves no stress, what it held
//!   out of balance is a load of the next step, and its force falls with the length of the steps. In time
//!   it is a viscosity gamma_K E h dt / 3 against jumps of the velocity gradient.
//! - **Whole**, whatever share w1 of the internal force the time scheme takes, as it is no force of
//!   the start.
//! - The **mass** acts on the acceleration of the scheme, a = c0 (du - dt v0) - c1 a0, in the regime with
//!   inertia alone. It is no mass of the body: mapping, gravity and energies do without it.
//! - **Energy**: the stiffness takes du . K du >= 0 out of a step. gamma is no property of the soil, so
//!   that is not booked as damping; it is part of the numerical energy that a run reports.
//! - E and rho are means over the points of the two cells, weighted with initial volume.
//!
//! W. M. Coombs, Ghost stabilisation of the material point method for stable quasi-static and dynamic
//! analysis of large deformation problems, Int. J. Numer. Meth. Engng. (2022); E. Burman, Ghost
//! penalty, C. R. Acad. Sci. Paris 348 (2010).

use super::{Clock, Effect, Ledger, Stages, inertia::Motion};
use crate::{
    body::{Body, Column, Group},
    math::sparse::offset_bit,
    nodes::Nodes,
    space::Grid,
    system::System,
};

/// s, the jump of the derivative across the face, times h.
const ACROSS: [f64; 3] = [1.0, -2.0, 1.0];

/// Entries of m: of a node with itself, and with the other.
const ALONG: [f64; 2] = [1.0 / 3.0, 1.0 / 6.0];

/// No number of a cell.
const NONE: u32 = u32::MAX;

/// The points of a cell.
#[derive(Clone, Copy, Debug)]
struct Soil {
    place: [u32; 2],
    /// Sums of V0, V0 E and m.
    volume: f64,
    stiffness: f64,
    mass: f64,
}

/// A face: node 2 a + b, and the factors of s s m.
#[derive(Clone, Copy, Debug)]
struct Face {
    slots: [u32; 6],
    /// gamma_K E / 3 (kPa).
    stiffness: f64,
    /// gamma_M rho h^2 / 3 (t/m).
    mass: f64,
}

/// The penalty.
pub struct Ghost {
    /// gamma_K.
    stiffness: f64,
    /// gamma_M.
    mass: f64,
    cells: Vec<Soil>,
    /// Number of each grid cell among `cells`, or none.
    number: Vec<u32>,
    faces: Vec<Face>,
    ledger: Ledger,
}

impl Ghost {
    /// A penalty with gamma_K and gamma_M, both without a unit.
    pub fn new(stiffness: f64, mass: f64) -> Self {
        Ghost { stiffness, mass, cells: Vec::new(), number: Vec::new(), faces: Vec::new(), ledger: Ledger::default() }
    }

    /// Faces of this step.
    pub fn faces(&self) -> usize {
        self.faces.len()
    }

    fn find_cells(&mut self, body: &Body, grid: &Grid) {
        self.cells.clear();
        self.number.clear();
        self.number.resize(grid.cells[0] as usize * grid.cells[1] as usize, NONE);
        for group in &body.groups {
            for i in group.range.clone() {
                let x = [body.committed.x[0][i], body.committed.x[1][i]];
                let cell = self.enter(grid, x);
                cell.volume += body.volume[i];
                cell.stiffness += body.volume[i] * young_modulus(group, i - group.range.start);
                cell.mass += body.mass[i];
            }
        }
    }

    /// The cell of a position.
    fn enter(&mut self, grid: &Grid, x: [f64; 2]) -> &mut Soil {
        let place = [0, 1].map(|a| (((x[a] - grid.origin[a]) / grid.h) as u32).min(grid.cells[a] - 1));
        let number = &mut self.number[index(grid, place)];
        if *number == NONE {
            *number = self.cells.len() as u32;
            self.cells.push(Soil { place, volume: 0.0, stiffness: 0.0, mass: 0.0 });
        }
        &mut self.cells[*number as usize]
    }

    /// The cell at a place; `None` if it is empty or not in the grid.
    fn at(&self, grid: &Grid, place: [u32; 2]) -> Option<&Soil> {
        let inside = place[0] < grid.cells[0] && place[1] < grid.cells[1];
        self.cells.get(if inside { self.number[index(grid, place)] } else { NONE } as usize)
    }

    /// Whether a cell across one of the faces is empty.
    fn on_boundary(&self, grid: &Grid, [x, y]: [u32; 2]) -> bool {
        let around = [[x.wrapping_sub(1), y], [x + 1, y], [x, y.wrapping_sub(1)], [x, y + 1]];
        let in_grid = |p: &[u32; 2]| p[0] < grid.cells[0] && p[1] < grid.cells[1];
        around.iter().filter(|p| in_grid(p)).any(|p| self.at(grid, *p).is_none())
    }

    fn find_faces(&mut self, nodes: &Nodes) {
        let mut faces = std::mem::take(&mut self.faces);
        faces.clear();
        for near in &self.cells {
            let on_boundary = self.on_boundary(&nodes.grid, near.place);
            for axis in 0..2 {
                let mut place = near.place;
                place[axis] += 1;
                let Some(far) = self.at(&nodes.grid, place) else { continue };
                if on_boundary || self.on_boundary(&nodes.grid, place) {
                    faces.extend(self.face(nodes, axis, near, far));
                }
            }
        }
        self.faces = faces;
    }

    /// The face between two cells. Their nodes are active, as they hold points.
    fn face(&self, nodes: &Nodes, axis: usize, near: &Soil, far: &Soil) -> Option<Face> {
        let mut slots = [0; 6];
        for (k, slot) in slots.iter_mut().enumerate() {
            let [dx, dy] = offset(axis, k);
            *slot = nodes.slot_at([near.place[0] + dx as u32, near.place[1] + dy as u32])?;
        }
        let volume = near.volume + far.volume;
        let modulus = (near.stiffness + far.stiffness) / volume;
        let density = (near.mass + far.mass) / volume;
        let h = nodes.grid.h;
        Some(Face { slots, stiffness: self.stiffness * modulus / 3.0, mass: self.mass * density * h * h / 3.0 })
    }
}

/// Number of a cell in its grid.
fn index(grid: &Grid, place: [u32; 2]) -> usize {
    place[1] as usize * grid.cells[0] as usize + place[0] as usize
}

/// Place of node `k` of a face with its normal along `axis`, from the first.
fn offset(axis: usize, k: usize) -> [i32; 2] {
    let (across, along) = (k as i32 / 2, k as i32 % 2);
    if axis == 0 { [across, along] } else { [along, across] }
}

/// s_a s_c m_bd of nodes `k` and `l` of a face.
fn form(k: usize, l: usize) -> f64 {
    ACROSS[k / 2] * ACROSS[l / 2] * ALONG[usize::from(k % 2 != l % 2)]
}

/// E = 9 K G / (3 K + G) of point `k` of a group; 0 for a law without moduli.
fn young_modulus(group: &Group, k: usize) -> f64 {
    let find = |name: &str| {
        let column = group.law.params().iter().position(|n| *n == name)?;
        match group.params.get(column)? {
            Column::Uniform(value) => Some(*value),
            Column::Varying(values) => values.get(k).copied(),
        }
    };
    let moduli = find("bulk_modulus").zip(find("shear_modulus"));
    moduli.map_or(0.0, |(bulk, shear)| 9.0 * bulk * shear / (3.0 * bulk + shear))
}

impl Face {
    /// Adds the force for nodal values `v` (factors included) of one axis.
    fn push(&self, residual: &mut [f64], v: [f64; 6]) {
        let jump = |b: usize| v[b] - 2.0 * v[2 + b] + v[4 + b];
        let (g0, g1) = (jump(0), jump(1));
        let q = [ALONG[0] * g0 + ALONG[1] * g1, ALONG[1] * g0 + ALONG[0] * g1];
        for (k, slot) in self.slots.iter().enumerate() {
            residual[*slot as usize] += ACROSS[k / 2] * q[k % 2];
        }
    }

    fn stiffen(&self, system: &mut System, factor: f64) {
        for (l, column) in self.slots.iter().enumerate() {
            for (k, row) in self.slots.iter().enumerate() {
                let (at, stride) = system.block(*row as usize, *column as usize);
                let value = factor * form(k, l);
                system.values[at] += value;
                system.values[at + stride + 1] += value;
            }
        }
    }
}

impl Effect for Ghost {
    fn name(&self) -> &'static str {
        "ghost_penalty"
    }

    fn stages(&self) -> Stages {
        Stages { couple: true, residual: true, ..Stages::default() }
    }

    fn couple(&mut self, body: &Body, nodes: &Nodes, system: &mut System) {
        self.find_cells(body, &nodes.grid);
        self.find_faces(nodes);
        for face in &self.faces {
            let place = face.slots.map(|s| nodes.grid.node_place(nodes.id[s as usize]).map(|p| p as i32));
            for (slot, from) in face.slots.iter().zip(place) {
                let bit = |to: &[i32; 2]| 1u64 << offset_bit(to[0] - from[0], to[1] - from[1]);
                system.couple(*slot as usize, place.iter().map(bit).fold(0, |m, b| m | b));
            }
        }
    }

    fn residual(&mut self, nodes: &Nodes, _: Clock, motion: Option<Motion<'_>>, system: &mut System) {
        let slope = motion.map_or(0.0, |m| m.weights.c0);
        for face in &self.faces {
            for axis in 0..2 {
                let value = |s: u32| {
                    let s = s as usize;
                    let inertia = motion.map_or(0.0, |m| face.mass * m.acceleration(nodes, system, axis, s));
                    face.stiffness * system.du[axis][s] + inertia
                };
                let values = face.slots.map(value);
                face.push(&mut system.residual[axis], values);
            }
            face.stiffen(system, face.stiffness + slope * face.mass);
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
mod tests;
