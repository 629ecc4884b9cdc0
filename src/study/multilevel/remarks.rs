//! What the figures are worth, in plain sentences computed from them.

use super::{
    Quantity, Study,
    text::{rate, seconds, words},
};
use crate::math::stats::Bias;

/// All sentences of a study.
pub fn remarks(study: &Study) -> Vec<String> {
    let Some(main) = study.quantities.first() else { return Vec::new() };
    let mut all = vec![bias(study, main), rates(study, main), best(study, main)];
    all.extend(study.quantities.iter().map(coupling));
    all.push(allocation(study));
    all.push(spent(study, main));
    all.extend(study.quantities.iter().filter_map(lacking));
    if study.failed > 0 {
        all.push(format!("{} runs failed and are left out, with their partners", study.failed));
    }
    if study.interrupted {
        all.push("the study was interrupted: its figures are those of the runs that were finished".to_owned());
    }
    all
}

/// Whether there is a limit in sight.
fn bias(study: &Study, q: &Quantity) -> String {
    let (name, unit) = words(&q.name);
    let finest = study.settings.get(q.levels.len() - 1).map_or("", |s| s.label.as_str());
    match q.bias {
        Bias::Decays { to_limit, standard_error, .. } => {
            let kept = study.target.bias_share.sqrt() * study.target.error;
            let enough = if to_limit.abs() > kept { "more than" } else { "within" };
            format!(
                "{name}: the differences between levels decay; the limit lies {to_limit:.2} +- {standard_error:.2} {unit} from the mean at {finest}, {enough} the {kept:.2} {unit} that the target keeps for it; all costs here are for the mean at {finest}"
            )
        }
        Bias::Unresolved { bound } => format!(
            "{name}: the last difference between levels is not told from 0 and is at most {bound:.2} {unit}; so is the bias at {finest}, if differences at least halve from level to level, which these runs do not show"
        ),
        Bias::NoDecay { last, standard_error, .. } => format!(
            "{name}: the last difference between levels, {last:.2} +- {standard_error:.2} {unit}, does not tell of a decay: no limit is in sight (softening without a length has none), the bias at {finest} is not defined, and all biases here are against {finest}"
        ),
        Bias::TooFew => {
            format!("{name}: two levels do not tell whether their differences decay; all biases are against {finest}")
        }
    }
}

fn rates(study: &Study, q: &Quantity) -> String {
    let alpha = match q.bias {
        Bias::Decays { alpha, .. } => Some(alpha),
        Bias::NoDecay { alpha, .. } => alpha,
        Bias::Unresolved { .. } | Bias::TooFew => None,
    };
    format!(
        "rates: means of differences fall as h^alpha, {}; their variances as h^beta, {}; a run costs h^-gamma, {}",
        rate("alpha", alpha),
        rate("beta", q.beta),
        rate("gamma", study.gamma)
    )
}

fn best(study: &Study, q: &Quantity) -> String {
    let (name, unit) = words(&q.name);
    let t = study.target;
    let goal = format!(
        "mean of {name} to +-{} {unit}, {:.0} % of its square kept for the bias of the finest level",
        t.error,
        100.0 * t.bias_share
    );
    let offer = |k: Option<usize>| study.split.offers.get(k?);
    let told = |k: Option<usize>| {
        offer(k).map_or("none".to_owned(), |o| {
            let (n, cpu) = (o.realisations.unwrap_or_default(), o.cpu_s.unwrap_or_default());
            format!("{n} realisations at {}, {} CPU s", o.label, seconds(cpu))
        })
    };
    let sure = match (study.split.best, study.split.best_sure) {
        (a, b) if a == b => "sure of its bias too".to_owned(),
        (_, b) => format!("its bias is not known well enough to be sure of it; the cheapest that is: {}", told(b)),
    };
    format!(
        "{goal}: plain Monte Carlo on the finest level {} CPU s ({} realisations); best split {} ({sure}); multilevel {} CPU s",
        seconds(study.forecast.plain_cpu_s),
        study.forecast.plain_realisations,
        told(study.split.best),
        seconds(study.forecast.cpu_s)
    )
}

/// Whether multilevel pays, and why.
fn coupling(q: &Quantity) -> String {
    let (name, _) = words(&q.name);
    if !q.cost_ratio.is_finite() {
        return format!(
            "{name}: all realisations of the finest level give the same, so that there is nothing to weigh"
        );
    }
    let figures: Vec<String> = q
        .terms
        .iter()
        .skip(1)
        .map(|t| {
            let r = t.correlation.map_or("unknown".to_owned(), |c| format!("{:.2}", c.r));
            let share = if t.fine_variance > 0.0 { t.variance / t.fine_variance } else { 0.0 };
            format!("{r} (V_l / V = {share:.2})")
        })
        .collect();
    let range = q.cost_ratio_interval.map_or(String::new(), |[a, b]| format!(" ({a:.2} to {b:.2})"));
    let verdict = match q.cost_ratio_interval {
        Some([_, high]) if high < 1.0 => "it pays",
        Some([low, _]) if low > 1.0 => "it does not pay: the levels are coupled too weakly",
        _ => "these runs do not tell whether it pays",
    };
    format!(
        "{name}: correlation of fine and coarse {}; multilevel takes {:.2}{range} of the CPU time of plain Monte Carlo on the finest level: {verdict}",
        figures.join(", "),
        q.cost_ratio
    )
}

fn allocation(study: &Study) -> String {
    format!(
        "realisations of the terms: N_l = ceil(sqrt(V_l / C_l) sum sqrt(V_k C_k) / {:.4}), with C in particle-steps, so that they do not depend on the clock",
        study.target.variance()
    )
}

fn spent(study: &Study, q: &Quantity) -> String {
    let (_, unit) = words(&q.name);
    format!(
        "multilevel mean {:.2} +- {:.2} {unit} from {} CPU s; plain Monte Carlo on the finest level would take {} CPU s for this standard error; the study took {} CPU s in all",
        q.mean,
        q.mean_se,
        seconds(q.cpu_s),
        seconds(q.plain_cpu_s),
        seconds(study.spent_cpu_s)
    )
}

/// A sum of means of different things.
fn lacking(q: &Quantity) -> Option<String> {
    let lost: usize = q.lacking.iter().sum();
    (lost > 0).then(|| {
        let (name, counts) = (words(&q.name).0, q.lacking.iter().map(usize::to_string).collect::<Vec<_>>().join(", "));
        format!("{name}: not defined at one of both levels in {counts} realisations of the terms; what is summed up are means where it is, and the sum is not the mean of the finest level")
    })
}
