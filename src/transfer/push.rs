//! The explicit scheme's way from the nodes to the points, and the second map of MUSL.

use std::ops::Range;

use super::{Rule, Ruled};
use crate::{
    assembly::{
        Scratch,
        affine::{self, Affine},
        collect, deposit, place, spread,
    },
    body::{
        Body, Part, chunks, load,
        part::{common, store_all},
    },
    fault::{Fault, FaultKind},
    math::simd::Kernel,
    nodes::Nodes,
    space::{Grid, Shape, stencil::LANES},
};

/// Moves the points of a part and gives them their new velocity; with `remap` the momentum of the new
/// velocities goes back to the nodes, at the old positions (MUSL).
/// ```text
/// x_p += dt sum N_i v_i
/// ```
pub struct Push<'a, S, const N: usize> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a Body,
    pub part: Part<'a>,
    pub nodes: &'a mut Nodes,
    pub dt: f64,
    pub remap: bool,
    pub shape: S,
}

impl<S: Shape<N>, R: Rule, const N: usize> Kernel for Ruled<Push<'_, S, N>, R> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Ruled { pass: Push { scratch: s, body, mut part, nodes, dt, remap, .. }, rule } = self;
        let grid = nodes.grid;
        let mut block = 0;
        for group in &body.groups {
            for range in chunks(common(&group.range, &part.range)) {
                let ([vx, vy], [ox, oy]) = (&nodes.velocity, rule.second(nodes));
                // first, so that what it writes is in the cache when it is read
                spread(s.runs.of(block), &mut s.nodal, [vx, vy, ox, oy]);
                place::<S, N>(s, body, nodes, &range);
                for axis in 0..2 {
                    load(&mut s.v.0[axis], &body.committed.v[axis], &range);
                }
                move_points(s, dt, &rule);
                if !all_inside(s, &grid, range.len()) {
                    return Err(departure(s, body, &grid, &range));
                }
                let local = part.local(&range);
                store_all(&s.x.0, &mut part.x, &local);
                store_all(&s.v.0, &mut part.v, &local);
                let c = R::AFFINE.then(|| affine::fit::<S, N>(&s.stencil, [&s.nodal[0], &s.nodal[1]], grid.h));
                if let Some(c) = &c {
                    store_all(c, &mut part.affine, &local);
                }
                if remap {
                    load(&mut s.mass.0, &body.mass, &range);
                    shares_of_momentum::<S, N>(s, c.as_ref(), grid.h);
                    deposit_momentum(s, nodes, block);
                }
                block += 1;
            }
        }
        Ok(())
    }
}

#[inline(always)]
fn move_points<R: Rule, const N: usize>(s: &mut Scratch<N>, dt: f64, rule: &R) {
    for axis in 0..2 {
        let (new, second) = (&s.nodal[axis], &s.nodal[axis + 2]);
        for i in 0..LANES {
            let (mut grid, mut other) = (0.0, 0.0);
            for k in 0..N {
                grid += s.stencil.weight(k, i) * new.0[k][i];
                other += s.stencil.weight(k, i) * second.0[k][i];
            }
            s.v.0[axis][i] = rule.velocity(s.v.0[axis][i], grid, other);
            s.x.0[axis][i] += dt * grid;
        }
    }
}

#[inline(always)]
pub(super) fn all_inside<const N: usize>(s: &Scratch<N>, grid: &Grid, len: usize) -> bool {
    let far = grid.far();
    let mut outside = 0u64;
    for i in 0..LANES {
        let (x, y) = (s.x.0[0][i], s.x.0[1][i]);
        let inside = (x > grid.origin[0]) & (x < far[0]) & (y > grid.origin[1]) & (y < far[1]);
        outside += u64::from(!inside & (i < len));
    }
    outside == 0
}

/// The first point of a block that is not inside the grid, and what took it there.
#[cold]
pub(super) fn departure<const N: usize>(s: &Scratch<N>, body: &Body, grid: &Grid, range: &Range<usize>) -> Fault {
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
fn shares_of_momentum<S: Shape<N>, const N: usize>(s: &mut Scratch<N>, c: Option<&Affine>, h: f64) {
    let [px, py, ..] = &mut s.shares;
    for i in 0..LANES {
        let (mvx, mvy) = (s.mass.0[i] * s.v.0[0][i], s.mass.0[i] * s.v.0[1][i]);
        for k in 0..N {
            px.0[k][i] = s.stencil.weight(k, i) * mvx;
            py.0[k][i] = s.stencil.weight(k, i) * mvy;
        }
    }
    if let Some(c) = c {
        affine::add::<S, N>([px, py], &s.stencil, &s.mass.0, c, h);
    }
}

#[inline(always)]
fn deposit_momentum<const N: usize>(s: &Scratch<N>, nodes: &mut Nodes, block: usize) {
    for run in s.runs.of(block) {
        let slots = run.slots.map(|s| s as usize);
        let [x, y] = &mut nodes.momentum;
        deposit([x, y], &slots, collect(&s.shares[..2], run));
    }
}
