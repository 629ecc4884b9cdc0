//! From the grid back to the points: FLIP with a share of PIC, and the second map of MUSL.

use std::ops::Range;

use crate::{
    assembly::{self, Scratch, collect, deposit, place, response::Kept, spread},
    body::{Body, chunks, load, store},
    fault::{Fault, FaultKind},
    math::simd::Kernel,
    nodes::Nodes,
    space::{
        Grid, Shape, Stencil,
        stencil::{LANES, Lane},
    },
    system::System,
};

/// Moves the points and gives them their new velocity; with `REMAP` the momentum of the new
/// velocities goes back to the nodes, at the old positions (MUSL).
/// ```text
/// x_p += dt sum N_i v_i
/// v_p  = (1 - a) (v_p + sum N_i (v_i - v_i,old)) + a sum N_i v_i,   a = 1 - exp(-pic_rate dt)
/// ```
pub struct Push<'a, S, const N: usize, const REMAP: bool> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a mut Body,
    pub nodes: &'a mut Nodes,
    pub dt: f64,
    /// a, the share of PIC in this step.
    pub pic: f64,
    pub shape: S,
}

impl<S: Shape<N>, const N: usize, const REMAP: bool> Kernel for Push<'_, S, N, REMAP> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Push { scratch: s, body, nodes, dt, pic, .. } = self;
        let grid = nodes.grid;
        let mut block = 0;
        for g in 0..body.groups.len() {
            for range in chunks(body.groups[g].range.clone()) {
                place::<S, N>(s, body, nodes, &range);
                let ([vx, vy], [ox, oy]) = (&nodes.velocity, &nodes.old_velocity);
                spread(s.runs.of(block), &mut s.nodal, [vx, vy, ox, oy]);
                for axis in 0..2 {
                    load(&mut s.v.0[axis], &body.committed.v[axis], &range);
                }
                move_points(s, dt, pic);
                if !all_inside(s, &grid, range.len()) {
                    return Err(departure(s, body, &grid, &range));
                }
                for axis in 0..2 {
                    store(&s.x.0[axis], &mut body.trial.x[axis], &range);
                    store(&s.v.0[axis], &mut body.trial.v[axis], &range);
                }
                if REMAP {
                    load(&mut s.mass.0, &body.mass, &range);
                    remap(s, nodes, block);
                }
                block += 1;
            }
        }
        Ok(())
    }
}

#[inline(always)]
fn move_points<const N: usize>(s: &mut Scratch<N>, dt: f64, pic: f64) {
    for axis in 0..2 {
        let (new, old) = (&s.nodal[axis], &s.nodal[axis + 2]);
        for i in 0..LANES {
            let (mut grid, mut start) = (0.0, 0.0);
            for k in 0..N {
                grid += s.stencil.weight[k][i] * new.0[k][i];
                start += s.stencil.weight[k][i] * old.0[k][i];
            }
            let flip = s.v.0[axis][i] + (grid - start);
            s.v.0[axis][i] = flip + pic * (grid - flip);
            s.x.0[axis][i] += dt * grid;
        }
    }
}

#[inline(always)]
fn all_inside<const N: usize>(s: &Scratch<N>, grid: &Grid, len: usize) -> bool {
    let far = grid.far();
    let mut outside = 0u64;
    for i in 0..LANES {
        let (x, y) = (s.x.0[0][i], s.x.0[1][i]);
        let inside = (x > grid.origin[0]) & (x < far[0]) & (y > grid.origin[1]) & (y < far[1]);
        outside += u64::from(!inside & (i < len));
    }
    outside == 0
}

/// Whether the places of the first `len` points are numbers.
fn all_finite<const N: usize>(s: &Scratch<N>, len: usize) -> bool {
    s.x.0.iter().all(|x| x[..len].iter().all(|v| v.is_finite()))
}

/// The first point of a block that is not inside the grid, and what took it there.
#[cold]
fn departure<const N: usize>(s: &Scratch<N>, body: &Body, grid: &Grid, range: &Range<usize>) -> Fault {
    let place = |i: usize| [s.x.0[0][i], s.x.0[1][i]];
    let lane = (0..range.len()).find(|&i| !grid.contains(place(i))).unwrap_or(0);
    let (to, i) = (place(lane), range.start + lane);
    let way = (to[0] - body.committed.x[0][i]).hypot(to[1] - body.committed.x[1][i]);
    let kind = match way {
        w if !w.is_finite() => FaultKind::NonFinite,
        w if w > 0.5 * grid.h => FaultKind::StepTooLong,
        _ => FaultKind::LeftGrid,
    };
    let fault = Fault::new(kind).with("to_x", to[0]).with("to_y", to[1]).with("v_x", s.v.0[0][lane]);
    body.blame(fault.with("v_y", s.v.0[1][lane]).at(lane as u32, to), range.start)
}

#[inline(always)]
fn remap<const N: usize>(s: &mut Scratch<N>, nodes: &mut Nodes, block: usize) {
    let [px, py, ..] = &mut s.shares;
    for i in 0..LANES {
        let (mvx, mvy) = (s.mass.0[i] * s.v.0[0][i], s.mass.0[i] * s.v.0[1][i]);
        for k in 0..N {
            px.0[k][i] = s.stencil.weight[k][i] * mvx;
            py.0[k][i] = s.stencil.weight[k][i] * mvy;
        }
    }
    for run in s.runs.of(block) {
        let slots = run.slots.map(|s| s as usize);
        let [px, py] = collect(&s.shares[..2], run);
        deposit(&mut nodes.momentum[0], &slots, px);
        deposit(&mut nodes.momentum[1], &slots, py);
    }
}

/// Moves the points with the increments of an implicit step, and gives them their new velocity
/// where there is inertia (`moving`).
/// ```text
/// x_p += sum N_i du_i
/// v_p  = (1 - a) (v_p + sum N_i (v_i - v_i,old)) + a sum N_i v_i
/// a_p  = sum N_i a_i, where the time scheme remembers it
/// ```
pub struct Carry<'a, S, const N: usize> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a mut Body,
    pub nodes: &'a Nodes,
    pub kept: &'a Kept<N>,
    pub system: &'a System,
    pub moving: bool,
    /// Whether points may leave the grid: in small strain they keep their places among the nodes,
    /// wherever they are drawn.
    pub unbound: bool,
    /// a_i at the end of the step; empty where it is not remembered.
    pub acceleration: &'a [Vec<f64>; 2],
    /// a, the share of PIC in this step.
    pub pic: f64,
    pub shape: S,
}

impl<S: Copy, const N: usize> Kernel for Carry<'_, S, N> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Carry { scratch: s, body, nodes, kept, system, moving, unbound, acceleration, pic, .. } = self;
        let mut block = 0;
        for g in 0..body.groups.len() {
            for range in chunks(body.groups[g].range.clone()) {
                let stencil = &kept.stencils[block];
                for axis in 0..2 {
                    load(&mut s.x.0[axis], &body.committed.x[axis], &range);
                    load(&mut s.v.0[axis], &body.committed.v[axis], &range);
                    let [du, v, old] = [&system.du[axis], &nodes.velocity[axis], &nodes.old_velocity[axis]];
                    spread(s.runs.of(block), &mut s.nodal, [du, v, old]);
                    carry(s, stencil, axis, moving, pic);
                }
                let sound = if unbound { all_finite(s, range.len()) } else { all_inside(s, &nodes.grid, range.len()) };
                if !sound {
                    return Err(departure(s, body, &nodes.grid, &range));
                }
                for axis in 0..2 {
                    store(&s.x.0[axis], &mut body.trial.x[axis], &range);
                    store(&s.v.0[axis], &mut body.trial.v[axis], &range);
                }
                for axis in 0..2 {
                    if !acceleration[axis].is_empty() {
                        spread(s.runs.of(block), &mut s.nodal, [&acceleration[axis]]);
                        interpolate(&s.nodal[0], stencil, &mut s.v.0[axis]);
                        store(&s.v.0[axis], &mut body.trial.acceleration[axis], &range);
                    }
                }
                block += 1;
            }
        }
        Ok(())
    }
}

/// sum N_i a_i.
#[inline(always)]
fn interpolate<const N: usize>(nodal: &assembly::Spread<N>, stencil: &Stencil<N>, out: &mut Lane) {
    for i in 0..LANES {
        out[i] = (0..N).map(|k| stencil.weight[k][i] * nodal.0[k][i]).sum();
    }
}

#[inline(always)]
fn carry<const N: usize>(s: &mut Scratch<N>, stencil: &Stencil<N>, axis: usize, moving: bool, pic: f64) {
    let [du, new, old, _] = &s.nodal;
    for i in 0..LANES {
        let (mut way, mut grid, mut start) = (0.0, 0.0, 0.0);
        for k in 0..N {
            let w = stencil.weight[k][i];
            way += w * du.0[k][i];
            grid += w * new.0[k][i];
            start += w * old.0[k][i];
        }
        s.x.0[axis][i] += way;
        if moving {
            let flip = s.v.0[axis][i] + (grid - start);
            s.v.0[axis][i] = flip + pic * (grid - flip);
        }
    }
}
