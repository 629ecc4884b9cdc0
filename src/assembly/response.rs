//! Internal force of a body that nodal increments strain, and its tangent: the implicit scheme's
//! pass over the blocks. The stencils are filled once and kept.

use std::ops::Range;

use super::{
    BodyRuns, Patch, RunPatch, Scratch, collect, deposit, dot, load_point_state, place, smooth::Cells, spread,
    store_point_state,
};
use crate::{
    block::{Block, Moduli3},
    body::{Body, chunks, load, set_uniform},
    domain,
    fault::Fault,
    math::{simd::Kernel, sparse::offset_bit},
    nodes::Nodes,
    space::{
        Shape, Stencil,
        stencil::{LANES, Lane},
    },
    system::System,
};

/// The stencils of all blocks, and how the nodes of a patch are coupled.
pub struct Kept<const N: usize> {
    pub stencils: Vec<Stencil<N>>,
    /// Bit of node i of a patch as seen from its node j.
    pub(super) bits: [[u32; N]; N],
    /// All nodes of a patch as seen from its node k.
    masks: [u64; N],
    pub(super) points: Box<PointBuffers>,
    /// Where the dilatation is smoothed over cells: the cells, and the cell of each point.
    pub cells: Option<Box<Cells>>,
}

/// Buffers of one block.
pub(super) struct PointBuffers {
    pub moduli: Moduli3,
    pub kirchhoff: Kirchhoff,
    nominal: Nominal,
    /// V0 d P_aA / d (grad du)_cB: row a A, column c B.
    stiffness: [[Lane; 4]; 4],
}

/// J sigma: xx, yy, xy (kPa).
pub(super) type Kirchhoff = [Lane; 3];

/// V0 P_aA, with P = J sigma F^-T: xx, xy, yx, yy (kN m/m).
type Nominal = [Lane; 4];

impl<const N: usize> Kept<N> {
    /// For a shape function, none filled yet.
    pub fn new<S: Shape<N>>() -> Self {
        // in a row of this many nodes no two places of a patch share a number
        const ROW: u32 = 1 << 16;
        let place = S::offsets(ROW).map(|o| [(o % ROW) as i32, (o / ROW) as i32]);
        let bit = |i: usize, j: usize| offset_bit(place[i][0] - place[j][0], place[i][1] - place[j][1]);
        let bits: [[u32; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| bit(i, j)));
        let masks = std::array::from_fn(|k| (0..N).fold(0, |m, l| m | 1 << bits[l][k]));
        Kept { stencils: Vec::new(), bits, masks, points: Box::default(), cells: None }
    }

    /// Smooths the dilatation over the cells from now on.
    pub fn smooth(&mut self) {
        self.cells = Some(Box::default());
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.stencils.capacity() * size_of::<Stencil<N>>() + self.cells.as_ref().map_or(0, |c| c.bytes())
    }
}

impl Default for PointBuffers {
    fn default() -> Self {
        PointBuffers {
            moduli: [[[0.0; LANES]; 4]; 3],
            kirchhoff: [[0.0; LANES]; 3],
            nominal: [[0.0; LANES]; 4],
            stiffness: [[[0.0; LANES]; 4]; 4],
        }
    }
}

/// Fills and keeps the stencils of the committed body, and notes the couplings of its runs.
pub struct Keep<'a, S, const N: usize> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a Body,
    pub nodes: &'a Nodes,
    pub kept: &'a mut Kept<N>,
    pub system: &'a mut System,
    pub shape: S,
}

impl<S: Shape<N>, const N: usize> Kernel for Keep<'_, S, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Keep { scratch: s, body, nodes, kept, system, .. } = self;
        let mut block = 0;
        if let Some(cells) = &mut kept.cells {
            cells.begin(&nodes.grid, body.len());
        }
        for group in &body.groups {
            for range in chunks(group.range.clone()) {
                place::<S, N>(s, body, nodes, &range);
                if block == kept.stencils.len() {
                    kept.stencils.push(Stencil::default());
                }
                kept.stencils[block].clone_from(&s.stencil);
                for run in s.runs.of(block) {
                    for (slot, mask) in run.slots.iter().zip(kept.masks) {
                        system.couple(*slot as usize, mask);
                    }
                    if let Some(cells) = &mut kept.cells {
                        for lane in run.start as usize..run.end as usize {
                            cells.place(&nodes.grid, range.start + lane, [s.x.0[0][lane], s.x.0[1][lane]], &run.slots);
                        }
                    }
                }
                block += 1;
            }
        }
        if let Some(cells) = &kept.cells {
            cells.couple(nodes, system);
        }
    }
}

/// What points carry, to the nodes by the kept stencils: out_i = sum N_i(x_p) q_p.
pub struct Map<'a, Q, const N: usize> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a Body,
    pub kept: &'a Kept<N>,
    /// q of the points with these indices in the body, for an axis.
    pub quantity: Q,
    pub out: &'a mut [Vec<f64>; 2],
}

impl<Q: Fn(usize, usize) -> f64, const N: usize> Kernel for Map<'_, Q, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Map { scratch: s, body, kept, quantity, out } = self;
        let ranges = body.groups.iter().flat_map(|g| chunks(g.range.clone()));
        for (block, range) in ranges.enumerate() {
            let stencil = &kept.stencils[block];
            for axis in 0..2 {
                for (lane, i) in range.clone().enumerate() {
                    let q = quantity(i, axis);
                    for k in 0..N {
                        s.shares[axis].0[k][lane] = stencil.weight(k, lane) * q;
                    }
                }
            }
            for run in s.runs.of(block) {
                let slots = run.slots.map(|s| s as usize);
                let [x, y] = &mut *out;
                deposit([x, y], &slots, collect(&s.shares[..2], run));
            }
        }
    }
}

/// Internal force into the residual, and with `tangent` its derivative into the values; trial
/// strain, J and history of the body are written, and the plastic work (kJ/m) is returned.
/// ```text
/// r_ia += sum V0 P_aA dN_i/dX_A,   P = J sigma F^-T,   F = I + sum du_i (x) dN_i/dX
/// K_iajb += sum V0 dN_i/dX_A (dP_aA / dF_bB) dN_j/dX_B
/// ```
/// X is the position at the start of the step, V0 the initial volume. In small strain F = I.
pub struct Respond<'a, S, const N: usize> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a mut Body,
    pub kept: &'a mut Kept<N>,
    pub system: &'a mut System,
    pub tangent: bool,
    pub shape: S,
}

impl<S: Shape<N>, const N: usize> Kernel for Respond<'_, S, N> {
    type Output = Result<f64, Fault>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Respond { scratch: s, body, kept, system, tangent, .. } = self;
        let (mut plastic_work, mut block) = (0.0, 0);
        for g in 0..body.groups.len() {
            set_uniform(&mut s.block, &body.groups[g]);
            let finite = body.groups[g].law.finite();
            for range in chunks(body.groups[g].range.clone()) {
                let stencil = &kept.stencils[block];
                strain(s, stencil, system, block);
                if S::DOMAIN && finite {
                    domain::deform(body, &s.block.du, &range);
                }
                update(s, body, g, &range)?;
                plastic_work += dot(&s.block.dissipation, &s.volume.0, range.len());
                let points = kept.points.as_mut();
                kirchhoff(&s.block, &mut points.kirchhoff);
                if tangent {
                    system.symmetric &= body.groups[g].law.linearise(&s.block, &mut points.moduli);
                }
                respond(s, stencil, &kept.bits, points, system, Pass { block, finite, tangent });
                block += 1;
            }
        }
        Ok(plastic_work)
    }
}

/// Which block a pass is at, and what it does there.
#[derive(Clone, Copy)]
pub(super) struct Pass {
    pub block: usize,
    pub finite: bool,
    pub tangent: bool,
}

/// Force and stiffness of a block from its stress and moduli.
#[inline(always)]
pub(super) fn respond<const N: usize>(
    s: &mut Scratch<N>,
    stencil: &Stencil<N>,
    bits: &[[u32; N]; N],
    points: &mut PointBuffers,
    system: &mut System,
    pass: Pass,
) {
    nominal(&s.block, &s.volume.0, pass.finite, &points.kirchhoff, &mut points.nominal);
    force(s, stencil, &points.nominal, system, pass.block);
    if pass.tangent {
        pull_back(&s.block, &s.volume.0, pass.finite, &points.kirchhoff, &points.moduli, &mut points.stiffness);
        for run in s.runs.of(pass.block) {
            let k = of_run(stencil, &points.stiffness, run);
            add(system, bits, run, &k);
        }
    }
}

/// J sigma of the block.
#[inline(always)]
pub(super) fn kirchhoff(b: &Block, out: &mut Kirchhoff) {
    for i in 0..LANES {
        let j = b.trial_jacobian[i];
        out[0][i] = j * b.stress[0][i];
        out[1][i] = j * b.stress[1][i];
        out[2][i] = j * b.stress[3][i];
    }
}

/// grad du = sum du_i (x) grad N_i.
#[inline(always)]
pub(super) fn strain<const N: usize>(s: &mut Scratch<N>, stencil: &Stencil<N>, system: &System, block: usize) {
    let [ux, uy] = &system.du;
    spread(s.runs.of(block), &mut s.nodal, [ux, uy]);
    let [ux, uy, ..] = &s.nodal;
    for i in 0..LANES {
        let mut du = [0.0; 4];
        for k in 0..N {
            let [gx, gy] = stencil.grad(k, i);
            du[0] += ux.0[k][i] * gx;
            du[1] += ux.0[k][i] * gy;
            du[2] += uy.0[k][i] * gx;
            du[3] += uy.0[k][i] * gy;
        }
        for c in 0..4 {
            s.block.du[c][i] = du[c];
        }
    }
}

/// Law over the block; the results go to the body's trial state.
#[inline(always)]
pub(super) fn update<const N: usize>(
    s: &mut Scratch<N>,
    body: &mut Body,
    g: usize,
    range: &Range<usize>,
) -> Result<(), Fault> {
    load_point_state(&mut s.block, &body.groups[g], body, range);
    if let Err(fault) = body.groups[g].law.update(&mut s.block) {
        return Err(body.blame(fault, range.start));
    }
    store_point_state(&s.block, body, range);
    load(&mut s.volume.0, &body.volume, range);
    Ok(())
}

/// F^-1 of lane `i`: [[xx, xy], [yx, yy]].
#[inline(always)]
pub(super) fn inverse(b: &Block, i: usize, finite: bool) -> [[f64; 2]; 2] {
    if !finite {
        return [[1.0, 0.0], [0.0, 1.0]];
    }
    let (fxx, fxy, fyx, fyy) = (1.0 + b.du[0][i], b.du[1][i], b.du[2][i], 1.0 + b.du[3][i]);
    let d = 1.0 / (fxx * fyy - fxy * fyx);
    [[d * fyy, -d * fxy], [-d * fyx, d * fxx]]
}

/// V0 P = V0 J sigma F^-T.
#[inline(always)]
fn nominal(b: &Block, volume: &Lane, finite: bool, t: &Kirchhoff, out: &mut Nominal) {
    for i in 0..LANES {
        let [txx, tyy, txy] = [volume[i] * t[0][i], volume[i] * t[1][i], volume[i] * t[2][i]];
        let f = inverse(b, i, finite);
        out[0][i] = txx * f[0][0] + txy * f[0][1];
        out[1][i] = txx * f[1][0] + txy * f[1][1];
        out[2][i] = txy * f[0][0] + tyy * f[0][1];
        out[3][i] = txy * f[1][0] + tyy * f[1][1];
    }
}

#[inline(always)]
fn force<const N: usize>(s: &mut Scratch<N>, stencil: &Stencil<N>, p: &Nominal, system: &mut System, block: usize) {
    let [fx, fy, ..] = &mut s.shares;
    for i in 0..LANES {
        for k in 0..N {
            let [gx, gy] = stencil.grad(k, i);
            fx.0[k][i] = p[0][i] * gx + p[1][i] * gy;
            fy.0[k][i] = p[2][i] * gx + p[3][i] * gy;
        }
    }
    scatter(&s.runs, &s.shares, system, block);
}

#[inline(always)]
fn scatter<const N: usize>(runs: &BodyRuns<N>, shares: &[Patch<N>], system: &mut System, block: usize) {
    for run in runs.of(block) {
        let slots = run.slots.map(|s| s as usize);
        let [x, y] = &mut system.residual;
        deposit([x, y], &slots, collect(&shares[..2], run));
    }
}

/// From d(J sigma) / d l to V0 d P / d(grad du): with t = J sigma and G = F^-1,
/// ```text
/// C_ab,cd = d t_ab / d l_cd - t_ad delta_bc,   A_aA,cB = V0 G_Ab C_ab,cd G_Bd
/// ```
#[inline(always)]
fn pull_back(b: &Block, volume: &Lane, finite: bool, kirchhoff: &Kirchhoff, m: &Moduli3, out: &mut [[Lane; 4]; 4]) {
    let turn = if finite { 1.0 } else { 0.0 };
    for i in 0..LANES {
        let [txx, tyy, txy] = [turn * kirchhoff[0][i], turn * kirchhoff[1][i], turn * kirchhoff[2][i]];
        let t = [[txx, txy], [txy, tyy]];
        let g = inverse(b, i, finite);
        for a in 0..2 {
            // rows a b of C, b = x, y
            let row = |b: usize| if a == b { a } else { 2 };
            let mut c = [[0.0; 4]; 2];
            for b in 0..2 {
                for k in 0..4 {
                    c[b][k] = m[row(b)][k][i];
                }
                for d in 0..2 {
                    c[b][2 * b + d] -= t[a][d];
                }
            }
            for big in 0..2 {
                for k in 0..2 {
                    let left = |d: usize| volume[i] * (g[big][0] * c[0][2 * k + d] + g[big][1] * c[1][2 * k + d]);
                    let (l0, l1) = (left(0), left(1));
                    out[2 * a + big][2 * k][i] = l0 * g[0][0] + l1 * g[0][1];
                    out[2 * a + big][2 * k + 1][i] = l0 * g[1][0] + l1 * g[1][1];
                }
            }
        }
    }
}

/// Stiffness of the points of a run: row node and axis, column axis and node.
type RunStiffness<const N: usize> = [[[[f64; N]; 2]; 2]; N];

#[inline(always)]
fn of_run<const N: usize>(stencil: &Stencil<N>, stiffness: &[[Lane; 4]; 4], run: &RunPatch<N>) -> RunStiffness<N> {
    let mut sum = [[[[0.0; N]; 2]; 2]; N];
    for p in run.start as usize..(run.end as usize).min(LANES) {
        let g: [[f64; N]; 2] = [0, 1].map(|axis| std::array::from_fn(|k| stencil.grad(k, p)[axis]));
        // h[a A][c] = sum_B A_aA,cB dN_j/dX_B, for all nodes j
        let mut h = [[[0.0; N]; 2]; 4];
        for (row, from) in h.iter_mut().zip(stiffness) {
            for c in 0..2 {
                for j in 0..N {
                    row[c][j] = from[2 * c][p] * g[0][j] + from[2 * c + 1][p] * g[1][j];
                }
            }
        }
        for i in 0..N {
            for a in 0..2 {
                for c in 0..2 {
                    for j in 0..N {
                        sum[i][a][c][j] += g[0][i] * h[2 * a][c][j] + g[1][i] * h[2 * a + 1][c][j];
                    }
                }
            }
        }
    }
    sum
}

#[inline(always)]
fn add<const N: usize>(system: &mut System, bits: &[[u32; N]; N], run: &RunPatch<N>, k: &RunStiffness<N>) {
    let System { pattern, values, .. } = system;
    for j in 0..N {
        let column = pattern.rank(run.slots[j] as usize);
        let stride = pattern.stride(column);
        for i in 0..N {
            let at = pattern.block(column, bits[i][j]);
            values[at] += k[i][0][0][j];
            values[at + 1] += k[i][1][0][j];
            values[at + stride] += k[i][0][1][j];
            values[at + stride + 1] += k[i][1][1][j];
        }
    }
}
