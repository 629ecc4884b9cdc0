//! Against geometric Brownian motion by Euler's method: dS = r S dt + s S dW, S(0) = 1, to t = 1. The mean on
//! n steps is exactly (1 + r / n)^n, the bias falls as h and the variance of differences as h.

use super::*;
use crate::math::stats::{Bias, rate};

const DRIFT: f64 = 0.8;
const VOLATILITY: f64 = 0.4;

/// S(1) on n and on n / 2 steps of the same path.
fn path(draws: &mut Draws, n: usize) -> (f64, f64) {
    let h = 1.0 / n as f64;
    let (mut fine, mut coarse) = (1.0, 1.0);
    for _ in 0..n / 2 {
        let w = draws.normals().map(|z| h.sqrt() * z);
        w.iter().for_each(|w| fine *= 1.0 + DRIFT * h + VOLATILITY * w);
        coarse *= 1.0 + 2.0 * DRIFT * h + VOLATILITY * (w[0] + w[1]);
    }
    (fine, coarse)
}

/// Terms of 2, 4, 8, ... steps with so many paths each.
fn motion(seed: u64, paths: &[usize]) -> Vec<Pairs> {
    let term = |(l, n): (usize, &usize)| {
        let mut draws = Draws::new(seed, l);
        let (fine, coarse): (Vec<f64>, Vec<f64>) = (0..*n).map(|_| path(&mut draws, 2 << l)).unzip();
        Pairs { fine, coarse: (l > 0).then_some(coarse) }
    };
    paths.iter().enumerate().map(term).collect()
}

fn terms(pairs: &[Pairs]) -> Vec<Term> {
    pairs.iter().map(|p| p.term().unwrap()).collect()
}

fn exact(levels: usize) -> f64 {
    let n = (2 << (levels - 1)) as f64;
    (1.0 + DRIFT / n).powf(n)
}

#[test]
fn the_sum_is_unbiased_and_its_interval_holds_the_mean() {
    let runs = 300;
    let found: Vec<(f64, f64)> = (0..runs).map(|k| telescope(&terms(&motion(k, &[400, 200, 100])))).collect();
    let mean = found.iter().map(|f| f.0).sum::<f64>() / runs as f64;
    let error = found.iter().map(|f| f.1 * f.1).sum::<f64>().sqrt() / runs as f64;
    assert!((mean - exact(3)).abs() < 3.0 * error, "{mean} {} {error}", exact(3));
    let inside = found.iter().filter(|(m, se)| (m - exact(3)).abs() < 1.96 * se).count() as f64 / runs as f64;
    // three standard errors of a share of 0.95 of 300
    assert!((inside - 0.95).abs() < 3.0 * (0.95 * 0.05 / runs as f64).sqrt(), "{inside}");
}

/// Mean and variance of the difference between n and n / 2 steps. Each coarse step multiplies
/// E[fine^2], E[fine coarse] and E[coarse^2] by a number.
fn exact_difference(n: i32) -> (f64, f64) {
    let (h, s2) = (1.0 / f64::from(n), VOLATILITY * VOLATILITY);
    let (a, b) = (1.0 + DRIFT * h, 1.0 + 2.0 * DRIFT * h);
    let [fine, both, coarse] =
        [(a * a + s2 * h).powi(n), (a * a * b + 2.0 * a * s2 * h).powi(n / 2), (b * b + 2.0 * s2 * h).powi(n / 2)];
    let mean = a.powi(n) - b.powi(n / 2);
    (mean, fine - 2.0 * both + coarse - mean * mean)
}

#[test]
fn rates_and_bias_are_those_of_eulers_method() {
    let t = terms(&motion(5, &[20_000; 6]));
    let t = &t[1..];
    let h: Vec<f64> = (0..5).map(|l| 1.0 / f64::from(4 << l)).collect();
    let exact: Vec<(f64, f64)> = (0..5).map(|l| exact_difference(4 << l)).collect();
    let (means, errors): (Vec<f64>, Vec<f64>) = t.iter().map(|t| (t.mean, t.mean_se)).unzip();
    let (variances, their): (Vec<f64>, Vec<f64>) = t.iter().map(|t| (t.variance, t.variance_se)).unzip();
    for (found, (mean, variance)) in t.iter().zip(&exact) {
        assert!(
            (found.mean - mean).abs() < 4.0 * found.mean_se
                && (found.variance - variance).abs() < 4.0 * found.variance_se
        );
    }
    // the slopes of the exact figures, fitted with the same weights
    for (y, e, y_exact) in [
        (&means, &errors, exact.iter().map(|x| x.0).collect::<Vec<_>>()),
        (&variances, &their, exact.iter().map(|x| x.1).collect()),
    ] {
        let (found, known) = (rate(&h, y, e).unwrap(), rate(&h, &y_exact, e).unwrap());
        assert!((found.rate - known.rate).abs() < 3.0 * found.standard_error, "{found:?} {known:?}");
    }
    // and 1 where steps are short
    let finest = [exact_difference(4096), exact_difference(8192)];
    assert!(
        ((finest[0].0 / finest[1].0).log2() - 1.0).abs() < 1e-3
            && ((finest[0].1 / finest[1].1).log2() - 1.0).abs() < 1e-2
    );
    let limit = |differences: &[(f64, f64)]| match Bias::of(&h, differences) {
        Bias::Decays { to_limit, standard_error, .. } => (to_limit, standard_error),
        other => panic!("{other:?}"),
    };
    let (found, error) = limit(&means.iter().copied().zip(errors.iter().copied()).collect::<Vec<_>>());
    let (of_exact, _) = limit(&exact.iter().map(|x| x.0).zip(errors.iter().copied()).collect::<Vec<_>>());
    assert!((found - of_exact).abs() < 3.0 * error, "{found} {of_exact} {error}");
    // Where steps are short the limit is found to O(h), 1/512 and more.
    let h: Vec<f64> = (0..3).map(|l| 1.0 / f64::from(512 << l)).collect();
    let exact: Vec<(f64, f64)> = (0..3).map(|l| (exact_difference(512 << l).0, 1e-9)).collect();
    let Bias::Decays { to_limit, .. } = Bias::of(&h, &exact) else { panic!("it decays") };
    let truth = DRIFT.exp() - (1.0 + DRIFT / 2048.0).powi(2048);
    assert!((to_limit / truth - 1.0).abs() < 4.0 / 512.0, "{to_limit} {truth}");
}

#[test]
fn equal_levels_telescope_exactly() {
    let same = vec![1.5, 2.0, 4.0, 3.0];
    let first = Pairs { fine: same.clone(), coarse: None };
    let next = Pairs { fine: same.clone(), coarse: Some(same) };
    let t = terms(&[first.clone(), next.clone()]);
    assert_eq!((t[1].mean, t[1].variance, t[1].variance_se), (0.0, 0.0, 0.0));
    assert_eq!(telescope(&t).0, t[0].mean);
    assert_eq!(beyond(&[first, next], 2.0).share, 0.5);
}

#[test]
fn the_allocation_reaches_its_variance_at_the_least_cost() {
    let (v, c, target) = ([4.0, 1.0, 0.25], [1.0, 8.0, 64.0], 1e-4);
    let n = allocation(&v, &c, target);
    let cost: f64 = n.iter().zip(c).map(|(n, c)| *n as f64 * c).sum();
    let reached: f64 = n.iter().zip(v).map(|(n, v)| v / *n as f64).sum();
    assert!(reached <= target && reached > 0.999 * target);
    // one realisation a term by rounding up
    assert!(cost >= root_sum(&v, &c).powi(2) / target && cost < root_sum(&v, &c).powi(2) / target + 73.0);
    for (from, to) in [(0, 1), (1, 2), (2, 0)] {
        let mut other: Vec<f64> = n.iter().map(|n| *n as f64).collect();
        other[from] *= 0.9;
        let rest: f64 = (0..3).filter(|l| *l != to).map(|l| v[l] / other[l]).sum();
        other[to] = v[to] / (target - rest);
        let dearer: f64 = other.iter().zip(c).map(|(n, c)| n * c).sum();
        assert!(dearer > cost, "{from} {to}");
    }
    // one level: n = V / target
    assert_eq!(allocation(&[9.0], &[5.0], 0.09), [100]);
}

#[test]
fn the_ratio_tells_strong_coupling_from_none() {
    let strong = motion(3, &[500, 500, 500]);
    let costs = [1.0, 3.0, 6.0];
    let ratio = cost_ratio(&terms(&strong), &costs, 4.0);
    let [low, high] = cost_ratio_interval(&strong, &costs, 4.0).unwrap();
    assert!(low < ratio && ratio < high && high < 1.0, "{low} {ratio} {high}");
    let coarse = strong[0].fine.iter().rev().copied().collect();
    let none = [strong[0].clone(), Pairs { fine: strong[2].fine.clone(), coarse: Some(coarse) }];
    // V of the difference is the sum of both: (sqrt(V C0) + sqrt(2 V C1))^2 > V C1
    assert!(cost_ratio(&terms(&none), &[1.0, 5.0], 4.0) > 1.0);
}

#[test]
fn shares_beyond_sum_up_with_errors_that_cover() {
    // A lognormal in place of the motion on infinitely many steps would do for one level; here: the same as a
    // large plain sample of the finest level, within three standard errors of both.
    let plain = motion(11, &[0, 0, 20_000]);
    let share = plain[2].fine.iter().filter(|v| **v > 2.0).count() as f64 / 2e4;
    let found = beyond(&motion(12, &[4000, 2000, 1000]), 2.0);
    let error = found.standard_error.hypot((share * (1.0 - share) / 2e4).sqrt());
    assert!((found.share - share).abs() < 3.0 * error, "{found:?} {share}");
    // no pair differs, and yet the error is not 0
    let alike = Pairs { fine: vec![1.0; 10], coarse: Some(vec![1.0; 10]) };
    assert!(beyond(&[alike], 2.0).standard_error > 0.0);
}

#[test]
fn a_curve_for_the_eye_does_not_rise() {
    assert_eq!(falling(&[1.1, 0.75, 1.0, 0.25, -0.1]), [1.0, 0.875, 0.875, 0.25, 0.0]);
    let curve = falling(&[0.3, 0.9, 0.1, 0.5, 0.0]);
    assert!(curve.windows(2).all(|w| w[1] <= w[0]));
}
