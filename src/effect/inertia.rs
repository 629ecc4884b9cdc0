//! Inertia in the implicit scheme: from the increment of a step to accelerations and velocities.

use crate::{nodes::Nodes, system::System};

/// How a step is integrated in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeScheme {
    /// v1 = du / dt. First order; takes energy out of all motions, the more the faster they are:
    /// an oscillation of frequency w loses about (w dt)^2 / 2 of its amplitude a step.
    BackwardEuler,
    /// Average acceleration, du = dt (v0 + v1) / 2, forces being the mean of start and end. Second
    /// order; keeps the energy of linear motion.
    Newmark,
    /// Hilber, Hughes & Taylor (1977) with gamma = 1/2 + alpha, beta = (1 + alpha)^2 / 4. Second
    /// order; leaves slow motions alone and multiplies the amplitude of very fast ones by
    /// (1 - alpha) / (1 + alpha) a step.
    Hht { alpha: f64 },
}

/// A scheme at a length of step:
/// ```text
/// m a = f_ext + w1 f_int(du) + w0 f_int(0),   a = c0 (du - dt v0) - c1 a0
/// v1  = v0 + dt ((1 - gamma) a0 + gamma a)
/// ```
/// with external forces at t + w1 dt (both f as forces on the nodes).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    pub w1: f64,
    pub c0: f64,
    pub c1: f64,
    pub gamma: f64,
    pub dt: f64,
}

impl TimeScheme {
    /// The weights for a step of `dt` (s).
    pub fn weights(self, dt: f64) -> Weights {
        match self {
            TimeScheme::BackwardEuler => Weights { w1: 1.0, c0: 1.0 / (dt * dt), c1: 0.0, gamma: 1.0, dt },
            // a is the mean acceleration of the step: forces at its start are those of the committed
            // body, and no acceleration is remembered
            TimeScheme::Newmark => Weights { w1: 0.5, c0: 2.0 / (dt * dt), c1: 0.0, gamma: 1.0, dt },
            TimeScheme::Hht { alpha } => {
                let beta = 0.25 * (1.0 + alpha) * (1.0 + alpha);
                let (c0, c1) = (1.0 / (beta * dt * dt), 0.5 / beta - 1.0);
                Weights { w1: 1.0 - alpha, c0, c1, gamma: 0.5 + alpha, dt }
            }
        }
    }

    /// Whether the scheme remembers the acceleration of the points.
    pub fn remembers(self) -> bool {
        matches!(self, TimeScheme::Hht { .. })
    }

    /// Order of its error in dt.
    pub fn order(self) -> u32 {
        if self == TimeScheme::BackwardEuler { 1 } else { 2 }
    }
}

impl Weights {
    /// Local error of the displacement (m) of a free node, from its accelerations at the start and
    /// in the mean of the step: dt^2 a / 2 is what backward Euler misplaces, dt^3 j / 12 the
    /// average acceleration, with the jerk j = 2 (a - a_start) / dt.
    pub fn local_error(&self, start: f64, mean: f64) -> f64 {
        let dt2 = self.dt * self.dt;
        if self.w1 == 1.0 { 0.5 * dt2 * mean.abs() } else { dt2 / 6.0 * (mean - start).abs() }
    }
}

/// Inertia of the nodes (lumped mass).
pub struct Inertia {
    pub scheme: TimeScheme,
    /// Accelerations at the start of the step, mapped from the points (m/s2); empty where the
    /// scheme does not remember them.
    pub start: [Vec<f64>; 2],
    /// |m a| of the last evaluation (kN/m).
    pub norm: f64,
}

/// Inertia in a step, for effects that look at accelerations.
#[derive(Clone, Copy)]
pub struct Motion<'a> {
    pub inertia: &'a Inertia,
    pub weights: &'a Weights,
}

impl Motion<'_> {
    /// Acceleration of a node at the present increment (m/s2); its derivative is `weights.c0`.
    pub fn acceleration(&self, nodes: &Nodes, system: &System, axis: usize, slot: usize) -> f64 {
        self.inertia.acceleration(nodes, system, self.weights, axis, slot)
    }
}

impl Inertia {
    /// Inertia with a time scheme.
    pub fn new(scheme: TimeScheme) -> Self {
        Inertia { scheme, start: Default::default(), norm: 0.0 }
    }

    fn start(&self, axis: usize, slot: usize) -> f64 {
        self.start[axis].get(slot).copied().unwrap_or(0.0)
    }

    /// Acceleration of a node at the present increment (m/s2).
    fn acceleration(&self, nodes: &Nodes, system: &System, w: &Weights, axis: usize, slot: usize) -> f64 {
        let way = system.du[axis][slot] - w.dt * nodes.old_velocity[axis][slot];
        w.c0 * way - w.c1 * self.start(axis, slot)
    }

    /// Adds m a, and c0 m to the diagonal.
    ///
    /// An unknown that is held or in contact comes to its velocity within the step, whatever the
    /// scheme: the average acceleration would let it swing to and fro. The force for that is
    /// m (du / dt - v0) / dt, and `system.impact` is what it differs by.
    pub fn add(&mut self, nodes: &Nodes, system: &mut System, w: &Weights) {
        let mut square = 0.0;
        system.impact_slope.clear();
        system.impact_slope.extend(nodes.mass[..nodes.count].iter().map(|m| m * (1.0 / (w.dt * w.dt) - w.c0)));
        for axis in 0..2 {
            system.impact[axis].clear();
            system.impact[axis].resize(nodes.count, 0.0);
            for slot in 0..nodes.count {
                let mass = nodes.mass[slot];
                let force = mass * self.acceleration(nodes, system, w, axis, slot);
                let stop = mass * (system.du[axis][slot] - w.dt * nodes.old_velocity[axis][slot]) / (w.dt * w.dt);
                system.residual[axis][slot] += force;
                system.impact[axis][slot] = stop - force;
                square += force * force;
                if mass > 0.0 {
                    system.add_diagonal(slot, axis, w.c0 * mass);
                }
            }
        }
        self.norm = square.sqrt();
    }

    /// Velocity of the nodes at the end of the step; what is held or in contact has du / dt. With a scheme that
    /// remembers, `start` then holds the accelerations at the end.
    pub fn finish(&mut self, nodes: &mut Nodes, system: &System, w: &Weights) {
        for axis in 0..2 {
            for slot in 0..nodes.count {
                let a = self.acceleration(nodes, system, w, axis, slot);
                let stopped = system.is_inelastic(slot, axis);
                let free =
                    nodes.old_velocity[axis][slot] + w.dt * ((1.0 - w.gamma) * self.start(axis, slot) + w.gamma * a);
                let start = nodes.old_velocity[axis][slot];
                let velocity = if stopped { system.du[axis][slot] / w.dt } else { free };
                nodes.velocity[axis][slot] = velocity;
                if let Some(acceleration) = self.start[axis].get_mut(slot) {
                    *acceleration = match (system.is_held(slot, axis), stopped) {
                        (true, _) => 0.0,
                        (false, true) => (velocity - start) / w.dt,
                        (false, false) => a,
                    };
                }
            }
        }
    }
}
