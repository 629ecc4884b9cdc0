//! Shape functions of a block of points: the stencil buffers that the stages share.

/// Points of a block: the lanes of the hot stages.
pub const LANES: usize = 32;

/// One number for each point of a block.
pub type Lane = [f64; LANES];

/// Consecutive points of a block that share their nodes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Run {
    /// Lower left node of the patch.
    pub base: u32,
    /// First lane, and one past the last.
    pub start: u32,
    pub end: u32,
}

/// Shape functions of `N` nodes for each point, and the runs of points with equal nodes.
///
/// Every shape function is a product of one along x and one along y, over a patch of M x M = `N`
/// nodes numbered row by row:
/// ```text
/// N_k = X_a Y_b,   d N_k / d x = X'_a Y_b,   d N_k / d y = X_a Y'_b,   k = a + M b
/// ```
/// The stencil keeps the factors; the products are made where they are used, out of registers.
#[repr(align(64))]
#[derive(Clone)]
pub struct Stencil<const N: usize> {
    /// Along x and along y: the M weights X_a, then their M slopes X'_a (1/m). 2 M is at most `N`.
    factors: [[Lane; N]; 2],
    /// Lower left node of each point's patch.
    pub base: [u32; LANES],
    runs: [Run; LANES],
    count: usize,
}

impl<const N: usize> Default for Stencil<N> {
    fn default() -> Self {
        Stencil { factors: [[[0.0; LANES]; N]; 2], base: [0; LANES], runs: [Run::default(); LANES], count: 0 }
    }
}

impl<const N: usize> Stencil<N> {
    /// M, nodes of the patch along an axis.
    const SPAN: usize = N.isqrt();

    /// N_k of point `i`.
    #[inline(always)]
    pub fn weight(&self, k: usize, i: usize) -> f64 {
        let [x, y] = &self.factors;
        x[k % Self::SPAN][i] * y[k / Self::SPAN][i]
    }

    /// d N_k / d x and d N_k / d y of point `i` (1/m).
    #[inline(always)]
    pub fn grad(&self, k: usize, i: usize) -> [f64; 2] {
        let [x, y] = &self.factors;
        let (a, b) = (k % Self::SPAN, k / Self::SPAN);
        [x[Self::SPAN + a][i] * y[b][i], x[a][i] * y[Self::SPAN + b][i]]
    }

    /// Sets the `M` factors of point `i` along an axis, and their slopes (1/m).
    #[inline(always)]
    pub fn set<const M: usize>(&mut self, axis: usize, i: usize, weight: [f64; M], slope: [f64; M]) {
        for a in 0..M {
            self.factors[axis][a][i] = weight[a];
            self.factors[axis][M + a][i] = slope[a];
        }
    }

    /// The runs of the first points of the block.
    #[inline(always)]
    pub fn runs(&self) -> &[Run] {
        &self.runs[..self.count.min(LANES)]
    }

    /// Finds the runs among the first `len` points.
    #[inline(always)]
    pub fn find_runs(&mut self, len: usize) {
        let mut ends = self.ends(len);
        self.count = ends.count_ones() as usize;
        let mut start = 0;
        for run in &mut self.runs[..self.count.min(LANES)] {
            let last = ends.trailing_zeros();
            *run = Run { base: self.base[start as usize % LANES], start, end: last + 1 };
            start = last + 1;
            ends &= ends.wrapping_sub(1);
        }
    }

    /// Bit i is set where point i is the last of its run.
    #[inline(always)]
    fn ends(&self, len: usize) -> u32 {
        let mut bits = 0;
        for i in 0..LANES - 1 {
            bits |= u32::from(self.base[i] != self.base[i + 1]) << i;
        }
        let last = 1u32 << (len.clamp(1, LANES) - 1);
        if len == 0 { 0 } else { (bits & (last - 1)) | last }
    }
}
