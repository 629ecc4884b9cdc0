//! The standard normal distribution: density, both tails, quantile.

/// 1 / sqrt(2 pi)
const PEAK: f64 = 0.398_942_280_401_432_7;
/// ln sqrt(2 pi)
const LOG_ROOT: f64 = 0.918_938_533_204_672_7;
/// From here on the continued fraction of the tail serves, below it the series.
const TAIL: f64 = 2.0;

/// phi(z) = exp(-z^2 / 2) / sqrt(2 pi)
pub fn density(z: f64) -> f64 {
    PEAK * (-0.5 * z * z).exp()
}

/// Phi(z), the probability of a value up to z; relative error below 1e-13 in both tails.
pub fn cdf(z: f64) -> f64 {
    if z < -TAIL {
        density(z) * mills(-z)
    } else if z <= TAIL {
        0.5 + density(z) * series(z)
    } else {
        // NaN comes here and stays.
        1.0 - density(z) * mills(z)
    }
}

/// ln Phi(z), finite for every finite z whose square is.
pub fn log_cdf(z: f64) -> f64 {
    if z < -TAIL {
        mills(-z).ln() - 0.5 * z * z - LOG_ROOT
    } else if z <= TAIL {
        cdf(z).ln()
    } else {
        (-density(z) * mills(z)).ln_1p()
    }
}

/// phi(z) / Phi(z), the derivative of ln Phi.
pub fn log_cdf_slope(z: f64) -> f64 {
    if z < -TAIL { 1.0 / mills(-z) } else { density(z) / cdf(z) }
}

/// The z with Phi(z) = p; infinite for 0 and 1, NaN outside.
pub fn quantile(p: f64) -> f64 {
    if p > 0.5 {
        return -quantile(1.0 - p);
    }
    if p == 0.0 {
        return f64::NEG_INFINITY;
    }
    // ln Phi is concave and Phi(z) <= exp(-z^2 / 2) / 2 below 0, so Newton's method from
    // -sqrt(-2 ln p) comes up to the root from below, without overshooting.
    let target = p.ln();
    let mut z = -(-2.0 * target).sqrt();
    for _ in 0..50 {
        let step = (target - log_cdf(z)) / log_cdf_slope(z);
        z += step;
        if step.abs() <= 1e-15 * z.abs() {
            break;
        }
    }
    z
}

/// (Phi(z) - 1/2) / phi(z) = z + z^3/3 + z^5/(3 5) + z^7/(3 5 7) + ...
/// (G. Marsaglia, J. Stat. Softw. 11(4), 2004). All terms have one sign.
fn series(z: f64) -> f64 {
    let (mut term, mut sum, mut odd) = (z, z, 1.0);
    while term.abs() > 1e-17 * sum.abs() {
        odd += 2.0;
        term *= z * z / odd;
        sum += term;
    }
    sum
}

/// (1 - Phi(z)) / phi(z) = 1 / (z + 1 / (z + 2 / (z + 3 / ...))), z >= 2 (Laplace).
fn mills(z: f64) -> f64 {
    let terms = 30 + (400.0 / (z * z)) as u32;
    1.0 / (1..=terms).rev().fold(z, |rest, k| z + f64::from(k) / rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_have_their_tabulated_values() {
        // Abramowitz and Stegun 26.2; further digits from a 50-digit evaluation.
        let table = [
            (0.0, 0.5),
            (1.0, 0.841_344_746_068_542_9),
            (-1.0, 0.158_655_253_931_457_05),
            (-5.0, 2.866_515_718_791_939e-7),
            (-10.0, 7.619_853_024_160_527e-24),
            (-37.0, 5.725_571_222_524_576e-300),
        ];
        for (z, p) in table {
            assert!((cdf(z) / p - 1.0).abs() < 1e-13, "{z}: {}", cdf(z));
            assert!((log_cdf(z) - f64::ln(p)).abs() < 1e-12, "{z}");
        }
        assert!((log_cdf(5.0) + 2.866_516_129_637_6e-7).abs() < 1e-19);
        assert!(cdf(f64::NAN).is_nan() && cdf(f64::INFINITY) == 1.0 && cdf(f64::NEG_INFINITY) == 0.0);
    }

    #[test]
    fn series_and_fraction_meet() {
        for z in [TAIL, 2.5, 3.0] {
            let tail = 0.5 - density(z) * series(z);
            // Rounding of 0.5 against a tail of 0.0013.
            assert!((tail / (density(z) * mills(z)) - 1.0).abs() < 2e-13, "{z}");
        }
    }

    #[test]
    fn the_quantile_is_the_inverse() {
        assert!((quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-14);
        for p in [1e-300, 1e-20, 0.001, 0.3, 0.5, 0.9, 0.999_999] {
            assert!((cdf(quantile(p)) / p - 1.0).abs() < 1e-12, "{p}");
        }
        assert_eq!((quantile(0.0), quantile(1.0)), (f64::NEG_INFINITY, f64::INFINITY));
        assert!(quantile(-0.1).is_nan() && quantile(1.1).is_nan() && quantile(f64::NAN).is_nan());
    }
}
