//! Shares k / n, and how two of them differ.

use serde::Serialize;

use super::{gauss, standard_errors};

/// A share with its Wilson interval (E. Wilson, J. Am. Stat. Assoc. 22, 1927), which stays within 0..1
/// and is of use for k = 0 too.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    pub count: usize,
    pub n: usize,
    pub share: f64,
    pub low: f64,
    pub high: f64,
    pub confidence: f64,
}

impl Share {
    /// Of `count` in `n`; `None` if `n` is 0 or less than `count`, or the confidence is not in (0, 1).
    pub fn wilson(count: usize, n: usize, confidence: f64) -> Option<Self> {
        let z = standard_errors(confidence).filter(|_| n > 0 && count <= n)?;
        let (middle, half) = wilson(count, n, z);
        Some(Share {
            count,
            n,
            share: count as f64 / n as f64,
            // Exact at the ends, where rounding would leave 1e-17.
            low: if count == 0 { 0.0 } else { (middle - half).max(0.0) },
            high: if count == n { 1.0 } else { (middle + half).min(1.0) },
            confidence,
        })
    }

    /// Of the values of a sample that satisfy a test.
    pub fn of(sample: &[f64], test: impl Fn(f64) -> bool) -> Option<Self> {
        let count = sample.iter().filter(|v| test(**v)).count();
        Share::wilson(count, sample.len(), super::CONFIDENCE)
    }

    /// How much larger this share is than another one of an independent sample.
    pub fn minus(&self, other: &Share) -> ShareDifference {
        let (d, z) = (self.share - other.share, z_of_pooled(self, other));
        let root = |a: f64, b: f64| a.hypot(b);
        ShareDifference {
            difference: d,
            low: d - root(self.share - self.low, other.high - other.share),
            high: d + root(self.high - self.share, other.share - other.low),
            p_value: (2.0 * gauss::cdf(-z.abs())).min(1.0),
        }
    }
}

/// Middle and half-width of the Wilson interval of z standard errors.
pub(super) fn wilson(count: usize, n: usize, z: f64) -> (f64, f64) {
    let (p, n) = (count as f64 / n as f64, n as f64);
    let grown = 1.0 + z * z / n;
    ((p + 0.5 * z * z / n) / grown, z / grown * (p * (1.0 - p) / n + 0.25 * z * z / (n * n)).sqrt())
}

/// Difference of two shares.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ShareDifference {
    pub difference: f64,
    /// Interval from both Wilson intervals (R. Newcombe, Stat. Med. 17, 1998, method 10).
    pub low: f64,
    pub high: f64,
    /// Two-sided, that both shares are the same; normal approximation with the pooled share.
    pub p_value: f64,
}

/// The difference in standard errors of equal shares; 0 where both are 0 or both 1.
fn z_of_pooled(a: &Share, b: &Share) -> f64 {
    let (m, n) = (a.n as f64, b.n as f64);
    let pooled = (a.count + b.count) as f64 / (m + n);
    let error = (pooled * (1.0 - pooled) * (1.0 / m + 1.0 / n)).sqrt();
    if error > 0.0 { (a.share - b.share) / error } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share(count: usize, n: usize) -> Share {
        Share::wilson(count, n, 0.95).unwrap()
    }

    #[test]
    fn wilson_intervals_are_the_published_ones() {
        // 5/10: 0.2366, 0.7634. R. Newcombe, Stat. Med. 17, 1998, p. 861: 81/263 and 0/20.
        for (k, n, low, high) in
            [(5, 10, 0.2366, 0.7634), (81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611)]
        {
            let s = share(k, n);
            assert!((s.low - low).abs() < 5e-5 && (s.high - high).abs() < 5e-5, "{s:?}");
        }
        assert_eq!((share(0, 7).low, share(7, 7).high), (0.0, 1.0));
        assert!(Share::wilson(1, 0, 0.95).is_none() && Share::wilson(3, 2, 0.95).is_none());
        assert!(Share::wilson(1, 2, f64::NAN).is_none());
    }

    #[test]
    fn difference_of_two_shares() {
        // Newcombe 1998, p. 873, method 10: 56/70 - 48/80 has 0.0524, 0.3339.
        let d = share(56, 70).minus(&share(48, 80));
        assert!((d.difference - 0.2).abs() < 1e-15);
        assert!((d.low - 0.0524).abs() < 5e-5 && (d.high - 0.3339).abs() < 5e-5, "{d:?}");
        assert!((d.p_value - 0.0080).abs() < 5e-4, "{}", d.p_value);
        assert_eq!(share(0, 5).minus(&share(0, 9)).p_value, 1.0);
    }
}
