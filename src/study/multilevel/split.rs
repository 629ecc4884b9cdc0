//! The best split of an error between bias and standard error: which setting, and how many realisations of it.
//!
//! error^2 = b^2 + s^2 / n, with the bias b and the standard deviation s of a setting. Biases are those against the
//! finest level, which is not the limit.

use serde::Serialize;

use super::{
    Target,
    estimate::{Cost, Quantity},
    runs::Runs,
    settings::Setting,
};
use crate::math::stats::{Paired, Summary};

/// What one setting gives and takes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Offer {
    pub label: String,
    /// Runs that its figures rest on.
    pub runs: usize,
    /// Standard deviation between realisations.
    pub sd: f64,
    /// Against the finest level, and its standard error: sums of mean differences along the levels.
    pub bias: f64,
    pub bias_se: f64,
    /// CPU time of a run (s).
    pub run_cpu_s: f64,
    /// Realisations that the target takes; `None` where the bias alone is larger.
    pub realisations: Option<u64>,
    pub cpu_s: Option<f64>,
    /// Whether the target is met too with a bias larger by 1.64 of its standard errors (95 %, one side).
    pub sure: bool,
}

impl Offer {
    /// sqrt(b^2 + s^2 / n) for a CPU time (s); `None` if that is not enough for two runs.
    pub fn error_for(&self, cpu_s: f64) -> Option<f64> {
        let n = (cpu_s / self.run_cpu_s).floor();
        (n >= 2.0).then(|| (self.bias.powi(2) + self.sd.powi(2) / n).sqrt())
    }
}

/// The settings for a target, and the best for a given time.
#[derive(Clone, Debug, Serialize)]
pub struct Split {
    pub offers: Vec<Offer>,
    /// Places of the cheapest offer, and of the cheapest that surely meets the target.
    pub best: Option<usize>,
    pub best_sure: Option<usize>,
    /// The least error for some CPU times (s).
    pub budgets: Vec<Budget>,
}

/// The least error for a CPU time.
#[derive(Clone, Debug, Serialize)]
pub struct Budget {
    pub cpu_s: f64,
    pub label: String,
    pub realisations: u64,
    pub error: f64,
}

/// All offers for a measure.
pub fn split(runs: &Runs<'_>, settings: &[Setting], costs: &[Cost], quantity: &Quantity, target: Target) -> Split {
    let all = settings.iter().zip(costs).enumerate();
    let offers: Vec<Offer> =
        all.filter_map(|(k, (setting, cost))| offer(runs, (k, setting), cost, quantity, target)).collect();
    let best = cheapest(&offers, |_| true);
    let dearest = offers.iter().filter_map(|o| o.cpu_s).fold(0.0, f64::max);
    // decades up to what the dearest setting takes
    let budgets = (0..4).rev().filter_map(|k| budget(&offers, round(dearest) / 10_f64.powi(k))).collect();
    Split { best, best_sure: cheapest(&offers, |o| o.sure), budgets, offers }
}

fn cheapest(offers: &[Offer], takes_part: fn(&Offer) -> bool) -> Option<usize> {
    let costs = offers.iter().enumerate().filter(|(_, o)| takes_part(o)).filter_map(|(k, o)| Some((k, o.cpu_s?)));
    costs.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
}

/// To one figure.
fn round(value: f64) -> f64 {
    let decade = 10_f64.powf(value.max(f64::MIN_POSITIVE).log10().floor());
    (value / decade).round() * decade
}

fn budget(offers: &[Offer], cpu_s: f64) -> Option<Budget> {
    let found = offers.iter().filter_map(|o| Some((o, o.error_for(cpu_s)?)));
    let (offer, error) = found.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let realisations = (cpu_s / offer.run_cpu_s).floor() as u64;
    Some(Budget { cpu_s, label: offer.label.clone(), realisations, error })
}

fn offer(
    runs: &Runs<'_>,
    (k, setting): (usize, &Setting),
    cost: &Cost,
    quantity: &Quantity,
    target: Target,
) -> Option<Offer> {
    let values: Vec<f64> = runs.of_setting(k).filter_map(|d| d.row.measure(&quantity.name)).collect();
    let summary = Summary::of(&values).filter(|s| s.n > 1)?;
    let (bias, bias_se) = bias(runs, (k, setting), quantity)?;
    let needed = |b: f64| realisations(b, summary.sd, target);
    let count = needed(bias);
    Some(Offer {
        label: setting.label.clone(),
        runs: summary.n,
        sd: summary.sd,
        bias,
        bias_se,
        run_cpu_s: cost.cpu_s,
        realisations: count,
        cpu_s: count.map(|n| n as f64 * cost.cpu_s),
        sure: needed(bias.abs() + 1.64 * bias_se).is_some(),
    })
}

/// Mean at the setting less `E[Y_L]`: its difference from its own level, and from there up the levels.
fn bias(runs: &Runs<'_>, (k, setting): (usize, &Setting), quantity: &Quantity) -> Option<(f64, f64)> {
    let above = quantity.terms.get(setting.level + 1..)?;
    let (mut bias, mut variance) = (-above.iter().map(|t| t.mean).sum::<f64>(), 0.0);
    variance += above.iter().map(|t| t.mean_se.powi(2)).sum::<f64>();
    if k != setting.level {
        let (own, level, _) = runs.both(setting.level, [k, setting.level], &quantity.name);
        let d = Paired::of(&level, &own)?;
        bias += d.mean;
        // where no pair differs, as if one did, by one standard deviation: s / n
        let least = if d.sd > 0.0 { 0.0 } else { Summary::of(&level).map_or(0.0, |s| s.sd / s.n as f64) };
        variance += d.mean_se.max(least).powi(2);
    }
    Some((bias, variance.sqrt()))
}

/// n = s^2 / (target - b^2), at least 2.
fn realisations(bias: f64, sd: f64, target: Target) -> Option<u64> {
    let left = target.variance() - bias * bias;
    (left > 0.0).then(|| (sd * sd / left).ceil().max(2.0) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offer(bias: f64, sd: f64, run_cpu_s: f64) -> Offer {
        let target = Target { error: 0.5, bias_share: 0.0 };
        let realisations = realisations(bias, sd, target);
        let cpu_s = realisations.map(|n| n as f64 * run_cpu_s);
        Offer { label: String::new(), runs: 9, sd, bias, bias_se: 0.0, run_cpu_s, realisations, cpu_s, sure: true }
    }

    #[test]
    fn bias_and_error_share_the_target() {
        // 0.3^2 + 0.4^2 = 0.5^2: 2^2 / 0.4^2 = 25 runs
        assert_eq!(offer(0.3, 2.0, 1.0).realisations, Some(25));
        assert_eq!(offer(-0.5, 2.0, 1.0).realisations, None);
        assert!((offer(0.3, 2.0, 1.0).error_for(25.5).unwrap() - 0.5).abs() < 1e-15);
        assert_eq!(offer(0.3, 2.0, 1.0).error_for(1.9), None);
    }

    #[test]
    fn the_best_setting_changes_with_the_time() {
        let offers = [offer(0.6, 2.0, 0.1), offer(0.3, 2.0, 1.0), offer(0.0, 2.0, 8.0)];
        assert_eq!(cheapest(&offers, |_| true), Some(1));
        let error = |cpu_s| offers.each_ref().map(|o| o.error_for(cpu_s));
        let [a, b, c] = error(3.0);
        assert!(a.unwrap() < b.unwrap() && c.is_none());
        let [a, b, c] = error(1000.0);
        assert!(c.unwrap() < b.unwrap() && b.unwrap() < a.unwrap());
        assert_eq!((round(847.0), round(0.0234)), (800.0, 0.02));
    }
}
