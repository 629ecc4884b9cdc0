//! From a standard normal value to a factor on the mean of a parameter.

/// Distribution of a parameter about its mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Marginal {
    /// 1 + V Z.
    Normal { variation: f64, low: Low },
    /// exp(s Z - s^2/2) with s^2 = ln(1 + V^2): mean 1 and coefficient of variation V where Z has variance 1.
    /// Where Z is a local average its variance is less, and the value is a geometric average: its mean
    /// is lower by exp(-s^2 (1 - var Z) / 2).
    Lognormal { variation: f64 },
}

/// What becomes of factors below a floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Low {
    /// They are raised to it.
    Floor(f64),
    /// The field is drawn again until there is none.
    Resample(f64),
    /// They stay.
    Keep,
}

impl Marginal {
    /// V, the coefficient of variation of point values.
    pub fn variation(&self) -> f64 {
        match *self {
            Marginal::Normal { variation, .. } | Marginal::Lognormal { variation } => variation,
        }
    }

    /// The factor of a normal value `z`, before any floor.
    pub fn factor(&self, z: f64) -> f64 {
        match *self {
            Marginal::Normal { variation, .. } => 1.0 + variation * z,
            Marginal::Lognormal { variation } => {
                let square = variation.powi(2).ln_1p();
                (square.sqrt() * z - 0.5 * square).exp()
            }
        }
    }

    /// What happens to low values; a lognormal one is never too low.
    pub fn low(&self) -> Low {
        match *self {
            Marginal::Normal { low, .. } => low,
            Marginal::Lognormal { .. } => Low::Keep,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lognormal_factor_has_mean_one_and_the_variation_asked_for() {
        // midpoint rule over the normal density: exact to rounding for so smooth a function
        let marginal = Marginal::Lognormal { variation: 0.5 };
        let moment = |power: i32| -> f64 {
            let z = |k: i32| -9.0 + 0.01 * (f64::from(k) + 0.5);
            let weight = |z: f64| 0.01 * (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
            (0..1800).map(|k| weight(z(k)) * marginal.factor(z(k)).powi(power)).sum()
        };
        let (mean, square) = (moment(1), moment(2));
        assert!((mean - 1.0).abs() < 1e-9, "{mean}");
        assert!(((square - 1.0).sqrt() - 0.5).abs() < 1e-9, "{square}");
    }

    #[test]
    fn a_normal_factor_is_linear() {
        let marginal = Marginal::Normal { variation: 0.25, low: Low::Keep };
        assert_eq!([-2.0, 0.0, 2.0].map(|z| marginal.factor(z)), [0.5, 1.0, 1.5]);
    }
}
