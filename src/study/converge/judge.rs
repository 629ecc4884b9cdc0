//! What the values of a ladder tell: whether they approach a limit, at which rate, and how well that is known.

use serde::Serialize;

use crate::math::stats::{
    Bootstrap, Resampled, Summary,
    richardson::{self, RATES},
};

/// A rate whose interval is wider tells nothing: first order is not told from third.
pub const WIDEST: f64 = 2.0;
/// Runs of a level below which their scatter is not known well enough for a rate: resamples of three have ten medians.
pub const FEWEST: usize = 5;
/// Differences below this share of the largest value are rounding, not a dependence on the size.
const ROUNDING: f64 = 1e-12;

/// The values of a ladder, coarsest first.
pub struct Samples {
    /// What is refined, falling.
    pub sizes: Vec<f64>,
    /// The values of the runs of each level, none empty.
    pub values: Vec<Vec<f64>>,
    /// Values of one place belong to one realisation: levels have means, and differences are those of pairs. Else
    /// runs are draws of chance, and levels have medians.
    pub paired: bool,
}

/// v of the next finer level less that of a level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    pub value: f64,
    /// 95 % interval over the runs; none where they do not scatter.
    pub interval: Option<[f64; 2]>,
}

/// p of v + c h^p.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rate {
    pub value: f64,
    /// 95 % interval of the bootstrap over the runs; without scatter the rates of each three levels in a row, from
    /// the least to the largest, and none for three levels.
    pub interval: Option<[f64; 2]>,
    /// Share of the resamples whose differences have one sign.
    pub defined: f64,
}

/// What a ladder tells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verdict {
    /// Fewer than two levels have a value.
    NoValues,
    /// All levels give the same, to rounding.
    Same,
    /// The last difference is not told from the scatter of the runs: it is at most `bound`.
    Unresolved {
        last: f64,
        bound: f64,
    },
    /// One difference has no rate.
    TwoLevels,
    SignChange,
    /// Differences do not fall as a positive power would make them.
    NoDecay {
        rate: Option<f64>,
    },
    /// The runs of a level scatter, and are fewer than `FEWEST`.
    FewRuns {
        runs: usize,
    },
    /// The rate is none of [`RATES`].
    OddRate {
        rate: Rate,
    },
    /// The interval of the rate is wider than `WIDEST`, or too many resamples have none.
    Uncertain {
        rate: Rate,
    },
    /// The limit is known to `uncertainty`: half of its interval by the bootstrap; without scatter how far the limits
    /// of each three levels lie from it, or for three levels, how far it lies from the finest.
    Clean {
        rate: Rate,
        limit: f64,
        uncertainty: f64,
    },
}

/// Value of each level, differences and verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    pub values: Vec<f64>,
    pub differences: Vec<Difference>,
    pub verdict: Verdict,
}

/// Judges a ladder.
pub fn judge(samples: &Samples) -> Judgement {
    let values = samples.centres(&samples.values);
    let resampled = samples.resampled();
    let difference = |(k, w): (usize, &[f64])| {
        let spread = resampled.as_ref().and_then(|r| r.get(k)).and_then(|r| r.spread);
        Difference { value: w[1] - w[0], interval: spread.map(|s| [s.low, s.high]) }
    };
    let differences: Vec<Difference> = values.windows(2).enumerate().map(difference).collect();
    let verdict = verdict(samples, &values, &differences, resampled.as_deref());
    Judgement { values, differences, verdict }
}

impl Samples {
    fn centres(&self, values: &[Vec<f64>]) -> Vec<f64> {
        let centre = |s: Summary| if self.paired { s.mean } else { s.median };
        values.iter().map(|level| Summary::of(level).map_or(f64::NAN, centre)).collect()
    }

    /// Differences, then rate, then limit over resamples; `None` where no level scatters.
    fn resampled(&self) -> Option<Vec<Resampled>> {
        let scatters = self.values.iter().any(|level| level.iter().any(|v| Some(v) != level.first()));
        let statistics = |draw: &[Vec<f64>]| {
            let v = self.centres(draw);
            let rate = richardson::order(&self.sizes, &v);
            let limit = rate.and_then(|p| richardson::limit(&self.sizes, &v, p));
            let differences = v.windows(2).map(|w| w[1] - w[0]);
            differences.chain([rate.unwrap_or(f64::NAN), limit.unwrap_or(f64::NAN)]).collect()
        };
        scatters.then(|| Bootstrap::default().joint(&self.values, self.paired, statistics))
    }
}

fn verdict(samples: &Samples, values: &[f64], differences: &[Difference], resampled: Option<&[Resampled]>) -> Verdict {
    let Some(last) = differences.last() else { return Verdict::NoValues };
    let largest = values.iter().map(|v| v.abs()).fold(0.0, f64::max);
    if differences.iter().all(|d| d.value.abs() <= ROUNDING * largest) {
        return Verdict::Same;
    }
    if let Some([low, high]) = last.interval.filter(|[low, high]| *low <= 0.0 && *high >= 0.0) {
        return Verdict::Unresolved { last: last.value, bound: high.max(-low) };
    }
    if differences.len() < 2 {
        return Verdict::TwoLevels;
    }
    let one_sign = differences.iter().all(|d| d.value * last.value > 0.0);
    if !one_sign {
        return Verdict::SignChange;
    }
    let fewest = samples.values.iter().map(Vec::len).min().unwrap_or(0);
    if resampled.is_some() && fewest < FEWEST {
        return Verdict::FewRuns { runs: fewest };
    }
    rated(samples, values, resampled)
}

/// Of three levels or more whose differences have one sign.
fn rated(samples: &Samples, values: &[f64], resampled: Option<&[Resampled]>) -> Verdict {
    let h = &samples.sizes;
    let threes: Vec<[f64; 2]> = h.windows(3).zip(values.windows(3)).filter_map(three).collect();
    let fitted = richardson::order(h, values);
    let Some(p) = fitted.filter(|_| threes.len() + 2 == h.len() && threes.iter().all(|[p, _]| *p > 0.0)) else {
        return Verdict::NoDecay { rate: fitted };
    };
    let of = |k: usize| resampled.and_then(|r| r.get(h.len() - 1 + k));
    let rate = rate(p, &threes, of(0));
    if !(RATES[0]..=RATES[1]).contains(&p) {
        return Verdict::OddRate { rate };
    }
    let wide = rate.interval.is_some_and(|[low, high]| high - low > WIDEST);
    let Some(limit) = richardson::limit(h, values, p).filter(|_| !wide && rate.defined >= 0.95) else {
        return Verdict::Uncertain { rate };
    };
    Verdict::Clean { rate, limit, uncertainty: uncertainty(limit, values, &threes, of(1)) }
}

/// Rate and limit of three levels.
fn three((h, v): (&[f64], &[f64])) -> Option<[f64; 2]> {
    let p = richardson::order(h, v)?;
    Some([p, richardson::limit(h, v, p).unwrap_or(f64::NAN)])
}

fn rate(value: f64, threes: &[[f64; 2]], resampled: Option<&Resampled>) -> Rate {
    if let Some(r) = resampled {
        return Rate { value, interval: r.spread.map(|s| [s.low, s.high]), defined: r.defined };
    }
    let ends = |[low, high]: [f64; 2], p: f64| [low.min(p), high.max(p)];
    let all = threes.iter().fold([value; 2], |range, [p, _]| ends(range, *p));
    Rate { value, interval: (threes.len() > 1).then_some(all), defined: 1.0 }
}

fn uncertainty(limit: f64, values: &[f64], threes: &[[f64; 2]], resampled: Option<&Resampled>) -> f64 {
    if let Some(spread) = resampled.and_then(|r| r.spread) {
        return 0.5 * (spread.high - spread.low);
    }
    let to = |v: f64| (v - limit).abs();
    if threes.len() > 1 {
        return threes.iter().map(|[_, limit]| to(*limit)).fold(0.0, f64::max);
    }
    values.last().map_or(f64::NAN, |v| to(*v))
}
