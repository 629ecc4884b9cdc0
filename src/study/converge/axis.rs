//! What a ladder refines, and the usual levels of each.

use serde::Serialize;

use crate::{
    case::{Case, Scheme},
    study::{digits::figure, variant::Variant},
};

/// What a ladder refines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// `grid.cell`.
    Mesh,
    /// `points.per_axis`.
    Points,
    /// `explicit.courant` or a fixed `explicit.time_step`; `implicit.time_step` with its bounds.
    TimeStep,
}

/// Variants of a case that differ in one of these alone.
#[derive(Clone, Debug)]
pub struct Plan {
    pub axis: Axis,
    pub levels: Vec<Variant>,
}

impl Axis {
    /// The number that falls as a case is refined: the cell size (m), the spacing of points (m), the time step (s) or
    /// the Courant number.
    pub fn size(self, case: &Case) -> f64 {
        match self {
            Axis::Mesh => case.grid.cell,
            Axis::Points => case.grid.cell / case.points.per_axis as f64,
            Axis::TimeStep => time_step(case).1,
        }
    }

    /// Symbol and unit of the size; no unit for a pure number.
    pub fn symbol(self, case: &Case) -> (&'static str, &'static str) {
        match self {
            Axis::Mesh => ("h", "m"),
            Axis::Points => ("spacing", "m"),
            Axis::TimeStep => time_step(case).2,
        }
    }

    /// What it is called.
    pub fn words(self) -> &'static str {
        match self {
            Axis::Mesh => "cell size",
            Axis::Points => "points per cell",
            Axis::TimeStep => "time step",
        }
    }

    /// The case with a value of the key, as text of the case file.
    pub fn level(self, case: &Case, value: &str) -> Variant {
        let per_axis = case.points.per_axis;
        match self {
            Axis::Mesh => Variant {
                label: mesh_label(&value.parse().map_or(value.to_owned(), figure), per_axis),
                overrides: vec![format!("grid.cell={value}")],
            },
            Axis::Points => Variant {
                label: mesh_label(&figure(case.grid.cell), value.parse().unwrap_or(per_axis)),
                overrides: vec![format!("points.per_axis={value}")],
            },
            Axis::TimeStep => Variant::of(time_step(case).0, value),
        }
    }

    /// h, h/2, h/4; n, n + 1, n + 2 an axis; the usual time steps.
    ///
    /// # Errors
    /// The time steps of the case are chosen by an error.
    pub fn usual(self, case: &Case) -> Result<Plan, String> {
        let halves = [1.0, 0.5, 0.25];
        let per_axis = case.points.per_axis;
        let level = |value: f64| self.level(case, &format!("{value:?}"));
        let levels = match self {
            Axis::Mesh => halves.map(|f| level(f * case.grid.cell)).to_vec(),
            Axis::Points => (per_axis..per_axis + 3).map(|n| self.level(case, &n.to_string())).collect(),
            Axis::TimeStep => return usual_steps(case),
        };
        Ok(Plan { axis: self, levels })
    }
}

/// The mesh of the case and 20/29 of it (0.25 and 5/29 m for the paper's slope), and twice the points on each axis
/// (16 for 4 per cell), as in Fig. 5 of the paper.
pub fn paper(case: &Case) -> [Plan; 2] {
    let (h, n) = (case.grid.cell, case.points.per_axis);
    let meshes = [h, h * 20.0 / 29.0].map(|h| Axis::Mesh.level(case, &format!("{h:?}")));
    let points = [n, 2 * n].map(|n| Axis::Points.level(case, &n.to_string()));
    [Plan { axis: Axis::Mesh, levels: meshes.to_vec() }, Plan { axis: Axis::Points, levels: points.to_vec() }]
}

/// Twice the Courant number of the case, itself and half of it, where twice is stable for sure; else it and its
/// halves, as for a fixed step. In the implicit scheme the bounds of the step go with it.
fn usual_steps(case: &Case) -> Result<Plan, String> {
    let (key, size, _) = time_step(case);
    let i = &case.implicit;
    if case.solver.scheme == Scheme::Implicit && i.tolerance.is_some() {
        return Err("implicit.tolerance chooses the time step; refine it with --vary implicit.tolerance=...".to_owned());
    }
    let first = if key == "explicit.courant" && size <= 0.25 { 2.0 } else { 1.0 };
    let level = |factor: f64| {
        let mut level = Axis::TimeStep.level(case, &format!("{:?}", factor * size));
        level.label = format!("{} = {}", key.rsplit('.').next().unwrap_or(key), figure(factor * size));
        if case.solver.scheme == Scheme::Implicit {
            level.overrides.push(format!("implicit.min_time_step={:?}", factor * i.min_time_step));
            level.overrides.push(format!("implicit.max_time_step={:?}", factor * i.max_time_step));
        }
        level
    };
    Ok(Plan { axis: Axis::TimeStep, levels: [1.0, 0.5, 0.25].map(|f| level(first * f)).to_vec() })
}

/// Key of the time step, its value, and symbol and unit.
fn time_step(case: &Case) -> (&'static str, f64, (&'static str, &'static str)) {
    match (case.solver.scheme, case.explicit.time_step) {
        (Scheme::Implicit, _) => ("implicit.time_step", case.implicit.time_step, ("dt", "s")),
        (Scheme::Explicit, Some(step)) => ("explicit.time_step", step, ("dt", "s")),
        (Scheme::Explicit, None) => ("explicit.courant", case.explicit.courant, ("courant", "")),
    }
}

fn mesh_label(cell: &str, per_axis: usize) -> String {
    format!("h = {cell} m, {} points", per_axis.saturating_mul(per_axis))
}
