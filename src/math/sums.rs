//! Sums over columns in a fixed order that processors do several of at once.

/// Sums side by side, each of every sixteenth entry.
const SIDE: usize = 16;

/// Sums of the `terms` of the first `n` entries of columns, each at least that long; terms of nothing but
/// zeros must be 0.
#[inline(always)]
pub fn sums<const C: usize, const K: usize>(
    columns: [&[f64]; C],
    n: usize,
    terms: impl Fn([f64; C]) -> [f64; K],
) -> [f64; K] {
    let mut sums = [[0.0; SIDE]; K];
    let chunks = columns.map(|column| column[..n].as_chunks::<SIDE>());
    for k in 0..n / SIDE {
        add(&mut sums, chunks.map(|(whole, _)| &whole[k]), &terms);
    }
    let last = chunks.map(|(_, rest)| {
        let mut last = [0.0; SIDE];
        last[..rest.len()].copy_from_slice(rest);
        last
    });
    add(&mut sums, last.each_ref(), &terms);
    sums.map(|s| s.iter().sum())
}

#[inline(always)]
fn add<const C: usize, const K: usize>(
    sums: &mut [[f64; SIDE]; K],
    entries: [&[f64; SIDE]; C],
    terms: &impl Fn([f64; C]) -> [f64; K],
) {
    for i in 0..SIDE {
        let terms = terms(std::array::from_fn(|c| entries[c][i]));
        for k in 0..K {
            sums[k][i] += terms[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::sums;

    #[test]
    fn sums_take_all_entries_once() {
        let column: Vec<f64> = (0..40).map(f64::from).collect();
        for n in 0..40 {
            assert_eq!(sums([&column], n, |[v]| [v]), [(n * n.saturating_sub(1) / 2) as f64]);
        }
    }
}
