//! The active nodes: columns over the nodes that carry mass in this step.

use crate::space::{Grid, grid::Side};

/// Fields on the active nodes. Entry `s` of each column belongs to grid node `id[s]`. Columns
/// are longer than `count` where an earlier step had more nodes; what lies past it is zero.
pub struct Nodes {
    pub grid: Grid,
    /// Active nodes.
    pub count: usize,
    /// Grid node of each active node.
    pub id: Vec<u32>,
    /// Mass (t/m).
    pub mass: Vec<f64>,
    /// 1 / mass (m/t).
    pub inverse_mass: Vec<f64>,
    /// Momentum mapped from the points (kN s/m).
    pub momentum: [Vec<f64>; 2],
    /// Force (kN/m).
    pub force: [Vec<f64>; 2],
    /// Its internal part (kN/m); kept for the books of MUSL alone.
    pub internal: [Vec<f64>; 2],
    /// Velocity at the start of the step (m/s).
    pub old_velocity: [Vec<f64>; 2],
    /// Velocity at its end (m/s): it moves the points.
    pub velocity: [Vec<f64>; 2],
    /// Velocity that strains the points (m/s).
    pub strain_velocity: [Vec<f64>; 2],
    /// Active nodes on each side of the grid, in the order of [`Side::ALL`].
    sides: [Vec<u32>; 4],
    /// For each node of the grid its active number and one more; 0 where it is not active. The zeros cost no memory
    /// until soil comes there: an empty part of the domain is free.
    slot: Vec<u32>,
    /// ceil(2^64 / nodes in a row).
    row_inverse: u64,
    growths: u64,
    high_water: usize,
}

impl Nodes {
    /// Nodes of a grid, none active. Takes 4 bytes a grid node where soil is or has been.
    pub fn new(grid: Grid) -> Self {
        Nodes {
            grid,
            count: 0,
            id: Vec::new(),
            mass: Vec::new(),
            inverse_mass: Vec::new(),
            momentum: Default::default(),
            force: Default::default(),
            internal: Default::default(),
            old_velocity: Default::default(),
            velocity: Default::default(),
            strain_velocity: Default::default(),
            sides: Default::default(),
            slot: vec![0; grid.nodes()],
            row_inverse: u64::MAX / u64::from(grid.row()) + 1,
            growths: 0,
            high_water: 0,
        }
    }

    /// Makes room for `n` nodes.
    pub fn reach(&mut self, n: usize) {
        while self.id.len() < n {
            self.grow();
        }
    }

    /// Forgets the nodes of the last step.
    pub fn begin(&mut self) {
        for &id in &self.id[..self.count] {
            self.slot[id as usize] = 0;
        }
        let n = self.count;
        self.mass[..n].fill(0.0);
        for axis in 0..2 {
            self.momentum[axis][..n].fill(0.0);
            self.force[axis][..n].fill(0.0);
        }
        self.sides.iter_mut().for_each(Vec::clear);
        self.count = 0;
    }

    /// Active numbers of the nodes of a patch; nodes not seen yet in this step become active.
    #[inline(always)]
    pub fn patch<const N: usize>(&mut self, base: u32, offsets: &[u32; N]) -> [usize; N] {
        let mut slots = [0; N];
        for k in 0..N {
            let node = base + offsets[k];
            let s = self.slot[node as usize];
            slots[k] = if s == 0 { self.activate(node) } else { s as usize - 1 };
        }
        slots
    }

    fn activate(&mut self, node: u32) -> usize {
        let s = self.count;
        if s == self.id.len() {
            self.grow();
        }
        self.id[s] = node;
        self.slot[node as usize] = s as u32 + 1;
        self.count += 1;
        self.high_water = self.high_water.max(self.count);
        let place = self.place(node);
        if place[0] == 0 || place[1] == 0 || place[0] == self.grid.cells[0] || place[1] == self.grid.cells[1] {
            self.note_sides(s as u32, place);
        }
        s
    }

    /// Column and row of a node, without a division: floor(node / row) is the high word of
    /// node x ceil(2^64 / row), exact for 32-bit numbers (Lemire, Kaser & Kurz 2019).
    #[inline(always)]
    fn place(&self, node: u32) -> [u32; 2] {
        let y = ((u128::from(self.row_inverse) * u128::from(node)) >> 64) as u32;
        [node - y * self.grid.row(), y]
    }

    fn note_sides(&mut self, s: u32, place: [u32; 2]) {
        for (list, side) in self.sides.iter_mut().zip(Side::ALL) {
            if self.grid.on_side(place, side) {
                list.push(s);
            }
        }
    }

    /// Room for a quarter more nodes: the active nodes have passed their high-water mark.
    #[cold]
    fn grow(&mut self) {
        let n = (self.id.len() + self.id.len() / 4).max(256);
        self.id.resize(n, 0);
        self.mass.resize(n, 0.0);
        self.inverse_mass.resize(n, 0.0);
        let Nodes { momentum, force, internal, old_velocity, velocity, strain_velocity, .. } = self;
        for columns in [momentum, force, internal, old_velocity, velocity, strain_velocity] {
            columns.iter_mut().for_each(|c| c.resize(n, 0.0));
        }
        let longest = 2 * (self.grid.cells[0].max(self.grid.cells[1]) as usize + 1);
        for list in &mut self.sides {
            list.reserve(n.min(longest).saturating_sub(list.len()));
        }
        self.growths += 1;
    }

    /// Adds mass, momentum and force that a part of the body has brought to nodes of its own, and clears these. `map`
    /// gets the active number here of each node there.
    pub fn adopt(&mut self, own: &mut Nodes, map: &mut Vec<u32>) {
        map.clear();
        map.extend(own.id[..own.count].iter().map(|id| self.patch(*id, &[0])[0] as u32));
        add(&mut self.mass, &own.mass, map);
        for axis in 0..2 {
            add(&mut self.momentum[axis], &own.momentum[axis], map);
            add(&mut self.force[axis], &own.force[axis], map);
        }
        own.begin();
    }

    /// Active number of the grid node at a place inside the grid; `None` where it is not active.
    pub fn slot_at(&self, place: [u32; 2]) -> Option<u32> {
        let node = place[1] as usize * self.grid.row() as usize + place[0] as usize;
        self.slot.get(node).and_then(|s| s.checked_sub(1))
    }

    /// Active nodes on a side.
    pub fn side(&self, side: Side) -> &[u32] {
        &self.sides[side as usize]
    }

    /// Sum of 1/2 m v^2 over the nodes at the end of the step (kJ/m).
    pub fn kinetic_energy(&self) -> f64 {
        let n = self.count;
        let [vx, vy] = &self.velocity;
        self.mass[..n].iter().zip(vx.iter().zip(vy)).map(|(m, (x, y))| 0.5 * m * (x * x + y * y)).sum()
    }

    /// Bytes held: the columns, and the numbers of the grid nodes from the first active one to the last.
    pub fn bytes(&self) -> usize {
        let ids = &self.id[..self.count];
        let span = ids.iter().max().zip(ids.iter().min()).map_or(0, |(last, first)| (last - first) as usize + 1);
        14 * 8 * self.mass.capacity() + 4 * self.id.capacity() + 4 * span
    }

    /// Times the columns grew, and the largest number of active nodes so far.
    pub fn growth(&self) -> (u64, usize) {
        (self.growths, self.high_water)
    }
}

/// Adds the entries of a column of a part to those of the whole; `map` tells where each belongs.
pub fn add(whole: &mut [f64], part: &[f64], map: &[u32]) {
    map.iter().zip(part).for_each(|(to, value)| whole[*to as usize] += value);
}

/// Copies for a part what the whole has at its nodes.
pub fn copy(part: &mut [f64], whole: &[f64], map: &[u32]) {
    map.iter().zip(part).for_each(|(from, value)| *value = whole[*from as usize]);
}
