//! The body in parts, so that threads may write the trial state side by side.

use std::ops::Range;

use super::{Body, State, chunks, store};
use crate::{
    block::{Block, MAX_STATES},
    space::stencil::{LANES, Lane},
};

/// The trial columns of a stretch of the points; those that a body does not have are empty.
#[derive(Default)]
pub struct Part<'a> {
    /// The points, by their places in the columns of the body.
    pub range: Range<usize>,
    pub x: [&'a mut [f64]; 2],
    pub v: [&'a mut [f64]; 2],
    pub strain: [&'a mut [f64]; 4],
    pub jacobian: &'a mut [f64],
    pub history: [&'a mut [f64]; MAX_STATES],
    pub deformation: [&'a mut [f64]; 4],
    pub affine: [&'a mut [f64]; 4],
}

impl<'a> Part<'a> {
    /// All points of a trial state.
    pub fn whole(trial: &'a mut State) -> Self {
        let State { x, v, strain, jacobian, history, deformation, affine, .. } = trial;
        let mut part = Part { range: 0..jacobian.len(), jacobian, ..Part::default() };
        fill(&mut part.x, x);
        fill(&mut part.v, v);
        fill(&mut part.strain, strain);
        fill(&mut part.history, history);
        fill(&mut part.deformation, deformation);
        fill(&mut part.affine, affine);
        part
    }

    /// Takes the first `n` points off.
    pub fn take_front(&mut self, n: usize) -> Part<'a> {
        let middle = (self.range.start + n).min(self.range.end);
        let front = Part {
            range: self.range.start..middle,
            x: self.x.each_mut().map(|c| cut(c, n)),
            v: self.v.each_mut().map(|c| cut(c, n)),
            strain: self.strain.each_mut().map(|c| cut(c, n)),
            jacobian: cut(&mut self.jacobian, n),
            history: self.history.each_mut().map(|c| cut(c, n)),
            deformation: self.deformation.each_mut().map(|c| cut(c, n)),
            affine: self.affine.each_mut().map(|c| cut(c, n)),
        };
        self.range.start = middle;
        front
    }

    /// The places of a block in the columns of the part.
    #[inline(always)]
    pub fn local(&self, block: &Range<usize>) -> Range<usize> {
        block.start - self.range.start..block.end - self.range.start
    }

    /// Stores what the law has made of a block.
    #[inline(always)]
    pub fn store_point_state(&mut self, block: &Block, range: &Range<usize>) {
        let local = self.local(range);
        store_all(&block.trial_strain, &mut self.strain, &local);
        store(&block.trial_jacobian, self.jacobian, &local);
        store_all(&block.trial_state, &mut self.history, &local);
    }
}

fn fill<'a>(part: &mut [&'a mut [f64]], columns: &'a mut [super::Strip]) {
    part.iter_mut().zip(columns).for_each(|(to, from)| *to = from);
}

/// Takes the first `n` entries off a column, or all that there are.
fn cut<'a>(column: &mut &'a mut [f64], n: usize) -> &'a mut [f64] {
    let whole = std::mem::take(column);
    let (front, rest) = whole.split_at_mut(n.min(whole.len()));
    *column = rest;
    front
}

/// Stores lanes in the columns that there are.
#[inline(always)]
pub fn store_all(lanes: &[Lane], columns: &mut [&mut [f64]], range: &Range<usize>) {
    for (lane, column) in lanes.iter().zip(columns) {
        if !column.is_empty() {
            store(lane, column, range);
        }
    }
}

/// Points of a body below which it is one part: small runs have nothing to gain.
const LEAST: usize = 16_384;

/// Cuts the points into stretches of whole blocks, whose number follows from the body alone. A part shares about a row of
/// nodes with the next one, so parts hold some rows of cells: 16 sqrt(n) points, and at least 4096.
pub fn parts(body: &Body) -> Vec<Range<usize>> {
    let n = body.len();
    let most = if n < LEAST { usize::MAX } else { (16 * n.isqrt()).max(4096) / LANES };
    let mut parts: Vec<(Range<usize>, usize)> = Vec::new();
    for block in body.groups.iter().flat_map(|g| chunks(g.range.clone())) {
        match parts.last_mut() {
            Some((range, blocks)) if *blocks < most => (range.end, *blocks) = (block.end, *blocks + 1),
            _ => parts.push((block, 1)),
        }
    }
    parts.into_iter().map(|(range, _)| range).collect()
}

/// What two stretches have in common.
#[inline(always)]
pub fn common(a: &Range<usize>, b: &Range<usize>) -> Range<usize> {
    let start = a.start.max(b.start);
    start..a.end.min(b.end).max(start)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hold_each_point_once_in_whole_blocks() {
        for n in [0, 5, LEAST - 1, LEAST, 100_003] {
            let body = crate::body::tests::points(n);
            let parts = parts(&body);
            assert_eq!(parts.iter().map(Range::len).sum::<usize>(), n);
            assert!(parts.windows(2).all(|p| p[0].end == p[1].start && p[0].len().is_multiple_of(LANES)));
            assert_eq!(parts.len() <= 1, n < LEAST, "{n}: {}", parts.len());
        }
    }

    #[test]
    fn a_part_writes_its_points_and_no_others() {
        let mut body = crate::body::tests::points(100);
        let mut rest = Part::whole(&mut body.trial);
        let mut part = {
            rest.take_front(32);
            rest.take_front(64)
        };
        let local = part.local(&(64..96));
        assert_eq!((part.range.clone(), local.clone(), rest.range), (32..96, 32..64, 96..100));
        store(&[7.0; LANES], part.x[0], &local);
        store_all(&[[8.0; LANES]; 4], &mut part.affine, &local);
        assert!(body.trial.x[0].iter().enumerate().all(|(i, x)| (*x == 7.0) == (64..96).contains(&i)));
    }
}
