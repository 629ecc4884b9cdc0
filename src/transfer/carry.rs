//! The implicit scheme's way from the nodes to the points.

use super::{
    Rule, Ruled,
    push::{all_inside, departure},
};
use crate::{
    assembly::{Scratch, Spread, affine, response::Kept, spread},
    body::{Body, chunks, load, store},
    fault::Fault,
    math::simd::Kernel,
    nodes::Nodes,
    space::{
        Shape, Stencil,
        stencil::{LANES, Lane},
    },
    system::System,
};

/// Moves the points with the increments of an implicit step, and gives them their new velocity
/// where there is inertia (`moving`).
/// ```text
/// x_p += sum N_i du_i
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
    pub shape: S,
}

impl<S: Shape<N>, R: Rule, const N: usize> Kernel for Ruled<Carry<'_, S, N>, R> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Ruled { pass: Carry { scratch: s, body, nodes, kept, system, moving, unbound, acceleration, .. }, rule } =
            self;
        let mut block = 0;
        for g in 0..body.groups.len() {
            for range in chunks(body.groups[g].range.clone()) {
                let stencil = &kept.stencils[block];
                for axis in 0..2 {
                    load(&mut s.x.0[axis], &body.committed.x[axis], &range);
                    load(&mut s.v.0[axis], &body.committed.v[axis], &range);
                    let [du, v, second] = [&system.du[axis], &nodes.velocity[axis], &rule.second(nodes)[axis]];
                    spread(s.runs.of(block), &mut s.nodal, [du, v, second]);
                    carry(s, stencil, axis, moving.then_some(&rule));
                }
                let sound = if unbound { all_finite(s, range.len()) } else { all_inside(s, &nodes.grid, range.len()) };
                if !sound {
                    return Err(departure(s, body, &nodes.grid, &range));
                }
                for axis in 0..2 {
                    store(&s.x.0[axis], &mut body.trial.x[axis], &range);
                    store(&s.v.0[axis], &mut body.trial.v[axis], &range);
                }
                if R::AFFINE && moving {
                    spread(s.runs.of(block), &mut s.nodal, [&nodes.velocity[0], &nodes.velocity[1]]);
                    let c = affine::fit::<S, N>(stencil, [&s.nodal[0], &s.nodal[1]], nodes.grid.h);
                    affine::keep(&c, body, &range);
                } else if R::AFFINE {
                    affine::keep(&affine::committed(body, &range), body, &range);
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

/// Whether the places of the first `len` points are numbers.
fn all_finite<const N: usize>(s: &Scratch<N>, len: usize) -> bool {
    s.x.0.iter().all(|x| x[..len].iter().all(|v| v.is_finite()))
}

/// sum N_i a_i.
#[inline(always)]
fn interpolate<const N: usize>(nodal: &Spread<N>, stencil: &Stencil<N>, out: &mut Lane) {
    for i in 0..LANES {
        out[i] = (0..N).map(|k| stencil.weight(k, i) * nodal.0[k][i]).sum();
    }
}

/// The way along an axis, and the velocity where there is a rule for it.
#[inline(always)]
fn carry<R: Rule, const N: usize>(s: &mut Scratch<N>, stencil: &Stencil<N>, axis: usize, rule: Option<&R>) {
    let [du, new, second, _] = &s.nodal;
    for i in 0..LANES {
        let (mut way, mut grid, mut other) = (0.0, 0.0, 0.0);
        for k in 0..N {
            let w = stencil.weight(k, i);
            way += w * du.0[k][i];
            grid += w * new.0[k][i];
            other += w * second.0[k][i];
        }
        s.x.0[axis][i] += way;
        if let Some(rule) = rule {
            s.v.0[axis][i] = rule.velocity(s.v.0[axis][i], grid, other);
        }
    }
}
