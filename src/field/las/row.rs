//! One row of parents, split; and the adjoint of that.

use super::split::{DRAWN, NEIGHBOURS, SELF, Split};
use crate::math::simd::Kernel;

/// The kind of a parent along an axis of `n` parents: bit 0, there is one before; bit 1, one after.
pub fn kind(i: usize, n: usize) -> usize {
    usize::from(i > 0) + 2 * usize::from(i + 1 < n)
}

/// A row of n parents on its way to two rows of children.
pub struct Row<'a> {
    /// Weights by kind along x.
    pub splits: &'a [Split; 4],
    /// The rows below, of, and above the parents; one that is not there is any row, and has weights 0.
    pub parents: [&'a [f64]; 3],
    /// Normals of child 0, 1, 2 of all parents.
    pub normals: [&'a [f64]; DRAWN],
    /// Children, lower and upper row: 2 n, or 2 n - 1 where the last lies outside the lattice.
    pub children: [&'a mut [f64]; 2],
}

impl Kernel for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let n = self.parents[1].len();
        self.edge(0, n);
        if n > 1 {
            self.inner(n);
            self.edge(n - 1, n);
        }
    }
}

impl Row<'_> {
    /// A parent that lacks a neighbour.
    #[inline(always)]
    fn edge(&mut self, i: usize, n: usize) {
        let split = &self.splits[kind(i, n)];
        let columns = [i.saturating_sub(1), i, (i + 1).min(n - 1)];
        let near: [f64; NEIGHBOURS] = std::array::from_fn(|q| self.parents[q / 3][columns[q % 3]]);
        let all = children(split, near, self.normals.map(|u| u[i]));
        for (row, pair) in self.children.iter_mut().zip([[all[0], all[1]], [all[2], all[3]]]) {
            for (out, child) in row[2 * i..].iter_mut().zip(pair) {
                *out = child;
            }
        }
    }

    /// All parents but the first and the last.
    #[inline(always)]
    fn inner(&mut self, n: usize) {
        let split = self.splits[3];
        let m = n - 2;
        let near: [&[f64]; NEIGHBOURS] = std::array::from_fn(|q| &self.parents[q / 3][q % 3..q % 3 + m]);
        let normals = self.normals.map(|u| &u[1..1 + m]);
        let [low, high] = &mut self.children;
        let (low, high) = (&mut low[2..2 + 2 * m], &mut high[2..2 + 2 * m]);
        for (i, (low, high)) in low.as_chunks_mut().0.iter_mut().zip(high.as_chunks_mut().0).enumerate() {
            let all = children(&split, near.map(|row| row[i]), normals.map(|u| u[i]));
            *low = [all[0], all[1]];
            *high = [all[2], all[3]];
        }
    }
}

/// The four children of a parent with neighbours `near`.
#[inline(always)]
fn children(split: &Split, near: [f64; NEIGHBOURS], u: [f64; DRAWN]) -> [f64; 4] {
    let mut z = [0.0; 4];
    let mut others = 0.0;
    for (k, (a, c)) in split.a.iter().zip(&split.c).enumerate() {
        let mut sum = 0.0;
        a.iter().zip(&near).for_each(|(a, parent)| sum += a * parent);
        c.iter().zip(&u).take(k + 1).for_each(|(c, u)| sum += c * u);
        z[k] = sum;
        others += sum;
    }
    z[3] = 4.0 * near[SELF] - others;
    z
}

/// The adjoint of [`children`]: adds to the neighbours, and gives what goes to the normals.
#[inline(always)]
pub fn gather(split: &Split, z: [f64; 4], mut add: impl FnMut(usize, f64)) -> [f64; DRAWN] {
    let h: [f64; DRAWN] = std::array::from_fn(|k| z[k] - z[3]);
    for q in 0..NEIGHBOURS {
        add(q, split.a[0][q] * h[0] + split.a[1][q] * h[1] + split.a[2][q] * h[2]);
    }
    add(SELF, 4.0 * z[3]);
    std::array::from_fn(|l| (l..DRAWN).map(|k| split.c[k][l] * h[k]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::simd::FpPath;

    /// All instruction sets give the same bits, and rows of any length both ends.
    #[test]
    fn paths_agree_to_the_bit() {
        let number = |i: usize| ((i * 7919 + 13) % 101) as f64 / 101.0 - 0.5;
        let split = |s: usize| Split {
            a: std::array::from_fn(|k| std::array::from_fn(|q| number(s + 9 * k + q))),
            c: std::array::from_fn(|k| std::array::from_fn(|l| number(s + 50 + 3 * k + l))),
        };
        let splits: [Split; 4] = std::array::from_fn(|s| split(100 * s));
        for n in 1..24 {
            for width in [2 * n - 1, 2 * n] {
                let numbers: Vec<Vec<f64>> = (0..6).map(|r| (0..n).map(|i| number(r * n + i)).collect()).collect();
                let run = |path: FpPath| {
                    let (mut low, mut high) = (vec![f64::NAN; width], vec![f64::NAN; width]);
                    path.run(Row {
                        splits: &splits,
                        parents: [&numbers[0], &numbers[1], &numbers[2]],
                        normals: [&numbers[3], &numbers[4], &numbers[5]],
                        children: [&mut low, &mut high],
                    });
                    [low, high].concat()
                };
                let bits = |path| run(path).iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                let baseline = bits(FpPath::BASELINE);
                assert!(FpPath::all().all(|path| bits(path) == baseline));
                assert!(run(FpPath::BASELINE).iter().all(|v| v.is_finite()));
            }
        }
    }
}
