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

/// Weights and gradients of `N` nodes for each point, and the runs of points with equal nodes.
#[repr(align(64))]
#[derive(Clone)]
pub struct Stencil<const N: usize> {
    /// N_k(x_p).
    pub weight: [Lane; N],
    /// d N_k / d x and d N_k / d y (1/m).
    pub grad: [[Lane; N]; 2],
    /// Lower left node of each point's patch.
    pub base: [u32; LANES],
    runs: [Run; LANES],
    count: usize,
}

impl<const N: usize> Default for Stencil<N> {
    fn default() -> Self {
        Stencil {
            weight: [[0.0; LANES]; N],
            grad: [[[0.0; LANES]; N]; 2],
            base: [0; LANES],
            runs: [Run::default(); LANES],
            count: 0,
        }
    }
}

impl<const N: usize> Stencil<N> {
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
