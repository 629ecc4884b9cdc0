//! Dense kernels on columns: blocks of eight columns, in registers.

use crate::math::fused::Arithmetic;

use super::plan::WIDTH;

/// Columns of a panel whose products are summed in one go: 128 columns of 1,000 rows stay in the second-level cache.
const DEPTH: usize = 128;

/// `R` rows of a block of columns.
type Tile<const R: usize> = [[f64; R]; WIDTH];

/// Sum over the columns of `depth` of a_i b_j, for rows from `i` and columns from `j`.
#[inline(always)]
fn products<A: Arithmetic, const R: usize>(depth: &[f64], column: usize, i: usize, j: usize) -> Tile<R> {
    let mut sum = [[0.0; R]; WIDTH];
    if i + R > column || j + WIDTH > column {
        return sum;
    }
    for values in depth.chunks_exact(column) {
        let (Some(a), Some(b)) = (values[i..].first_chunk::<R>(), values[j..].first_chunk::<WIDTH>()) else { break };
        for c in 0..WIDTH {
            for r in 0..R {
                sum[c][r] = A::mul_add(a[r], b[c], sum[c][r]);
            }
        }
    }
    sum
}

/// Rows from `i` of the first eight columns, less `sum`.
#[inline(always)]
fn less<const R: usize>(columns: &[f64], column: usize, i: usize, sum: &Tile<R>) -> Tile<R> {
    let mut tile = *sum;
    for (tile, values) in tile.iter_mut().zip(columns.chunks_exact(column)) {
        if let Some(values) = values[i..].first_chunk::<R>() {
            for r in 0..R {
                tile[r] = values[r] - tile[r];
            }
        }
    }
    tile
}

#[inline(always)]
fn store<const R: usize>(columns: &mut [f64], column: usize, i: usize, tile: &Tile<R>) {
    for (tile, values) in tile.iter().zip(columns.chunks_exact_mut(column)) {
        if let Some(values) = values[i..].first_chunk_mut::<R>() {
            *values = *tile;
        }
    }
}

/// L of a block on the diagonal, in its lower triangle, and 1 / l_jj. False if it is not positive definite.
#[inline(always)]
fn cholesky<A: Arithmetic>(block: &mut Tile<WIDTH>, inverse: &mut [f64; WIDTH]) -> bool {
    for j in 0..WIDTH {
        let pivot = block[j][j];
        // false for what is not a number, too
        if !(pivot > 0.0 && pivot < f64::INFINITY) {
            return false;
        }
        inverse[j] = 1.0 / pivot.sqrt();
        for r in 0..WIDTH {
            block[j][r] *= inverse[j];
        }
        for c in j + 1..WIDTH {
            let factor = -block[j][c];
            for r in 0..WIDTH {
                block[c][r] = A::mul_add(block[j][r], factor, block[c][r]);
            }
        }
    }
    true
}

/// Solves X L^T = tile in place.
#[inline(always)]
fn divide<A: Arithmetic, const R: usize>(tile: &mut Tile<R>, l: &Tile<WIDTH>, inverse: &[f64; WIDTH]) {
    for j in 0..WIDTH {
        for t in 0..j {
            for r in 0..R {
                tile[j][r] = A::mul_add(tile[t][r], -l[t][j], tile[j][r]);
            }
        }
        for r in 0..R {
            tile[j][r] *= inverse[j];
        }
    }
}

/// Eight columns less the products of the columns of `depth`, from row `i`.
#[inline(always)]
fn take<A: Arithmetic, const R: usize>(
    depth: &[f64],
    [length, shift]: [usize; 2],
    columns: &mut [f64],
    column: usize,
    [start, j]: [usize; 2],
) {
    for i in (start..column).step_by(R) {
        let tile = less(columns, column, i, &products::<A, R>(depth, length, shift + i, shift + j));
        store(columns, column, i, &tile);
    }
}

/// Factors the first `own` columns of a panel of columns `column` long: L in the place of A, the rows below and the
/// right side with it. False if it is not positive definite.
#[inline(always)]
pub(super) fn factor<A: Arithmetic, const R: usize>(panel: &mut [f64], column: usize) -> bool {
    let own = panel.len() / column;
    for start in (0..own).step_by(DEPTH) {
        let end = own.min(start + DEPTH);
        for j in (start..end).step_by(WIDTH) {
            let (before, rest) = panel.split_at_mut(j * column);
            if !eliminate::<A, R>(&before[start * column..], rest, column, j) {
                return false;
            }
        }
        let (before, rest) = panel.split_at_mut(end * column);
        let depth = &before[start * column..];
        for (k, columns) in rest.chunks_exact_mut(WIDTH * column).enumerate() {
            let j = end + k * WIDTH;
            take::<A, R>(depth, [column, 0], columns, column, [j, j]);
        }
    }
    true
}

/// Eight columns from `j`: less the products of the columns `before`, then their own elimination.
#[inline(always)]
fn eliminate<A: Arithmetic, const R: usize>(before: &[f64], columns: &mut [f64], column: usize, j: usize) -> bool {
    let mut inverse = [0.0; WIDTH];
    let mut block = less(columns, column, j, &products::<A, WIDTH>(before, column, j, j));
    if !cholesky::<A>(&mut block, &mut inverse) {
        return false;
    }
    store(columns, column, j, &block);
    for i in (j + WIDTH..column).step_by(R) {
        let mut tile = less(columns, column, i, &products::<A, R>(before, column, i, j));
        divide::<A, R>(&mut tile, &block, &inverse);
        store(columns, column, i, &tile);
    }
    true
}

/// update -= L L^T in the lower triangle by blocks, with the rows of the panel from `first` and its first `own` columns.
#[inline(always)]
pub(super) fn subtract<A: Arithmetic, const R: usize>(
    panel: &[f64],
    [panel_column, first, own]: [usize; 3],
    update: &mut [f64],
    column: usize,
) {
    for depth in panel[..own * panel_column].chunks(DEPTH * panel_column) {
        for (k, columns) in update.chunks_exact_mut(WIDTH * column).enumerate() {
            let j = k * WIDTH;
            take::<A, R>(depth, [panel_column, first], columns, column, [j, j]);
        }
    }
}

/// Sum of products of each of eight columns with `x`, from row `from`.
#[inline(always)]
fn sums<A: Arithmetic>(columns: &[f64], column: usize, x: &[f64], from: usize) -> [f64; WIDTH] {
    let mut lanes = [[0.0; WIDTH]; WIDTH];
    for i in (from..x.len()).step_by(WIDTH) {
        let Some(x) = x[i..].first_chunk::<WIDTH>() else { break };
        for (lanes, values) in lanes.iter_mut().zip(columns.chunks_exact(column)) {
            let Some(values) = values[i..].first_chunk::<WIDTH>() else { break };
            for r in 0..WIDTH {
                lanes[r] = A::mul_add(values[r], x[r], lanes[r]);
            }
        }
    }
    lanes.map(|l| ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7])))
}

/// Solves L^T x = y, with y in the first rows of `x` and what is known in those behind.
#[inline(always)]
pub(super) fn backward<A: Arithmetic>(panel: &[f64], column: usize, x: &mut [f64]) {
    for (k, columns) in panel.chunks_exact(WIDTH * column).enumerate().rev() {
        let first = k * WIDTH;
        let known = sums::<A>(columns, column, x, first + WIDTH);
        for j in (0..WIDTH).rev() {
            let l = &columns[j * column + first..][..WIDTH];
            let mut value = x[first + j] - known[j];
            for i in j + 1..WIDTH {
                value -= l[i] * x[first + i];
            }
            x[first + j] = value / l[j];
        }
    }
}

/// Solves L y = x in the first rows of `x`, and takes its part from those behind.
#[inline(always)]
pub(super) fn forward<A: Arithmetic>(panel: &[f64], column: usize, x: &mut [f64]) {
    for (j, l) in panel.chunks_exact(column).enumerate() {
        let y = x[j] / l[j];
        x[j] = y;
        for (x, l) in x[j + 1..].iter_mut().zip(&l[j + 1..]) {
            *x = A::mul_add(*l, -y, *x);
        }
    }
}
