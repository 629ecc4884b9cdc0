//! Density histograms of samples that come in steps and end at limits.

use serde::Serialize;

use super::{Censoring, quantile};

/// Most bins between the lowest and the highest value.
const MOST: f64 = 100.0;

/// Where bins begin: at `origin` plus whole multiples of `width`, the outer ones cut at the limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Binning {
    /// Unit of the sample.
    pub origin: f64,
    pub width: f64,
    /// Values at a limit stand in a bin of their own, beyond it.
    pub censoring: Censoring,
}

/// A bar of a histogram.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    pub from: f64,
    pub to: f64,
    pub count: usize,
    /// count / (n (to - from)), in 1 / unit of the sample.
    pub density: f64,
}

/// A histogram; the counts of all bins add up to `n` and their areas to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Histogram {
    pub n: usize,
    /// Bins of values that are known, without gaps.
    pub bins: Vec<Bin>,
    /// Values at the low limit, drawn beyond it; `None` if there are none.
    pub below: Option<Bin>,
    /// The same at the high limit.
    pub above: Option<Bin>,
}

impl Binning {
    /// Bins for these samples together: the mean of their widths by Freedman and Diaconis
    /// (2 IQR / n^(1/3), Z. Wahrsch. 57, 1981), as a whole multiple of `resolution`, the step in which
    /// values come (0 if they are continuous): a bin of two and one of three columns would differ by
    /// half with no reason. Between two limits lies a whole number of bins where a width within a factor
    /// of 1.5 allows it. At most about 100 bins.
    pub fn of(samples: &[&[f64]], censoring: Censoring, resolution: f64) -> Self {
        let known = |s: &[f64]| -> Vec<f64> {
            let mut v: Vec<f64> = s.iter().copied().filter(|v| v.is_finite() && censoring.is_inside(*v)).collect();
            v.sort_by(f64::total_cmp);
            v
        };
        let samples: Vec<Vec<f64>> = samples.iter().map(|s| known(s)).filter(|s| !s.is_empty()).collect();
        let low = samples.iter().filter_map(|s| s.first()).copied().fold(f64::INFINITY, f64::min);
        let high = samples.iter().filter_map(|s| s.last()).copied().fold(f64::NEG_INFINITY, f64::max);
        let wide = samples.iter().map(|s| freedman_diaconis(s)).sum::<f64>() / samples.len().max(1) as f64;
        let width = fitted(rounded(wide.max((high - low) / MOST), resolution, low), resolution, &censoring);
        // From the low limit; else half a step before a multiple, so that no value lies on an edge.
        let origin = censoring.low.unwrap_or(if resolution > 0.0 { -0.5 * resolution } else { 0.0 });
        Binning { origin, width, censoring }
    }

    /// Number of the bin of a value; on an edge, to rounding, the upper one, but none beyond the high limit.
    /// `None` where the bins are too narrow to be told apart.
    fn index(&self, value: f64) -> Option<i64> {
        let place = |v: f64| (v - self.origin) / self.width;
        let last = self.censoring.high.map_or(f64::INFINITY, |high| (place(high) - 1e-9).ceil() - 1.0);
        let index = (place(value) + 1e-9).floor().min(last);
        (self.width > 0.0 && index.abs() < 1e12).then_some(index as i64)
    }

    fn edge(&self, index: i64) -> f64 {
        let edge = self.origin + index as f64 * self.width;
        self.censoring.high.map_or(edge, |high| edge.min(high))
    }
}

/// 2 IQR / n^(1/3) of a sample in order; 0 if it is empty.
fn freedman_diaconis(sorted: &[f64]) -> f64 {
    let at = |q| quantile(sorted, q).unwrap_or(0.0);
    2.0 * (at(0.75) - at(0.25)) / (sorted.len().max(1) as f64).cbrt()
}

/// A whole multiple of `resolution` where there is one. A sample without width has bins of a resolution, or of a
/// tenth of its value.
fn rounded(width: f64, resolution: f64, value: f64) -> f64 {
    let usable = |v: f64| v.is_finite() && v > 0.0;
    if usable(resolution) {
        return if usable(width) { (width / resolution).round().max(1.0) * resolution } else { resolution };
    }
    let fallback = 0.1 * value.abs();
    if usable(width) {
        width
    } else if usable(fallback) {
        fallback
    } else {
        1.0
    }
}

/// The nearest width of which a whole number lies between two limits.
fn fitted(width: f64, resolution: f64, censoring: &Censoring) -> f64 {
    let (Some(low), Some(high)) = (censoring.low, censoring.high) else {
        return width;
    };
    let most = ((high - low) / width * 1.5).floor().clamp(1.0, 1.5 * MOST) as u32;
    let stepped = resolution > 0.0;
    let is_whole = |w: &f64| !stepped || ((w / resolution).round() * resolution - w).abs() < 1e-9 * w;
    let distance = |w: &f64| (w / width).ln().abs();
    let widths = (1..=most).map(|k| (high - low) / f64::from(k)).filter(is_whole);
    let nearest = widths.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.filter(|w| distance(w) <= 1.5_f64.ln() + 1e-9).unwrap_or(width)
}

impl Histogram {
    /// Of a sample; what is not finite is left out. `None` if nothing is left, or if the bins would be more than
    /// 10 000 or more than 1e12 bins from their origin (bins chosen for other samples).
    pub fn of(sample: &[f64], binning: &Binning) -> Option<Self> {
        let finite: Vec<f64> = sample.iter().copied().filter(|v| v.is_finite()).collect();
        let (n, c) = (finite.len(), &binning.censoring);
        let inside = finite.iter().filter(|v| c.is_inside(**v));
        let index = inside.map(|v| binning.index(*v)).collect::<Option<Vec<i64>>>()?;
        let first = index.iter().min().copied().unwrap_or(0);
        let count = index.iter().max().map_or(0, |last| (last - first + 1) as usize);
        if count > 10_000 {
            return None;
        }
        let mut counts = vec![0; count];
        index.iter().for_each(|k| counts[(k - first) as usize] += 1);
        let bin = |from: f64, to: f64, count: usize| {
            let density = count as f64 / (n as f64 * (to - from));
            Bin { from, to, count, density }
        };
        let inner = (first..).zip(counts).map(|(k, count)| bin(binning.edge(k), binning.edge(k + 1), count));
        let at = |limit: Option<f64>, count: usize, side: f64| {
            let beyond = |limit: f64| (limit.min(limit + side), limit.max(limit + side));
            limit.filter(|_| count > 0).map(beyond).map(|(from, to)| bin(from, to, count))
        };
        let below = finite.iter().filter(|v| c.is_below(**v)).count();
        let above = finite.iter().filter(|v| c.is_above(**v)).count();
        (n > 0).then(|| Histogram {
            n,
            bins: inner.collect(),
            below: at(c.low, below, -binning.width),
            above: at(c.high, above, binning.width),
        })
    }

    /// All bars from the left.
    pub fn all(&self) -> impl Iterator<Item = &Bin> {
        self.below.iter().chain(&self.bins).chain(&self.above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::random::Draws;

    const BOTH: Censoring = Censoring { low: Some(0.0), high: Some(18.0) };

    fn totals(h: &Histogram) -> (usize, f64) {
        (h.all().map(|b| b.count).sum(), h.all().map(|b| b.density * (b.to - b.from)).sum())
    }

    #[test]
    fn counts_add_up_whatever_the_limits_and_steps() {
        let sample: Vec<f64> =
            Draws::new(2, 0).sample(100, 10.0, 6.0).iter().map(|v| (v.clamp(0.0, 18.0) * 8.0).round() / 8.0).collect();
        for censoring in [Censoring::default(), BOTH, Censoring { low: Some(0.0), high: None }] {
            for resolution in [0.0, 0.125, 0.1, 0.7] {
                let h = Histogram::of(&sample, &Binning::of(&[&sample], censoring, resolution)).unwrap();
                let (count, area) = totals(&h);
                assert!(count == 100 && (area - 1.0).abs() < 1e-12, "{censoring:?} {resolution}");
                assert!(h.bins.windows(2).all(|w| w[0].to == w[1].from));
            }
        }
    }

    #[test]
    fn values_at_a_limit_have_a_bar_of_their_own() {
        let sample = [0.0, 0.0, 0.1, 5.0, 17.9, 18.0, 20.0, 20.0];
        let binning = Binning { origin: 0.0, width: 5.0, censoring: BOTH };
        let h = Histogram::of(&sample, &binning).unwrap();
        assert_eq!((h.below.unwrap().count, h.above.unwrap().count), (2, 3));
        assert_eq!(h.bins.iter().map(|b| b.count).collect::<Vec<_>>(), [1, 1, 0, 1]);
        // The last bin is cut at the limit, and its density is that of its own width.
        let last = h.bins.last().unwrap();
        assert_eq!((last.from, last.to, last.density), (15.0, 18.0, 1.0 / 24.0));
    }

    #[test]
    fn the_width_is_that_of_the_rule() {
        let sample: Vec<f64> = (0..1000).map(|k| f64::from(k) * 0.01).collect();
        let wide = Binning::of(&[&sample], Censoring::default(), 0.0).width;
        // IQR 4.995, n^(1/3) = 10
        assert!((wide - 0.999).abs() < 1e-12);
        assert_eq!(Binning::of(&[&sample], Censoring::default(), 0.3).width, 3.0 * 0.3);
        assert_eq!(Binning::of(&[&sample], Censoring::default(), 4.0).width, 4.0);
    }

    #[test]
    fn a_whole_number_of_bins_lies_between_two_limits() {
        assert_eq!(fitted(2.875, 0.125, &BOTH), 3.0);
        assert!((fitted(2.8, 0.0, &BOTH) - 18.0 / 6.0).abs() < 1e-12);
        // 18 is no multiple of 0.7: the last bin is cut.
        assert_eq!(fitted(2.8, 0.7, &BOTH), 2.8);
    }

    #[test]
    fn odd_samples() {
        let of = |s: &[f64], r: f64| Histogram::of(s, &Binning::of(&[s], BOTH, r));
        assert!(of(&[], 0.1).is_none() && of(&[f64::NAN], 0.1).is_none());
        assert_eq!(totals(&of(&[0.0, 0.0], 0.1).unwrap()).0, 2);
        assert_eq!(of(&[5.0; 7], 0.0).unwrap().bins.len(), 1);
        let far = Binning { origin: 0.0, width: 1e-9, censoring: Censoring::default() };
        assert!(Histogram::of(&[-1e300, 1e300], &far).is_none());
        for value in [1e300, -1e300] {
            assert!(
                Histogram::of(&[value], &far).is_none()
                    && Histogram::of(&[value], &Binning { width: 0.0, ..far }).is_none()
            );
        }
        // A whisker below the limit is in the last bin, not in one without width.
        let edge = Histogram::of(&[1.0, 18.0 - 1e-12], &Binning { origin: 0.0, width: 3.0, censoring: BOTH }).unwrap();
        assert!(totals(&edge).0 == 2 && (totals(&edge).1 - 1.0).abs() < 1e-12);
        let wild = [1.0, 1.0, 1.0, 1.0, 1.001, 1e6];
        assert!(Histogram::of(&wild, &Binning::of(&[&wild], Censoring::default(), 0.0)).unwrap().bins.len() <= 102);
    }
}
