//! From a case to a simulation: every choice is made here, once.

mod band;
mod effects;
pub mod fields;
mod materials;
mod notes;
mod paths;
mod schemes;
pub mod softening;
mod warnings;

pub use fields::{FieldNote, Fields};
pub use notes::{EffectNote, explain};
pub use paths::paths;
pub use warnings::Warning;

use std::fmt;

use fields::Varied;

use crate::{
    block::Law,
    body::{Body, GroupSeed, Seedling},
    case::{self, Case},
    effect::Effect,
    field::model::Drawn,
    math::outline::Outline,
    seed::{CutRule, Seed, Seeding, seed},
    sim::{InSitu, Simulation},
    space::{BSpline, Gimp, GimpWide, Grid, Linear, Shape, gauss},
    step::{Integrator, control::Control, explicit::Explicit, implicit::Implicit},
};

/// A scene that cannot be built, with the key to change.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    pub key: String,
    pub message: String,
    /// Whether the scene is refused because it is too large.
    pub too_large: bool,
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (key `{}`)", self.message, self.key)
    }
}

impl std::error::Error for SceneError {}

fn refuse(key: &str, message: String) -> SceneError {
    SceneError { key: key.to_owned(), message, too_large: false }
}

/// A simulation with what was decided about it.
pub struct Scene {
    pub simulation: Simulation,
    pub grid: Grid,
    /// Every effect, on or off, with the reason.
    pub effects: Vec<EffectNote>,
    /// Cells with points at the start, and those cut by an outline.
    pub cells: u64,
    pub cut_cells: u64,
    /// Names of the materials, by the index that a snapshot gives.
    pub materials: Vec<String>,
    /// What the user should know before the run.
    pub warnings: Vec<Warning>,
    /// The random fields of this realisation.
    pub fields: Vec<FieldNote>,
}

/// Builds the scene of a case, unless it would take more than `max_memory` bytes.
pub fn build(case: &Case, max_memory: u64) -> Result<Scene, SceneError> {
    build_with(case, max_memory, &Fields::of(case)?)
}

/// As [`build`], with the generators of the fields made before: [`Fields::of`] the same case, whatever its
/// realisation.
pub fn build_with(case: &Case, max_memory: u64, fields: &Fields) -> Result<Scene, SceneError> {
    build_reduced(case, max_memory, fields, 1.0)
}

/// As [`build_with`], with all strengths divided by `factor`.
pub fn build_reduced(case: &Case, max_memory: u64, fields: &Fields, factor: f64) -> Result<Scene, SceneError> {
    assemble(case, max_memory, fields, factor, &|_| Vec::new())
}

/// What a study adds to a scene and no case can ask for: it may change the points before the first step, and gives
/// effects that act before those of the case.
pub type Addition<'a> = &'a dyn Fn(&mut Body) -> Vec<Box<dyn Effect>>;

/// As [`build`], with an addition.
pub fn build_adding(case: &Case, max_memory: u64, addition: Addition<'_>) -> Result<Scene, SceneError> {
    assemble(case, max_memory, &Fields::of(case)?, 1.0, addition)
}

fn assemble(
    case: &Case,
    max_memory: u64,
    fields: &Fields,
    factor: f64,
    addition: Addition<'_>,
) -> Result<Scene, SceneError> {
    let need = case.memory_estimate_bytes();
    if need > max_memory {
        return Err(too_large(need, max_memory));
    }
    let grid = grid(&case.grid)?;
    let outlines: Vec<Outline> = case.region.iter().map(|r| r.shape.clone()).collect();
    let seeding = seed(&grid, &outlines, &positions(&case.points), cut_rule(case.points.cut_cells));
    if seeding.points.is_empty() {
        return Err(refuse("region", "no material point lies inside the regions".to_owned()));
    }
    check_inside(&grid, &seeding)?;
    check_regions(case, &seeding)?;
    check_initial_stress(case)?;
    let drawn = fields.draw(case)?;
    let (mut body, limited) = body(case, &outlines, &seeding, &drawn, factor)?;
    let (integrator, control) = integrator(case, grid, &mut body, addition)?;
    let (in_situ, body) = in_situ(case, body);
    let mut simulation = Simulation::new(body, integrator, control, in_situ);
    simulation.work.cells = seeding.cells;
    let mut warnings = warnings::list(case, &mut simulation);
    let notes_on_fields = fields::notes(case, fields, &drawn);
    warnings.extend(warnings::limited(limited));
    warnings.extend(warnings::redrawn(&notes_on_fields));
    Ok(Scene {
        fields: notes_on_fields,
        effects: notes::list(case, &simulation),
        simulation,
        grid,
        cells: seeding.cells,
        cut_cells: seeding.cut_cells,
        materials: case.material.keys().cloned().collect(),
        warnings,
    })
}

fn too_large(need: u64, cap: u64) -> SceneError {
    let gib = |b: u64| b as f64 / f64::from(1u32 << 30);
    SceneError {
        key: "grid.cell".to_owned(),
        message: format!(
            "the case needs about {:.1} GiB but only {:.1} GiB are allowed; use a larger `grid.cell`, a smaller `grid.size`, or raise --max-memory",
            gib(need),
            gib(cap)
        ),
        too_large: true,
    }
}

fn grid(g: &case::Grid) -> Result<Grid, SceneError> {
    // a width that is a whole number of cells up to rounding is not one cell more
    let cells = g.size.map(|length| (length / g.cell - 1e-9).ceil().max(1.0));
    if cells[0] * cells[1] >= 4e9 {
        return Err(refuse("grid.cell", "the grid has more than 4e9 cells".to_owned()));
    }
    Ok(Grid { origin: g.origin, h: g.cell, cells: cells.map(|n| n as u32) })
}

fn positions(points: &case::Points) -> Vec<f64> {
    match points.layout {
        case::Layout::Gauss => gauss::gauss(points.per_axis),
        case::Layout::Even => gauss::even(points.per_axis),
    }
}

fn cut_rule(rule: case::CutCells) -> CutRule {
    match rule {
        case::CutCells::Full => CutRule::Full,
        case::CutCells::Inside => CutRule::Inside,
        case::CutCells::Scaled => CutRule::Scaled,
    }
}

fn check_inside(grid: &Grid, seeding: &Seeding) -> Result<(), SceneError> {
    match seeding.points.iter().find(|p| !grid.contains(p.x)) {
        None => Ok(()),
        Some(p) => {
            Err(refuse("grid.size", format!("a material point at ({}, {}) m lies outside the grid", p.x[0], p.x[1])))
        }
    }
}

/// A region that no point represents would be missing without a word.
fn check_regions(case: &Case, seeding: &Seeding) -> Result<(), SceneError> {
    let empty = |k: &usize| !seeding.points.iter().any(|p| p.region == *k);
    match (0..case.region.len()).find(empty) {
        None => Ok(()),
        Some(k) => {
            let name = &case.region[k].name;
            Err(refuse(
                "grid.cell",
                format!("region `{name}` is too thin to hold a material point; use smaller cells or more points"),
            ))
        }
    }
}

/// A K0 stress balances full gravity straight down, and nothing else.
fn check_initial_stress(case: &Case) -> Result<(), SceneError> {
    let is_k0 = matches!(case.initial_stress, case::InitialStress::K0 { .. });
    if is_k0 && case.gravity.schedule != case::GravitySchedule::AtOnce {
        return Err(refuse(
            "gravity.schedule",
            "a k0 stress balances full gravity: it needs schedule = \"at_once\"".to_owned(),
        ));
    }
    if is_k0 && case.gravity.tilt != 0.0 {
        return Err(refuse("gravity.tilt", "a k0 stress is for level ground: it needs tilt = 0".to_owned()));
    }
    Ok(())
}

/// The integrator that the case asks for, with the control of its steps; the body is made ready
/// for its shape functions.
fn integrator(
    case: &Case,
    grid: Grid,
    body: &mut Body,
    addition: Addition<'_>,
) -> Result<(Box<dyn Integrator>, Control), SceneError> {
    match case.solver.shape {
        case::ShapeFunctions::Linear => with_shape(case, Linear, grid, body, addition),
        case::ShapeFunctions::Gimp => with_shape(case, Gimp, grid, body, addition),
        case::ShapeFunctions::GimpWide => with_shape(case, GimpWide, grid, body, addition),
        case::ShapeFunctions::Bspline => with_shape(case, BSpline, grid, body, addition),
    }
}

fn with_shape<S: Shape<N>, const N: usize>(
    case: &Case,
    shape: S,
    grid: Grid,
    body: &mut Body,
    addition: Addition<'_>,
) -> Result<(Box<dyn Integrator>, Control), SceneError> {
    prepare::<S, N>(grid, body)?;
    let mut effects = addition(body);
    effects.extend(effects::build(case, &grid, body)?);
    let averages = softening::averages(case, body);
    Ok(match case.solver.scheme {
        case::Scheme::Explicit => {
            let mut explicit = Explicit::new(shape, grid, schemes::explicit(case), effects);
            explicit.in_parts(body);
            if !averages.is_empty() {
                explicit.soften_by(body, averages);
            }
            (Box::new(explicit), Control::new(case.explicit.time_step))
        }
        case::Scheme::Implicit => {
            let mut implicit = Implicit::new(shape, grid, schemes::implicit(case, body), effects);
            if !averages.is_empty() {
                implicit.soften_by(body, averages);
            }
            (Box::new(implicit), schemes::control(&case.implicit))
        }
    })
}

/// Refuses a grid on which a patch has no room, and gives the points of shapes with domains what
/// these need.
fn prepare<S: Shape<N>, const N: usize>(grid: Grid, body: &mut Body) -> Result<(), SceneError> {
    let least = S::SPAN - 1;
    if grid.cells.iter().any(|&n| n < least) {
        let [x, y] = grid.cells;
        let message = format!(
            "solver.shape = \"{}\" needs a grid of at least {least} cells along x and y, and this one has {x} x {y}; make `grid.size` larger (the soil may stay as it is)",
            S::NAME
        );
        return Err(refuse("grid.size", message));
    }
    if S::DOMAIN {
        body.track_domains();
    }
    // points are seeded in the order of the cells
    if S::order(&grid) != grid {
        body.sort(&S::order(&grid));
    }
    Ok(())
}

/// One group of points for each material, in the order of the materials' names, strengths divided by `factor`;
/// with the number of parameter values that stopped at a limit.
fn body(
    case: &Case,
    outlines: &[Outline],
    seeding: &Seeding,
    drawn: &[Drawn],
    factor: f64,
) -> Result<(Body, u64), SceneError> {
    let (mut groups, mut gradients) = (Vec::new(), Vec::new());
    let (mut first, mut limited) = (0, 0);
    for (index, (name, material)) in case.material.iter().enumerate() {
        let seeds: Vec<&Seed> = seeding.points.iter().filter(|s| &case.region[s.region].material == name).collect();
        let Some(varied) = Varied::new(case, name, drawn).filter(|_| !seeds.is_empty()) else { continue };
        let (points, stopped): (Vec<case::Material>, Vec<u64>) = seeds.iter().map(|s| varied.at(s.x)).unzip();
        limited += stopped.iter().sum::<u64>();
        let mut params = materials::columns(case, &points, first)?;
        materials::reduce(material, &mut params, factor);
        groups.push(GroupSeed {
            material: index as u16,
            law: materials::law(material, case.solver.kinematics),
            params,
            points: seeds.iter().zip(&points).map(|(s, m)| seedling(case, outlines, s, m)).collect(),
        });
        gradients.extend(seeds.iter().map(|s| velocity_gradient(&case.region[s.region], s.x)));
        first += seeds.len();
    }
    let mut body = Body::new(groups);
    if case.solver.transfer == case::Transfer::Apic {
        body.track_affine(&gradients);
    }
    Ok((body, limited))
}

fn seedling(case: &Case, outlines: &[Outline], seed: &Seed, material: &case::Material) -> Seedling {
    let density = material.elastic().unit_weight / case.gravity.acceleration;
    Seedling {
        x: seed.x,
        v: initial_velocity(&case.region[seed.region], seed.x),
        mass: density * seed.volume,
        volume: seed.volume,
        stress: materials::initial_stress(case, outlines, seed.x),
    }
}

fn initial_velocity(region: &case::Region, x: [f64; 2]) -> [f64; 2] {
    let mut v = region.velocity;
    if let Some(spin) = &region.spin {
        v[0] -= spin.rate * (x[1] - spin.center[1]);
        v[1] += spin.rate * (x[0] - spin.center[0]);
    }
    if let Some(wave) = &region.wave {
        let phase = (wave.wave_number[0] * x[0] + wave.wave_number[1] * x[1]).sin();
        v[0] += wave.amplitude[0] * phase;
        v[1] += wave.amplitude[1] * phase;
    }
    v
}

/// Gradient of [`initial_velocity`] (1/s): xx, xy, yx, yy.
fn velocity_gradient(region: &case::Region, x: [f64; 2]) -> [f64; 4] {
    let mut c = [0.0; 4];
    if let Some(spin) = &region.spin {
        c[1] -= spin.rate;
        c[2] += spin.rate;
    }
    if let Some(wave) = &region.wave {
        let [k, l] = wave.wave_number;
        let slope = (k * x[0] + l * x[1]).cos();
        for row in 0..2 {
            c[2 * row] += wave.amplitude[row] * k * slope;
            c[2 * row + 1] += wave.amplitude[row] * l * slope;
        }
    }
    c
}

/// Length of an elastic in-situ phase (s); 0 without one.
fn settling_time(case: &Case) -> f64 {
    match case.gravity.schedule {
        case::GravitySchedule::ElasticFirst { ramp_time, settle_time, .. } => ramp_time + settle_time,
        _ => 0.0,
    }
}

/// Puts elastic laws in the place of the real ones where an in-situ phase comes first.
fn in_situ(case: &Case, mut body: Body) -> (Option<InSitu>, Body) {
    let until = settling_time(case);
    if until <= 0.0 {
        return (None, body);
    }
    let swap = |group: &mut crate::body::Group| -> Box<dyn Law> {
        std::mem::replace(&mut group.law, materials::elastic_stand_in(case.solver.kinematics))
    };
    let laws = body.groups.iter_mut().map(swap).collect();
    (Some(InSitu { until, laws }), body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_too_narrow_for_a_patch_is_refused() {
        let bar = include_str!("../../validation/vibrating-bar/case.toml");
        for (shape, least) in [("gimp", 2), ("gimp_wide", 3), ("bspline", 2)] {
            let build_on = |rows: u32| {
                let keys = [format!("solver.shape={shape}"), format!("grid.size=[26, {rows}]")];
                let (case, _) = case::read("bar", bar, &keys).expect("a valid case");
                build(&case, u64::MAX)
            };
            let refused = build_on(least - 1).err().expect("too narrow");
            assert_eq!(refused.key, "grid.size");
            assert!(refused.message.contains(&format!("at least {least} cells")), "{refused}");
            assert!(build_on(least).is_ok());
        }
    }
}
