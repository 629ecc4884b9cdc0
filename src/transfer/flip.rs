//! FLIP with a share of PIC (Brackbill & Ruppel 1986).

use super::Rule;
use crate::nodes::Nodes;

/// Points keep their velocity and take what the nodes have gained:
/// ```text
/// v_p = (1 - a) (v_p + sum N_i (v_i - v_i,old)) + a sum N_i v_i,   a = 1 - exp(-pic_rate dt)
/// ```
#[derive(Clone, Copy)]
pub struct Flip {
    /// a, the share of PIC in this step.
    pub pic: f64,
}

impl Flip {
    /// With `pic_rate` (1/s) in a step of `dt` (s).
    pub fn new(pic_rate: f64, dt: f64) -> Self {
        Flip { pic: -(-pic_rate * dt).exp_m1() }
    }
}

impl Rule for Flip {
    const AFFINE: bool = false;

    fn second<'a>(&'a self, nodes: &'a Nodes) -> &'a [Vec<f64>; 2] {
        &nodes.old_velocity
    }

    #[inline(always)]
    fn velocity(&self, own: f64, grid: f64, old: f64) -> f64 {
        let flip = own + (grid - old);
        flip + self.pic * (grid - flip)
    }
}
