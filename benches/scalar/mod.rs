//! A bare scalar explicit MPM loop: the yardstick of the benchmarks.
//!
//! It does the arithmetic of the program's explicit step on the paper's slope (MUSL, bilinear
//! shapes, von Mises softening, frictional base) and nothing else: one geometry, no effects, no
//! records, no intrinsics, no target features. Units are kN, m, s, t.
//!
//! The order of a step is chosen for speed. Mass, momentum and internal force are already on the
//! nodes when it starts; then: nodal update, points to their new velocity and position with the
//! remap of momentum at the old position, nodal remap, and one pass that takes the velocity
//! gradient at the old position, runs the law and spreads the point at its new position.

mod law;
// A bench without a harness is built with cfg(test) too, and calls no test.
#[cfg(test)]
#[allow(dead_code, unused_imports)]
mod tests;

#[allow(unused_imports)]
pub use law::{Hencky, Law, Rate, Soil, State};

const GRAVITY: f64 = 9.81;
const SORT_EVERY: u64 = 50;

/// Points, one array per quantity.
#[derive(Clone, Default)]
struct Points {
    at: Vec<[f64; 2]>,
    velocity: Vec<[f64; 2]>,
    mass: Vec<f64>,
    volume: Vec<f64>,
    jacobian: Vec<f64>,
    tensor: Vec<[f64; 4]>,
    plastic: Vec<f64>,
    /// Peak and residual.
    cohesion: Vec<[f64; 2]>,
    /// Index at the start.
    id: Vec<u32>,
}

/// Nodes, row by row, dense over the grid.
struct Nodes {
    stride: u32,
    inverse_cell: f64,
    mass: Vec<f64>,
    /// Momentum and internal force.
    sums: Vec<[f64; 4]>,
    /// New velocity, and its increment.
    motion: Vec<[f64; 4]>,
    /// Momentum, then velocity, of the remap.
    remap: Vec<[f64; 2]>,
    /// Base nodes that neither slid nor lifted off in the nodal update.
    stuck: Vec<bool>,
    /// Columns and rows of nodes that points can reach.
    active: [usize; 2],
}

/// Where a point stands: its lower left node and the local coordinates in [0, 1].
struct Place {
    column: u32,
    row: u32,
    xi: f64,
    eta: f64,
}

/// The paper's slope with law `L`.
pub struct Scalar<L: Law> {
    pub time: f64,
    pub steps: u64,
    /// Gravity grows linearly over this time (s).
    pub ramp: f64,
    /// Rate at which FLIP is drawn to PIC (1/s).
    pub pic_rate: f64,
    pub friction: f64,
    soil: Soil,
    points: Points,
    /// Positions at the end of the step in progress.
    moved: Vec<[f64; 2]>,
    nodes: Nodes,
    start: Vec<[f64; 2]>,
    spare: Points,
    count: Vec<u32>,
    order: Vec<u32>,
    law: std::marker::PhantomData<L>,
}

impl<L: Law> Scalar<L> {
    /// The 45 degree slope, 5 m high, `per_axis` squared Gauss points in each cell of size `h`, cut
    /// cells full.
    pub fn paper_slope(h: f64, per_axis: usize) -> Self {
        let rows = (5.0 / h).round() as usize;
        assert!((rows as f64 * h - 5.0).abs() < 1e-9, "5 m is not a whole number of cells of {h} m");
        let gauss = gauss_positions(per_axis);
        let mut points = Points::default();
        let weight = |n: usize| gauss[n].1 * h;
        for row in 0..rows {
            for column in 0..5 * rows - row {
                for n in 0..per_axis * per_axis {
                    let (i, j) = (n % per_axis, n / per_axis);
                    let x = (column as f64 + gauss[i].0) * h;
                    let y = (row as f64 + gauss[j].0) * h;
                    points.push([x, y], weight(i) * weight(j));
                }
            }
        }
        let nodes = Nodes::new(h, (60.0 / h).round() as usize, (7.0 / h).round() as usize);
        let mut slope = Self {
            time: 0.0,
            steps: 0,
            ramp: 5.0,
            pic_rate: 0.0,
            friction: 0.3,
            soil: Soil::new(1000.0, 0.33, -50.0),
            moved: points.at.clone(),
            start: points.at.clone(),
            spare: points.clone(),
            count: Vec::new(),
            order: Vec::new(),
            points,
            nodes,
            law: std::marker::PhantomData,
        };
        slope.advance(0.0);
        slope
    }

    /// One step of `dt` seconds.
    pub fn step(&mut self, dt: f64) {
        self.time += dt;
        let gravity = GRAVITY * if self.ramp > 0.0 { (self.time / self.ramp).min(1.0) } else { 1.0 };
        self.nodes.update(dt, gravity, self.friction);
        self.drive(dt);
        self.nodes.finish_remap();
        self.advance(dt);
        std::mem::swap(&mut self.points.at, &mut self.moved);
        self.steps += 1;
        if self.steps.is_multiple_of(SORT_EVERY) {
            self.sort();
        }
    }

    /// New velocities and positions from the nodes; momentum of the new velocities back to them.
    fn drive(&mut self, dt: f64) {
        let pic = -(-self.pic_rate * dt).exp_m1();
        let flip = 1.0 - pic;
        let p = &mut self.points;
        let nodes = &mut self.nodes;
        let moved = self.moved.iter_mut();
        for (((at, velocity), &mass), moved) in p.at.iter().zip(&mut p.velocity).zip(&p.mass).zip(moved) {
            let place = Place::of(*at, nodes.inverse_cell);
            let k = place.node(nodes.stride);
            let w = place.weights();
            let (low, high) = sides(patch(&nodes.motion, k, nodes.stride));
            let m = blend(w, low, high);
            *moved = [at[0] + dt * m[0], at[1] + dt * m[1]];
            let v = [flip * (velocity[0] + m[2]) + pic * m[0], flip * (velocity[1] + m[3]) + pic * m[1]];
            *velocity = v;
            let momentum = [mass * v[0], mass * v[1]];
            let remap = patch_mut(&mut nodes.remap, k, nodes.stride);
            let low = lower(remap);
            add(&mut low[0], scale(momentum, w[0]));
            add(&mut low[1], scale(momentum, w[1]));
            let high = upper(remap);
            add(&mut high[0], scale(momentum, w[2]));
            add(&mut high[1], scale(momentum, w[3]));
        }
    }

    /// Law at the old positions, then mass, momentum and internal force at the new ones.
    fn advance(&mut self, dt: f64) {
        let soil = self.soil;
        let p = &mut self.points;
        let n = p.at.len();
        let (at, velocity, mass) = (&p.at[..n], &p.velocity[..n], &p.mass[..n]);
        let (volume, cohesion, moved) = (&p.volume[..n], &p.cohesion[..n], &self.moved[..n]);
        let (jacobian, tensor) = (&mut p.jacobian[..n], &mut p.tensor[..n]);
        let plastic = &mut p.plastic[..n];
        let nodes = &mut self.nodes;
        let (inverse_cell, stride) = (nodes.inverse_cell, nodes.stride);
        let over = dt * inverse_cell;
        let mut active = [0, 0];
        for i in 0..n {
            let place = Place::of(at[i], inverse_cell);
            let l = gradient(&nodes.remap, &place, stride, over);
            let old = State { tensor: tensor[i], jacobian: jacobian[i], plastic: plastic[i] };
            let new = L::update(&soil, cohesion[i], old, l);
            tensor[i] = new.tensor;
            jacobian[i] = new.jacobian;
            plastic[i] = new.plastic;

            let place = Place::of(moved[i], inverse_cell);
            active = [active[0].max(place.column), active[1].max(place.row)];
            let pull = L::resultant(&soil, volume[i] * inverse_cell, &new);
            nodes.spread(&place, mass[i], velocity[i], pull);
        }
        nodes.active = active.map(|a| a as usize + 2);
    }

    /// Points into the order of their cells, row by row: a counting sort.
    fn sort(&mut self) {
        let (stride, inverse_cell) = (self.nodes.stride, self.nodes.inverse_cell);
        let cell = |at: &[f64; 2]| Place::of(*at, inverse_cell).node(stride) as usize;
        self.count.clear();
        self.count.resize(self.nodes.mass.len() + 1, 0);
        for at in &self.points.at {
            self.count[cell(at) + 1] += 1;
        }
        let mut total = 0;
        for count in &mut self.count {
            total += *count;
            *count = total;
        }
        self.order.resize(self.points.at.len(), 0);
        for (i, at) in self.points.at.iter().enumerate() {
            let slot = &mut self.count[cell(at)];
            self.order[*slot as usize] = i as u32;
            *slot += 1;
        }
        self.spare.gather(&self.points, &self.order);
        std::mem::swap(&mut self.points, &mut self.spare);
    }
}

/// Totals and measures.
#[allow(dead_code)]
impl<L: Law> Scalar<L> {
    pub fn points(&self) -> usize {
        self.points.at.len()
    }

    /// t per metre of width.
    pub fn mass(&self) -> f64 {
        self.points.mass.iter().sum()
    }

    /// t m/s per metre of width.
    pub fn momentum(&self) -> [f64; 2] {
        let p = &self.points;
        p.velocity.iter().zip(&p.mass).fold([0.0; 2], |s, (v, m)| [s[0] + m * v[0], s[1] + m * v[1]])
    }

    /// Kinetic energy of the points, kJ per metre of width.
    pub fn kinetic(&self) -> f64 {
        let p = &self.points;
        p.velocity.iter().zip(&p.mass).map(|(v, m)| 0.5 * m * (v[0] * v[0] + v[1] * v[1])).sum()
    }

    pub fn max_plastic_strain(&self) -> f64 {
        self.points.plastic.iter().copied().fold(0.0, f64::max)
    }

    /// Part of the points that have yielded.
    pub fn yielded(&self) -> f64 {
        self.points.plastic.iter().filter(|&&e| e > 0.0).count() as f64 / self.points() as f64
    }

    /// Smallest and largest det F.
    pub fn jacobian_range(&self) -> [f64; 2] {
        self.points.jacobian.iter().fold([f64::MAX, f64::MIN], |[a, b], &j| [a.min(j), b.max(j)])
    }

    pub fn max_displacement(&self) -> f64 {
        let move_of = |(at, &id): (&[f64; 2], &u32)| {
            let start = self.start[id as usize];
            (at[0] - start[0]).hypot(at[1] - start[1])
        };
        self.points.at.iter().zip(&self.points.id).map(move_of).fold(0.0, f64::max)
    }

    /// Distance from the crest's edge (x = 20 m) to the first top point, from the left, that moved
    /// more than `threshold` sideways; 0 if none did.
    pub fn sliding_distance(&self, threshold: f64) -> f64 {
        let top = self.start.iter().map(|s| s[1]).fold(0.0, f64::max) - 1e-9;
        let first = self.points.at.iter().zip(&self.points.id).filter_map(|(at, &id)| {
            let start = self.start[id as usize];
            let slid = start[1] > top && start[0] < 20.0 && at[0] - start[0] > threshold;
            slid.then_some(start[0])
        });
        20.0 - first.fold(20.0, f64::min)
    }

    /// Scales each point's strengths by 1 + `amount` times a number in [-1, 1] drawn from `seed`.
    pub fn jitter(&mut self, amount: f64, mut seed: u64) {
        for c in &mut self.points.cohesion {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let unit = (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
            *c = scale(*c, 1.0 + amount * unit);
        }
    }
}

impl Points {
    /// A point of the paper's soil: gamma = 20 kN/m3, cohesion 20 falling to 4 kPa.
    fn push(&mut self, at: [f64; 2], volume: f64) {
        self.id.push(self.at.len() as u32);
        self.at.push(at);
        self.velocity.push([0.0; 2]);
        self.mass.push(20.0 / GRAVITY * volume);
        self.volume.push(volume);
        self.jacobian.push(1.0);
        self.tensor.push([0.0; 4]);
        self.plastic.push(0.0);
        self.cohesion.push([20.0, 4.0]);
    }

    /// Becomes `from` in the given order.
    fn gather(&mut self, from: &Self, order: &[u32]) {
        fn pick<T: Copy>(to: &mut [T], from: &[T], order: &[u32]) {
            for (to, &i) in to.iter_mut().zip(order) {
                *to = from[i as usize];
            }
        }
        pick(&mut self.at, &from.at, order);
        pick(&mut self.velocity, &from.velocity, order);
        pick(&mut self.mass, &from.mass, order);
        pick(&mut self.volume, &from.volume, order);
        pick(&mut self.jacobian, &from.jacobian, order);
        pick(&mut self.tensor, &from.tensor, order);
        pick(&mut self.plastic, &from.plastic, order);
        pick(&mut self.cohesion, &from.cohesion, order);
        pick(&mut self.id, &from.id, order);
    }
}

impl Nodes {
    fn new(h: f64, columns: usize, rows: usize) -> Self {
        let stride = columns + 1;
        let n = stride * (rows + 1);
        Self {
            stride: stride as u32,
            inverse_cell: 1.0 / h,
            mass: vec![0.0; n],
            sums: vec![[0.0; 4]; n],
            motion: vec![[0.0; 4]; n],
            remap: vec![[0.0; 2]; n],
            stuck: vec![false; stride],
            active: [0, 0],
        }
    }

    /// Adds a point; `pull` is its stress resultant (xx, yy, xy) over the cell size.
    #[inline(always)]
    fn spread(&mut self, place: &Place, mass: f64, velocity: [f64; 2], pull: [f64; 3]) {
        let k = place.node(self.stride);
        let w = place.weights().map(|w| w * mass);
        // -sigma . grad N: grad N = (-+(1 - eta), -+(1 - xi)) and so on, over h.
        let (low, right) = (1.0 - place.eta, place.xi);
        let [xx, yy, xy] = pull;
        let (ax, ay) = ([low * xx, low * xy], [xx - low * xx, xy - low * xy]);
        let (bx, by) = ([right * xy, right * yy], [xy - right * xy, yy - right * yy]);
        let force = [
            [ax[0] + by[0], ax[1] + by[1]],
            [bx[0] - ax[0], bx[1] - ax[1]],
            [ay[0] - by[0], ay[1] - by[1]],
            [-(ay[0] + bx[0]), -(ay[1] + bx[1])],
        ];
        let [vx, vy] = velocity;
        let share = |n: usize| [w[n] * vx, w[n] * vy, force[n][0], force[n][1]];
        let sums = patch_mut(&mut self.sums, k, self.stride);
        let low = lower(sums);
        add(&mut low[0], share(0));
        add(&mut low[1], share(1));
        let high = upper(sums);
        add(&mut high[0], share(2));
        add(&mut high[1], share(3));
        let masses = patch_mut(&mut self.mass, k, self.stride);
        add(lower(masses), [w[0], w[1]]);
        add(upper(masses), [w[2], w[3]]);
    }

    /// Velocities from momentum, force and gravity; supports; a clean sheet for the remap.
    fn update(&mut self, dt: f64, gravity: f64, friction: f64) {
        let [columns, rows] = self.active;
        let fall = dt * gravity;
        for row in 0..rows {
            let first = row * self.stride as usize;
            let span = first..first + columns;
            let nodes = self.mass[span.clone()].iter().zip(&self.sums[span.clone()]);
            for ((&mass, &[px, py, fx, fy]), motion) in nodes.zip(&mut self.motion[span.clone()]) {
                let inverse = if mass > 0.0 { 1.0 / mass } else { 0.0 };
                let (dx, dy) = (inverse * (dt * fx), inverse * (dt * fy) - fall);
                *motion = [inverse * px + dx, inverse * py + dy, dx, dy];
            }
            self.remap[span].fill([0.0; 2]);
            let [vx, _, dx, _] = &mut self.motion[first];
            *dx -= *vx;
            *vx = 0.0;
        }
        for (motion, stuck) in self.motion[..columns].iter_mut().zip(&mut self.stuck) {
            *stuck = rub(motion, friction);
        }
    }

    /// Velocities from the remapped momentum; supports; a clean sheet for the next spread.
    fn finish_remap(&mut self) {
        let [columns, rows] = self.active;
        for row in 0..rows {
            let first = row * self.stride as usize;
            let span = first..first + columns;
            for (remap, mass) in self.remap[span.clone()].iter_mut().zip(&mut self.mass[span.clone()]) {
                let inverse = if *mass > 0.0 { 1.0 / *mass } else { 0.0 };
                *remap = scale(*remap, inverse);
                *mass = 0.0;
            }
            self.sums[span].fill([0.0; 4]);
            self.remap[first][0] = 0.0;
        }
        for (remap, &stuck) in self.remap[..columns].iter_mut().zip(&self.stuck) {
            remap[1] = remap[1].max(0.0);
            if stuck {
                remap[0] = 0.0;
            }
        }
    }
}

impl Place {
    /// Rounding to the nearest integer by adding 1.5 * 2^52 stands in for the floor.
    #[inline(always)]
    fn of(at: [f64; 2], inverse_cell: f64) -> Self {
        const SHIFT: f64 = 6_755_399_441_055_744.0;
        let (x, y) = (at[0] * inverse_cell, at[1] * inverse_cell);
        let (i, j) = ((x - 0.5) + SHIFT, (y - 0.5) + SHIFT);
        let (column, row) = (i.to_bits() as u32, j.to_bits() as u32);
        Self { column, row, xi: x - (i - SHIFT), eta: y - (j - SHIFT) }
    }

    #[inline(always)]
    fn node(&self, stride: u32) -> u32 {
        self.row.wrapping_mul(stride).wrapping_add(self.column)
    }

    /// Lower left, lower right, upper left, upper right.
    #[inline(always)]
    fn weights(&self) -> [f64; 4] {
        let (xi, eta) = (self.xi, self.eta);
        let (left, low) = (1.0 - xi, 1.0 - eta);
        [left * low, xi * low, left * eta, xi * eta]
    }
}

/// Displacement gradient xx, xy, yx, yy of nodal velocities; `over` = dt / h.
#[inline(always)]
fn gradient(v: &[[f64; 2]], place: &Place, stride: u32, over: f64) -> [f64; 4] {
    let (low, high) = sides(patch(v, place.node(stride), stride));
    let (top, right) = (over * place.eta, over * place.xi);
    let (bottom, left) = (over - top, over - right);
    let mut x = [0.0; 2];
    let mut y = [0.0; 2];
    for c in 0..2 {
        x[c] = bottom * (low[1][c] - low[0][c]) + top * (high[1][c] - high[0][c]);
        y[c] = left * (high[0][c] - low[0][c]) + right * (high[1][c] - low[1][c]);
    }
    [x[0], y[0], x[1], y[1]]
}

/// Coulomb friction at a base node, by impulses per unit mass; true if the node sticks.
#[inline(always)]
fn rub(motion: &mut [f64; 4], friction: f64) -> bool {
    let [vx, vy, dx, dy] = motion;
    if *vy >= 0.0 {
        return false;
    }
    let normal = -*vy;
    *vy = 0.0;
    *dy += normal;
    let tangent = vx.clamp(-friction * normal, friction * normal);
    *vx -= tangent;
    *dx -= tangent;
    *vx == 0.0
}

/// From the lower left to the upper right node of a cell: the only bounds check of its four nodes,
/// as sums of `u32` cannot wrap.
#[inline(always)]
fn patch<T>(values: &[T], k: u32, stride: u32) -> &[T] {
    let (k, stride) = (k as usize, stride as usize);
    values.get(k..k + stride + 2).expect("a point has left the grid")
}

#[inline(always)]
fn patch_mut<T>(values: &mut [T], k: u32, stride: u32) -> &mut [T] {
    let (k, stride) = (k as usize, stride as usize);
    values.get_mut(k..k + stride + 2).expect("a point has left the grid")
}

#[inline(always)]
fn sides<T>(patch: &[T]) -> (&[T; 2], &[T; 2]) {
    (patch.first_chunk().unwrap(), patch.last_chunk().unwrap())
}

#[inline(always)]
fn lower<T>(patch: &mut [T]) -> &mut [T; 2] {
    patch.first_chunk_mut().unwrap()
}

#[inline(always)]
fn upper<T>(patch: &mut [T]) -> &mut [T; 2] {
    patch.last_chunk_mut().unwrap()
}

#[inline(always)]
fn blend<const N: usize>(w: [f64; 4], low: &[[f64; N]; 2], high: &[[f64; N]; 2]) -> [f64; N] {
    let mut sum = [0.0; N];
    for c in 0..N {
        sum[c] = (w[0] * low[0][c] + w[1] * low[1][c]) + (w[2] * high[0][c] + w[3] * high[1][c]);
    }
    sum
}

#[inline(always)]
fn add<const N: usize>(to: &mut [f64; N], more: [f64; N]) {
    for (to, more) in to.iter_mut().zip(more) {
        *to += more;
    }
}

#[inline(always)]
fn scale(v: [f64; 2], by: f64) -> [f64; 2] {
    [v[0] * by, v[1] * by]
}

/// Gauss-Legendre positions and weights on [0, 1].
fn gauss_positions(n: usize) -> Vec<(f64, f64)> {
    let half: &[(f64, f64)] = match n {
        1 => &[(0.0, 2.0)],
        2 => &[(0.577_350_269_189_625_8, 1.0)],
        3 => &[(0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0)],
        4 => &[(0.861_136_311_594_052_6, 0.347_854_845_137_453_86), (0.339_981_043_584_856_3, 0.652_145_154_862_546_1)],
        _ => panic!("1 to 4 Gauss points per axis, not {n}"),
    };
    let lower = half.iter().map(|&(x, w)| (0.5 - 0.5 * x, 0.5 * w));
    let upper = half.iter().rev().filter(|p| p.0 > 0.0).map(|&(x, w)| (0.5 + 0.5 * x, 0.5 * w));
    lower.chain(upper).collect()
}
