//! What is compared: both schemes, longer and shorter implicit steps, other integrators of inertia.

use serde::Serialize;

use crate::case::{Case, Inertia, Material, Regime};

/// Which question a variant answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Group {
    /// Explicit against implicit.
    Schemes,
    /// What the length of an implicit step does.
    Steps,
    /// What the integrator of inertia does.
    Inertia,
}

/// One variant.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Entry {
    pub group: Group,
    pub variant: String,
    pub overrides: Vec<String>,
    /// Jittered runs of it.
    #[serde(skip)]
    pub count: usize,
    /// Whether its onset is looked for.
    #[serde(skip)]
    pub onset: bool,
}

/// All variants. The first of `steps` (s) is compared with the explicit scheme; explicit and
/// implicit come first. `runs` and `sweep` are the runs of the first two and of each other.
pub fn entries(case: &Case, steps: &[f64], runs: usize, sweep: usize) -> Vec<Entry> {
    let (first, others) = steps.split_first().map_or((0.01, steps), |(f, o)| (*f, o));
    let [runs, sweep] = if draws(case) { [runs, sweep] } else { [1, sweep.min(1)] };
    let mut all = vec![
        Entry {
            group: Group::Schemes,
            variant: "explicit".to_owned(),
            overrides: vec!["solver.scheme=explicit".to_owned()],
            count: runs,
            onset: true,
        },
        Entry { group: Group::Schemes, count: runs, ..implicit(case, first) },
    ];
    if sweep > 0 {
        all.extend(others.iter().map(|dt| Entry { count: sweep, ..implicit(case, *dt) }));
        all.extend(inertias(case).into_iter().map(|(word, key)| {
            let mut e = Entry { group: Group::Inertia, count: sweep, onset: false, ..implicit(case, first) };
            e.variant = format!("{}, {word}", e.variant);
            e.overrides.push(key);
            e
        }));
    }
    all
}

fn implicit(case: &Case, dt: f64) -> Entry {
    let mut overrides = vec![
        "solver.scheme=implicit".to_owned(),
        format!("implicit.time_step={dt:?}"),
        format!("implicit.max_time_step={dt:?}"),
    ];
    if needs_inertia(case) {
        overrides.push("implicit.regime=newmark".to_owned());
    }
    Entry { group: Group::Steps, variant: format!("implicit, {dt} s"), overrides, count: 0, onset: true }
}

/// Whether a jittered strength makes runs differ.
fn draws(case: &Case) -> bool {
    case.material.values().any(|m| matches!(m, Material::VonMises { .. }))
}

/// A body that starts in motion has no equilibrium to start from.
pub fn needs_inertia(case: &Case) -> bool {
    let moving = |v: [f64; 2]| v != [0.0; 2];
    let motion = |r: &crate::case::Region| moving(r.velocity) || r.spin.is_some() || r.wave.is_some();
    matches!(case.implicit.regime, Regime::Auto { .. }) && case.region.iter().any(motion)
}

/// The other integrators of inertia, with the key that brings each in.
fn inertias(case: &Case) -> Vec<(&'static str, String)> {
    let words = ["newmark", "hht", "backward_euler"];
    let (own, key) = match case.implicit.regime {
        Regime::QuasiStatic => return Vec::new(),
        Regime::Auto { .. } if needs_inertia(case) => ("newmark", "regime"),
        Regime::Auto { inertia: Inertia::Newmark } => ("newmark", "inertia"),
        Regime::Auto { inertia: Inertia::Hht { .. } } => ("hht", "inertia"),
        Regime::Auto { inertia: Inertia::BackwardEuler } => ("backward_euler", "inertia"),
        regime => (regime.word(), "regime"),
    };
    let others = words.into_iter().filter(|w| *w != own);
    others.map(|w| (w, format!("implicit.{key}={w}"))).collect()
}
