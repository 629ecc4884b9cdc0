//! Two clusters on a line.

/// The value that splits numbers into two clusters with the least sum of squares about their means (2-means in
/// one dimension, exactly: the clusters are neighbours on the line, so all cuts of the sorted numbers are looked
/// at). It lies halfway between the neighbours that it parts; above it is the second cluster. `None` where
/// there are no two clusters: fewer than two numbers, all the same, or one that is not finite. O(n log n).
pub fn split(values: &[f64]) -> Option<f64> {
    if values.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let total: f64 = sorted.iter().sum();
    let (mut below, mut best) = (0.0, (0.0, None));
    for (k, pair) in sorted.windows(2).enumerate() {
        below += pair[0];
        // the sum of squares falls by n1 n2 / n (m2 - m1)^2 when one cluster becomes two
        let (n1, n2) = ((k + 1) as f64, (sorted.len() - k - 1) as f64);
        let gap = (total - below) / n2 - below / n1;
        let gain = n1 * n2 * gap * gap;
        if pair[1] > pair[0] && gain > best.0 {
            best = (gain, Some(pair[0] + 0.5 * (pair[1] - pair[0])));
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sum of squares about the means of the two sides of a cut.
    fn spread(values: &[f64], cut: f64) -> f64 {
        let side = |above: bool| {
            let part: Vec<f64> = values.iter().copied().filter(|v| (*v > cut) == above).collect();
            let mean = part.iter().sum::<f64>() / part.len().max(1) as f64;
            part.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>()
        };
        side(true) + side(false)
    }

    #[test]
    fn no_other_cut_is_better() {
        for seed in 1..40_u32 {
            let noise =
                |k: u32| f64::from((k.wrapping_mul(2_654_435_761).wrapping_add(seed * 977)) >> 8) / 16_777_216.0;
            let values: Vec<f64> =
                (0..30).map(|k| noise(k).powi(3) + if k % 4 == 0 { noise(k + 99) } else { 0.0 }).collect();
            let found = spread(&values, split(&values).expect("two clusters"));
            let best = values.iter().map(|v| spread(&values, *v)).fold(f64::INFINITY, f64::min);
            assert!(found <= best * (1.0 + 1e-12), "{found} {best}");
        }
    }

    #[test]
    fn a_slide_stands_out_of_what_only_leans() {
        let mut values: Vec<f64> = (0..900).map(|k| 0.05 * f64::from(k) / 900.0).collect();
        values.extend((0..60).map(|k| 0.45 + 0.001 * f64::from(k)));
        let cut = split(&values).expect("two clusters");
        assert!((cut - 0.5 * (0.05 * 899.0 / 900.0 + 0.45)).abs() < 1e-12, "{cut}");
    }

    #[test]
    fn what_moves_as_one_has_no_split() {
        assert_eq!(split(&[0.5; 7]), None);
        assert_eq!(split(&[]), None);
        assert_eq!(split(&[0.0, 1.0, f64::NAN]), None);
    }
}
