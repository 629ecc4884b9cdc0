//! APIC (Jiang et al. 2015): points take the velocity of the nodes, and its gradient.

use super::Rule;
use crate::nodes::Nodes;

/// v_p = sum N_i v_i, and C_p of `assembly::affine`, with which they give the nodes back what they took:
/// nothing is filtered that is linear over a patch, and nothing is kept that the nodes do not see.
#[derive(Clone, Copy)]
pub struct Apic;

impl Rule for Apic {
    const AFFINE: bool = true;

    fn second<'a>(&'a self, nodes: &'a Nodes) -> &'a [Vec<f64>; 2] {
        &nodes.velocity
    }

    #[inline(always)]
    fn velocity(&self, _: f64, grid: f64, _: f64) -> f64 {
        grid
    }
}
