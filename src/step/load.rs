//! Forces on points, and the way to the nodes.

use std::ops::Range;

use crate::{
    assembly::{Scratch, collect, deposit, place},
    body::{Body, chunks, load, part::common},
    effect::{Clock, Effect},
    math::simd::Kernel,
    nodes::Nodes,
    space::{Shape, stencil::LANES},
};

/// Forces on the points (kN/m), in the order of the body.
pub type PointForces = [Vec<f64>; 2];

/// Asks the effects in `list` for their forces on the points.
pub fn gather(forces: &mut PointForces, effects: &mut [Box<dyn Effect>], list: &[usize], body: &Body, clock: Clock) {
    for column in forces.iter_mut() {
        column.clear();
        column.resize(body.len(), 0.0);
    }
    let [fx, fy] = forces;
    let mut push = |i: usize, f: [f64; 2]| {
        fx[i] += f[0];
        fy[i] += f[1];
    };
    list.iter().for_each(|&e| effects[e].load(body, clock, &mut push));
}

/// Adds the forces of the points to the nodes, with the runs that [`crate::assembly::Scatter`] has found:
/// ```text
/// f_i += sum N_i(x_p) f_p
/// ```
pub struct Spread<'a, S, const N: usize> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a Body,
    pub nodes: &'a mut Nodes,
    pub forces: &'a PointForces,
    /// The points of the pass, those of the runs.
    pub stretch: Range<usize>,
    pub shape: S,
}

impl<S: Shape<N>, const N: usize> Kernel for Spread<'_, S, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Spread { scratch: s, body, nodes, forces, stretch, .. } = self;
        let blocks = body.groups.iter().flat_map(|g| chunks(common(&g.range, &stretch)));
        for (b, range) in blocks.enumerate() {
            let loaded = forces.iter().any(|f| f[range.clone()].iter().any(|f| *f != 0.0));
            if !loaded {
                continue;
            }
            place::<S, N>(s, body, nodes, &range);
            for axis in 0..2 {
                // the lanes of the velocity are free at this point of the step
                load(&mut s.v.0[axis], &forces[axis], &range);
            }
            deposit_block(s, nodes, b);
        }
    }
}

#[inline(always)]
fn deposit_block<const N: usize>(s: &mut Scratch<N>, nodes: &mut Nodes, block: usize) {
    let [fx, fy, ..] = &mut s.shares;
    for k in 0..N {
        for i in 0..LANES {
            fx.0[k][i] = s.stencil.weight(k, i) * s.v.0[0][i];
            fy.0[k][i] = s.stencil.weight(k, i) * s.v.0[1][i];
        }
    }
    for run in s.runs.of(block) {
        let slots = run.slots.map(|s| s as usize);
        let [x, y] = &mut nodes.force;
        deposit([x, y], &slots, collect(&s.shares[..2], run));
    }
}
