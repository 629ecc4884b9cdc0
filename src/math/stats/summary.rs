//! Quantiles and the summary of a small sample.

/// Quantile `q` in [0, 1] of a sorted sample, with linear interpolation; `None` if empty.
pub fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let position = q.clamp(0.0, 1.0) * last as f64;
    let low = position.floor() as usize;
    let (a, b) = (*sorted.get(low)?, *sorted.get((low + 1).min(last))?);
    Some(a + (b - a) * (position - low as f64))
}

/// Median, mean, spread of a sample.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Summary {
    pub n: usize,
    pub mean: f64,
    /// Standard deviation with n - 1; 0 for n = 1.
    pub sd: f64,
    /// Standard error of the mean, sd / sqrt(n).
    pub standard_error: f64,
    pub min: f64,
    pub lower_quartile: f64,
    pub median: f64,
    pub upper_quartile: f64,
    pub max: f64,
}

impl Summary {
    /// Of a sample in any order; what is not finite is left out. `None` if nothing is left.
    pub fn of(sample: &[f64]) -> Option<Self> {
        let mut s: Vec<f64> = sample.iter().copied().filter(|v| v.is_finite()).collect();
        s.sort_by(f64::total_cmp);
        let n = s.len();
        let mean = s.iter().sum::<f64>() / n as f64;
        let squares = s.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        let sd = if n > 1 { (squares / (n - 1) as f64).sqrt() } else { 0.0 };
        Some(Summary {
            n,
            mean,
            sd,
            standard_error: sd / (n as f64).sqrt(),
            min: *s.first()?,
            lower_quartile: quantile(&s, 0.25)?,
            median: quantile(&s, 0.5)?,
            upper_quartile: quantile(&s, 0.75)?,
            max: *s.last()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summary_of_known_sample() {
        let s = Summary::of(&[3.0, 1.0, 2.0, 4.0, f64::NAN]).unwrap();
        assert_eq!((s.n, s.mean, s.median, s.min, s.max), (4, 2.5, 2.5, 1.0, 4.0));
        assert!((s.sd - (5.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!(Summary::of(&[f64::NAN]).is_none());
    }
}
