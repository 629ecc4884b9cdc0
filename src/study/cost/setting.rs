//! The settings of a study: every value of every axis with every value of the others.

use std::cmp::Ordering;

use super::Plan;
use crate::{
    case::{self, Case, Diagnostics, Scheme, ShapeFunctions},
    study::digits::figure,
};

/// One key with the values that it is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub key: String,
    pub values: Vec<String>,
}

impl Axis {
    fn new(key: &str, values: Vec<String>) -> Self {
        Axis { key: key.to_owned(), values }
    }

    /// A key times some factors.
    fn times(key: &str, value: f64, factors: &[f64]) -> Self {
        Self::new(key, factors.iter().map(|f| format!("{:?}", f * value)).collect())
    }

    /// Keys of one scheme mean nothing to the other.
    fn belongs_to(&self, scheme: &str) -> bool {
        let owner = ["explicit", "implicit"].into_iter().find(|s| self.key.split('.').next() == Some(*s));
        owner.is_none_or(|owner| owner == scheme)
    }
}

/// One way to solve the case.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Key and value by axis.
    pub keys: Vec<(String, String)>,
    pub case: Case,
}

/// A setting that the case does not allow, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Refused {
    pub label: String,
    pub why: String,
}

/// All settings of a plan, in the order of its axes; those that come to the same case once.
///
/// # Errors
/// What is wrong with a value of the plan's own axes that no setting can have; a key of theirs that no setting has;
/// what is wrong with the first setting where the case allows none.
pub fn settings(plan: &Plan, case: &Case) -> Result<(Vec<Setting>, Vec<Refused>), String> {
    let (mut settings, mut refused): (Vec<Setting>, Vec<(String, Diagnostics)>) = (Vec::new(), Vec::new());
    let combinations = combinations(&axes(plan, case), word_of(case.solver.scheme));
    without_use(plan, &combinations)?;
    for keys in combinations {
        match read(plan, overrides(&keys)) {
            Ok(case) if settings.iter().any(|s| s.case == case) => {}
            Ok(case) => settings.push(Setting { keys, case }),
            Err(errors) => refused.push((label(&keys), errors)),
        }
    }
    impossible(plan, &settings)?;
    match refused.first() {
        Some((label, errors)) if settings.is_empty() => {
            Err(format!("no setting is allowed, such as {label}:\n{}", errors.render(false)))
        }
        _ => Ok((
            settings,
            refused.into_iter().map(|(label, errors)| Refused { label, why: message(&errors) }).collect(),
        )),
    }
}

fn message(errors: &Diagnostics) -> String {
    errors.errors().first().map(|e| e.message.clone()).unwrap_or_default()
}

/// An axis of the plan whose key stands in no combination.
fn without_use(plan: &Plan, combinations: &[Vec<(String, String)>]) -> Result<(), String> {
    let has = |axis: &Axis| combinations.iter().flatten().any(|(key, _)| *key == axis.key);
    match plan.vary.iter().find(|axis| !has(axis)) {
        Some(Axis { key, .. }) => Err(format!(
            "no setting has {key}: its scheme is not run, or a fixed time step stands in the place of the Courant number"
        )),
        None => Ok(()),
    }
}

/// A value of the plan's axes that is in no setting, nor allowed by itself.
fn impossible(plan: &Plan, settings: &[Setting]) -> Result<(), String> {
    let pairs = plan.vary.iter().flat_map(|a| a.values.iter().map(|v| (a.key.clone(), v.clone())));
    let mut absent = pairs.filter(|pair| !settings.iter().any(|s| s.keys.contains(pair)));
    absent.try_for_each(|(key, value)| allowed(plan, format!("{key}={value}")))
}

/// Whether the case can be read with one key changed.
///
/// # Errors
/// What the reader says.
pub fn allowed(plan: &Plan, set: String) -> Result<(), String> {
    read(plan, [set]).map(|_| ()).map_err(|e| e.render(false))
}

/// The usual axes, those that the plan sets itself in their place, and its further ones.
fn axes(plan: &Plan, case: &Case) -> Vec<Axis> {
    let mut axes = usual(case, plan.levels);
    for (key, own) in [("solver.scheme", word_of(case.solver.scheme)), ("solver.shape", case.solver.shape.word())] {
        let chosen = axes.iter_mut().filter(|a| a.key == key && plan.overrides.iter().any(|set| sets(set, key)));
        chosen.for_each(|a| a.values = vec![own.to_owned()]);
    }
    for axis in merged(&plan.vary) {
        match axes.iter_mut().find(|a| a.key == axis.key) {
            Some(usual) => *usual = axis,
            None => axes.push(axis),
        }
    }
    // a fixed step takes the place of the Courant number
    let fixed = plan.vary.iter().any(|a| a.key == "explicit.time_step");
    axes.retain(|a| a.key != "explicit.courant" || !fixed);
    axes
}

/// Axes with the values of one key together, each once.
pub fn merged(vary: &[Axis]) -> Vec<Axis> {
    let mut axes: Vec<Axis> = Vec::new();
    for Axis { key, values } in vary {
        if !axes.iter().any(|a| a.key == *key) {
            axes.push(Axis::new(key, Vec::new()));
        }
        for axis in axes.iter_mut().filter(|a| a.key == *key) {
            let new: Vec<String> = values.iter().filter(|v| !axis.values.contains(v)).cloned().collect();
            axis.values.extend(new);
        }
    }
    axes
}

/// Whether an override sets a key, or the table that holds it.
fn sets(set: &str, key: &str) -> bool {
    let path = set.split('=').next().unwrap_or_default().split('.').map(|part| part.trim().trim_matches('"'));
    let path = path.collect::<Vec<_>>().join(".");
    key.strip_prefix(&path).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// Both schemes; the shapes that need no reason; h and its halves; time steps a factor of 4 apart in the implicit
/// scheme, which is free in them, and twice the Courant number in the explicit one.
fn usual(case: &Case, levels: u32) -> Vec<Axis> {
    let halves: Vec<f64> = (0..levels).map(|k| 0.5f64.powi(k as i32)).collect();
    let mut shapes: Vec<ShapeFunctions> = ShapeFunctions::ALL.to_vec();
    // for soil that is pulled far out: a larger patch of the same functions
    shapes.retain(|s| *s != ShapeFunctions::GimpWide || case.solver.shape == ShapeFunctions::GimpWide);
    vec![
        Axis::new("solver.scheme", vec!["explicit".to_owned(), "implicit".to_owned()]),
        Axis::new("solver.shape", shapes.iter().map(|s| s.word().to_owned()).collect()),
        Axis::times("grid.cell", case.grid.cell, &halves),
        match case.explicit.time_step {
            Some(step) => Axis::times("explicit.time_step", step, &[1.0, 0.5]),
            None => {
                Axis::times("explicit.courant", case.explicit.courant, &[(0.9 / case.explicit.courant).min(2.0), 1.0])
            }
        },
        match case.implicit.tolerance {
            Some(tolerance) => Axis::times("implicit.tolerance", tolerance, &[4.0, 1.0, 0.25]),
            None => Axis::times("implicit.time_step", case.implicit.time_step, &[4.0, 1.0, 0.25]),
        },
    ]
}

/// Every value with every other, as far as they go with the scheme; the first axis varies slowest.
fn combinations(axes: &[Axis], own_scheme: &str) -> Vec<Vec<(String, String)>> {
    let mut found: Vec<Vec<(String, String)>> = vec![Vec::new()];
    // the scheme first: it tells which of the others apply
    let (schemes, others): (Vec<&Axis>, Vec<&Axis>) = axes.iter().partition(|a| a.key == "solver.scheme");
    for axis in schemes.into_iter().chain(others) {
        found = found.into_iter().flat_map(|keys| extended(keys, axis, own_scheme)).collect();
    }
    found
}

fn extended(keys: Vec<(String, String)>, axis: &Axis, own_scheme: &str) -> Vec<Vec<(String, String)>> {
    let scheme = keys.iter().find(|(key, _)| key == "solver.scheme").map_or(own_scheme, |(_, value)| value);
    if !axis.belongs_to(scheme) {
        return vec![keys];
    }
    let with = |value: &String| keys.iter().cloned().chain([(axis.key.clone(), value.clone())]).collect();
    axis.values.iter().map(with).collect()
}

fn read(plan: &Plan, sets: impl IntoIterator<Item = String>) -> Result<Case, Diagnostics> {
    let overrides: Vec<String> = plan.overrides.iter().cloned().chain(sets).collect();
    case::read(&plan.name, &plan.text, &overrides).map(|(case, _)| case)
}

/// `KEY=VALUE`, as for `--set`.
fn overrides(keys: &[(String, String)]) -> impl Iterator<Item = String> + '_ {
    keys.iter().map(|(key, value)| format!("{key}={value}"))
}

/// The words of a setting, such as "implicit, gimp, h = 0.5, dt = 0.05".
fn label(keys: &[(String, String)]) -> String {
    let part = |(key, value): &(String, String)| {
        let short = value.parse().map_or(value.clone(), figure);
        match key.as_str() {
            "solver.scheme" | "solver.shape" => short,
            "grid.cell" => format!("h = {short}"),
            "implicit.time_step" | "explicit.time_step" => format!("dt = {short}"),
            _ => format!("{} = {short}", key.rsplit('.').next().unwrap_or(key)),
        }
    };
    keys.iter().map(part).collect::<Vec<_>>().join(", ")
}

pub fn word_of(scheme: Scheme) -> &'static str {
    match scheme {
        Scheme::Explicit => "explicit",
        Scheme::Implicit => "implicit",
    }
}

impl Setting {
    pub fn label(&self) -> String {
        label(&self.keys)
    }

    pub fn overrides(&self) -> Vec<String> {
        overrides(&self.keys).collect()
    }

    /// The words without those of the cell size: the name of a ladder of meshes.
    pub fn ladder(&self) -> String {
        let others: Vec<_> = self.keys.iter().filter(|(key, _)| key != "grid.cell").cloned().collect();
        label(&others)
    }

    /// Scheme and shape: what has a colour of its own.
    pub fn family(&self) -> String {
        format!("{}, {}", word_of(self.case.solver.scheme), self.case.solver.shape.word())
    }

    /// Whether this is `other` with one key made finer and all others alike.
    pub fn refines(&self, other: &Setting) -> bool {
        if self.keys.len() != other.keys.len() {
            return false;
        }
        let mut changed = self.keys.iter().zip(&other.keys).filter(|(a, b)| a != b);
        match (changed.next(), changed.next()) {
            (Some((a, b)), None) if a.0 == b.0 => {
                let of = |s: &Setting| fineness(&s.case, &a.0);
                of(self).zip(of(other)).is_some_and(|(a, b)| a.total_cmp(&b) == Ordering::Less)
            }
            _ => false,
        }
    }
}

/// The number that gets smaller as a key is refined; `None` for a key that is a choice.
fn fineness(case: &Case, key: &str) -> Option<f64> {
    match key {
        "grid.cell" => Some(case.grid.cell),
        "points.per_axis" => Some(1.0 / case.points.per_axis as f64),
        "explicit.courant" => Some(case.explicit.courant),
        "explicit.time_step" => case.explicit.time_step,
        "implicit.time_step" => Some(case.implicit.time_step),
        "implicit.tolerance" => case.implicit.tolerance,
        "implicit.residual" => Some(case.implicit.residual),
        _ => None,
    }
}

/// Whether a key says how the problem is solved, not what it is.
pub fn is_numerical(key: &str) -> bool {
    ["grid.cell", "points", "solver", "explicit", "implicit"]
        .iter()
        .any(|k| key == *k || key.starts_with(&format!("{k}.")))
}
