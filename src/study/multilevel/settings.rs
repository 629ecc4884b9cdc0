//! The settings that are compared: cells of every level and, beside them, other numbers of points and steps.

use serde::Serialize;

use crate::{
    case::{self, Case, Scheme},
    study::ensemble::is_random,
};

/// What the levels are made of.
#[derive(Clone, Debug)]
pub struct Levels {
    /// Cell sizes, coarsest first (m).
    pub cells: Vec<f64>,
    /// Further keys of a level: its number from 0, and `KEY=VALUE`.
    pub keys: Vec<(usize, String)>,
    /// Points on each axis of a cell that are tried beside those of the case, on every level.
    pub points: Vec<usize>,
    /// Factors on the time step that are tried beside 1, on every level.
    pub steps: Vec<f64>,
    /// All levels take the time step of the case; else a step keeps its ratio to the cell.
    pub same_step: bool,
}

/// One way to run the case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Setting {
    pub label: String,
    /// Number of its level, from 0, the coarsest.
    pub level: usize,
    pub cell_m: f64,
    pub points_per_axis: usize,
    /// Factor on the time step of the level.
    pub step_factor: f64,
    /// What it changes in the case.
    pub overrides: Vec<String>,
}

/// The settings with their cases; those of the levels themselves come first, coarsest first.
pub struct Ladder {
    pub settings: Vec<Setting>,
    pub cases: Vec<Case>,
}

impl Ladder {
    /// Reads the case at every setting.
    ///
    /// # Errors
    /// A setting that cannot be read, or that does not have the random fields of the others.
    pub fn new(name: &str, text: &str, overrides: &[String], levels: &Levels) -> Result<Ladder, String> {
        let read = |more: &[String]| -> Result<Case, String> {
            let all: Vec<String> = overrides.iter().chain(more).cloned().collect();
            case::read(name, text, &all).map(|(case, _)| case).map_err(|e| e.render(false))
        };
        let base = read(&[])?;
        check(levels, &base)?;
        let settings = settings(levels, &base);
        let cases = settings.iter().map(|s| read(&s.overrides)).collect::<Result<Vec<_>, _>>()?;
        same_fields(&settings, &cases)?;
        Ok(Ladder { settings, cases })
    }
}

/// What no level can mend.
fn check(levels: &Levels, base: &Case) -> Result<(), String> {
    if !is_random(base) {
        return Err(
            "nothing in this case is random: give it a [field.NAME], or --set jitter.strength=0.0005".to_owned()
        );
    }
    if base.ensemble.antithetic {
        let text = "the realisations of a term are taken as independent: --set ensemble.antithetic=false";
        return Err(text.to_owned());
    }
    if levels.cells.len() < 2 || levels.cells.windows(2).any(|h| h[1] >= h[0]) {
        return Err("--levels: at least two cell sizes are needed, the coarsest first".to_owned());
    }
    match levels.keys.iter().find(|(level, _)| *level >= levels.cells.len()) {
        Some((level, key)) => Err(format!("--at-level {level}:{key}: levels go from 0 to {}", levels.cells.len() - 1)),
        None => Ok(()),
    }
}

fn settings(levels: &Levels, base: &Case) -> Vec<Setting> {
    let usual = base.points.per_axis;
    let others = levels.points.iter().filter(|n| **n != usual).map(|n| (*n, 1.0));
    let steps = levels.steps.iter().filter(|f| **f != 1.0).map(|f| (usual, *f));
    std::iter::once((usual, 1.0))
        .chain(others)
        .chain(steps)
        .flat_map(|variant| (0..levels.cells.len()).map(move |level| setting(levels, base, level, variant)))
        .collect()
}

fn setting(levels: &Levels, base: &Case, level: usize, (per_axis, step_factor): (usize, f64)) -> Setting {
    let cell = levels.cells[level];
    let ratio = if levels.same_step { 1.0 } else { cell / base.grid.cell };
    let mut label = format!("h = {cell} m");
    let mut overrides = vec![format!("grid.cell={cell:?}")];
    overrides.extend(step(base, ratio, step_factor));
    if per_axis != base.points.per_axis {
        label += &format!(", {} points", per_axis * per_axis);
        overrides.push(format!("points.per_axis={per_axis}"));
    }
    if step_factor != 1.0 {
        label += &format!(", step x {step_factor}");
    }
    overrides.extend(levels.keys.iter().filter(|(of, _)| *of == level).map(|(_, key)| key.clone()));
    Setting { label, level, cell_m: cell, points_per_axis: per_axis, step_factor, overrides }
}

/// The key of the time step: a step that is chosen by the fastest wave follows the cell by itself.
fn step(base: &Case, ratio: f64, factor: f64) -> Option<String> {
    let (key, value, factor) = match (base.solver.scheme, base.explicit.time_step) {
        (Scheme::Explicit, Some(dt)) => ("explicit.time_step", dt, ratio * factor),
        (Scheme::Explicit, None) => ("explicit.courant", base.explicit.courant, factor),
        (Scheme::Implicit, _) => ("implicit.time_step", base.implicit.time_step, ratio * factor),
    };
    (factor != 1.0).then(|| format!("{key}={:?}", value * factor))
}

/// Levels are only worth comparing on the same fields: generators and realisations are pure functions of the
/// fields' keys, the seed and the regions.
fn same_fields(settings: &[Setting], cases: &[Case]) -> Result<(), String> {
    let Some(first) = cases.first() else { return Ok(()) };
    let same = |case: &Case| (&case.field, case.seed, &case.region) == (&first.field, first.seed, &first.region);
    match settings.iter().zip(cases).find(|(_, case)| !same(case)) {
        Some((setting, _)) => Err(format!(
            "the random fields of `{}` are not those of the coarsest level: [field.NAME], seed and regions must not change from level to level",
            setting.label
        )),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{body::Column, scene, study::ensemble::realise};

    const CASE: &str = include_str!("../../../cases/random-slope.toml");

    fn levels() -> Levels {
        Levels { cells: vec![1.0, 0.5], keys: Vec::new(), points: vec![3], steps: vec![2.0], same_step: false }
    }

    fn ladder(levels: &Levels, set: &[&str]) -> Result<Ladder, String> {
        let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
        Ladder::new("slope", CASE, &set, levels)
    }

    #[test]
    fn levels_come_first_and_steps_follow_the_cell() {
        let found = ladder(&levels(), &[]).unwrap_or_else(|e| panic!("{e}"));
        let labels: Vec<&str> = found.settings.iter().map(|s| s.label.as_str()).collect();
        assert_eq!(labels[..3], ["h = 1 m", "h = 0.5 m", "h = 1 m, 9 points"]);
        let steps: Vec<f64> = found.cases.iter().filter_map(|c| c.explicit.time_step).collect();
        // 2 ms at 0.25 m
        assert_eq!(steps, [0.008, 0.004, 0.008, 0.004, 0.016, 0.008]);
        let same = Levels { same_step: true, ..levels() };
        assert_eq!(ladder(&same, &[]).unwrap_or_else(|e| panic!("{e}")).cases[0].explicit.time_step, Some(0.002));
    }

    #[test]
    fn what_cannot_be_compared_is_refused() {
        let other = |keys: &[(usize, &str)]| {
            let keys = keys.iter().map(|(l, k)| (*l, (*k).to_owned())).collect();
            ladder(&Levels { keys, ..levels() }, &[]).map(|_| ()).unwrap_err()
        };
        assert!(other(&[(0, "field.strength.cell=0.5")]).contains("must not change from level to level"));
        assert!(other(&[(1, "seed=2")]).contains("must not change"));
        assert!(other(&[(2, "seed=2")]).contains("levels go from 0 to 1"));
        let rising = Levels { cells: vec![0.5, 1.0], ..levels() };
        assert!(ladder(&rising, &[]).is_err_and(|e| e.contains("coarsest first")));
        assert!(ladder(&levels(), &["field.strength.variation=0"]).is_err_and(|e| e.contains("random")));
        assert!(ladder(&levels(), &["ensemble.antithetic=true"]).is_err_and(|e| e.contains("independent")));
    }

    /// Places and strengths of all points.
    fn strengths(case: &Case) -> Vec<([f64; 2], f64)> {
        let scene = scene::build(&realise(case, Some(3)), 1 << 30).unwrap_or_else(|e| panic!("{e}"));
        let body = &scene.simulation.body;
        let group = &body.groups[0];
        let cohesion = group.law.params().iter().position(|n| *n == "cohesion").expect("a cohesion");
        let Column::Varying(c) = &group.params[cohesion] else { panic!("it varies") };
        let x = &body.committed.x;
        group.range.clone().map(|p| [x[0][p], x[1][p]]).zip(c.iter().copied()).collect()
    }

    /// Every point of the coarse mesh has the strength of the points of the fine one in the same cell of the
    /// field, to the bit; so strengths differ from mesh to mesh only in which cells of the field they sample.
    #[test]
    fn a_place_has_the_same_strength_on_every_mesh() {
        let fine = Levels { cells: vec![1.0, 0.25], ..levels() };
        let found = ladder(&fine, &[]).unwrap_or_else(|e| panic!("{e}"));
        let (coarse, fine) = (strengths(&found.cases[0]), strengths(&found.cases[1]));
        let cell = |x: [f64; 2]| x.map(|v| (v / 0.25).floor() as i64);
        let (mut compared, mut inside) = (0, Vec::new());
        for (x, c) in &coarse {
            let mut same = fine.iter().filter(|(y, _)| cell(*y) == cell(*x)).map(|(_, f)| *f).peekable();
            compared += usize::from(same.peek().is_some());
            assert!(same.all(|f| f == *c), "{x:?}");
            inside.push(*c);
        }
        // all but those beyond the slope, where coarse cells that it cuts stick out further
        assert!(compared * 10 > coarse.len() * 9, "{compared} of {}", coarse.len());
        // means over the slope: 4 of 16 cells of the field in each cell of 1 m are sampled
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let all: Vec<f64> = fine.iter().map(|(_, f)| *f).collect();
        let sd = (all.iter().map(|f| (f - mean(&all)).powi(2)).sum::<f64>() / all.len() as f64).sqrt();
        assert!((mean(&inside) - mean(&all)).abs() < 4.0 * sd / (inside.len() as f64).sqrt());
    }
}
