//! How a sequence of levels decays: rates with their errors, and what is left beyond the last level.

use serde::Serialize;

use super::{CONFIDENCE, standard_errors};

/// Exponent p of y = a h^p.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rate {
    pub rate: f64,
    pub standard_error: f64,
    /// 95 % interval.
    pub low: f64,
    pub high: f64,
}

/// Fits y = a h^p to the logarithms, each with the weight 1 / (error / y)^2 of its standard error; two points
/// give their ratio. `None` for fewer than two, or where an h or y is not positive.
pub fn rate(h: &[f64], y: &[f64], errors: &[f64]) -> Option<Rate> {
    let z = standard_errors(CONFIDENCE)?;
    let usable = h.len() >= 2 && h.len() == y.len() && y.len() == errors.len();
    if !usable || h.iter().chain(y).any(|v| !(*v > 0.0 && v.is_finite())) {
        return None;
    }
    // what is exact still takes a finite weight
    let weights: Vec<f64> = y.iter().zip(errors).map(|(y, e)| (e / y).max(1e-9).powi(-2)).collect();
    let mean = |v: &[f64]| weights.iter().zip(v).map(|(w, v)| w * v.ln()).sum::<f64>() / weights.iter().sum::<f64>();
    let (mh, my) = (mean(h), mean(y));
    let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
        weights.iter().zip(h.iter().zip(y)).map(|(w, (h, y))| w * of(h.ln() - mh, y.ln() - my)).sum()
    };
    let squares = sum(&|x, _| x * x);
    let (rate, standard_error) = (sum(&|x, y| x * y) / squares, squares.sqrt().recip());
    let half = z * standard_error;
    (rate.is_finite() && half.is_finite()).then_some(Rate { rate, standard_error, low: rate - half, high: rate + half })
}

/// What the means of differences between levels tell of the bias of the finest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Bias {
    /// `|E[Y_l - Y_(l-1)]|` falls as h^alpha: the limit lies `to_limit` above `E[Y_L]`.
    Decays { alpha: Rate, to_limit: f64, standard_error: f64 },
    /// The last difference is not told from 0: it is at most `bound`, and the bias is no larger where differences
    /// at least halve from level to level.
    Unresolved { bound: f64 },
    /// The last difference is not 0 and there is no decay: no limit is in sight, and no bias is defined.
    NoDecay { alpha: Option<Rate>, last: f64, standard_error: f64 },
    /// Two differences are needed, of three levels.
    TooFew,
}

impl Bias {
    /// From the means of differences and their standard errors, coarsest first, `h` being the size of the finer
    /// of both levels. With M = h_(L-1) / h_L: `to_limit = E[Y_L - Y_(L-1)] / (M^alpha - 1)`.
    pub fn of(h: &[f64], differences: &[(f64, f64)]) -> Bias {
        let (Some([.., before, last_h]), Some(&(last, se))) = (h.last_chunk::<2>(), differences.last()) else {
            return Bias::TooFew;
        };
        let z = standard_errors(CONFIDENCE).unwrap_or(f64::NAN);
        if last.abs() <= z * se {
            return Bias::Unresolved { bound: last.abs() + z * se };
        }
        let (sizes, errors): (Vec<f64>, Vec<f64>) = differences.iter().map(|(m, e)| (m.abs(), *e)).unzip();
        match rate(h, &sizes, &errors) {
            Some(alpha) if alpha.low > 0.0 => extrapolated(alpha, before / last_h, last, se),
            alpha => Bias::NoDecay { alpha, last, standard_error: se },
        }
    }
}

/// With the error of the difference and that of alpha, as if they were independent.
fn extrapolated(alpha: Rate, ratio: f64, last: f64, se: f64) -> Bias {
    let grown = ratio.powf(alpha.rate);
    let to_limit = last / (grown - 1.0);
    let by_alpha = grown * ratio.ln() / (grown - 1.0) * alpha.standard_error;
    Bias::Decays { alpha, to_limit, standard_error: to_limit.abs() * (se / last).hypot(by_alpha) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_found_with_its_error() {
        let h = [1.0, 0.5, 0.25];
        let y = h.map(|h: f64| 3.0 * h.powf(1.5));
        let r = rate(&h, &y, &[0.1 * y[0], 0.1 * y[1], 0.1 * y[2]]).unwrap();
        // ten per cent on each: 0.1 / sqrt(sum (x - mean)^2) = 0.1 / (sqrt 2 ln 2)
        assert!((r.rate - 1.5).abs() < 1e-12);
        assert!((r.standard_error - 0.1 / (2.0_f64.sqrt() * 2.0_f64.ln())).abs() < 1e-12);
        assert!(rate(&h, &[1.0, -1.0, 1.0], &[0.1; 3]).is_none() && rate(&h[..1], &[1.0], &[0.1]).is_none());
        assert!(rate(&[1.0, 1.0], &[1.0, 2.0], &[0.1; 2]).is_none());
    }

    #[test]
    fn four_verdicts() {
        let h = [0.5, 0.25];
        // 1 - h^2: differences 0.75, 0.1875 of the levels 1, 0.5, 0.25, and 0.0625 to the limit
        let Bias::Decays { to_limit, alpha, .. } = Bias::of(&h, &[(0.75, 0.01), (0.1875, 0.01)]) else {
            panic!("it decays")
        };
        assert!((to_limit - 0.0625).abs() < 1e-12 && (alpha.rate - 2.0).abs() < 1e-12);
        let Bias::Unresolved { bound } = Bias::of(&h, &[(1.0, 0.1), (0.1, 0.1)]) else { panic!("it is within 1.96") };
        assert!((bound - 0.295_996_4).abs() < 1e-7);
        assert!(matches!(Bias::of(&h, &[(1.0, 0.1), (-0.9, 0.1)]), Bias::NoDecay { alpha: Some(_), .. }));
        assert!(matches!(Bias::of(&h, &[(0.0, 0.1), (1.0, 0.1)]), Bias::NoDecay { alpha: None, .. }));
        assert_eq!(Bias::of(&h[..1], &[(1.0, 0.1)]), Bias::TooFew);
    }
}
