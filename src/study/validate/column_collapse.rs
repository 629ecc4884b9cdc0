//! A column of clay, H high and 2 L wide, on a smooth base; one half of it, up to the plane of symmetry.
//!
//! With the load N = g H / c (g the unit weight) it stands for N < 2, where s_yy = -g (H - y) and no other stress is
//! a field in equilibrium that nowhere yields. It fails, for H > L, for
//! ```text
//! N > 2 / (1 - L / 2 H)
//! ```
//! as the triangle below the plane from (0, 0) to (L, L) is pushed out along the base and all above it sinks:
//! g (H L - L^2 / 2) v = c sqrt(2) v sqrt(2) L. A wider one fails for N > 4, along a plane at 45 degrees through its toe.
//!
//! How far it flows has no exact answer that we know of: run-outs of both schemes stand side by side.

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    limit::last_equilibrium,
    measure::largest,
    reference::Reference,
    setup::{Run, keys, rectangle},
};

/// See the module.
pub struct ColumnCollapse;

/// H / L.
const ASPECTS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];

impl Problem for ColumnCollapse {
    fn name(&self) -> &'static str {
        "column-collapse"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/column-collapse/case.toml"),
            reference: include_str!("../../../validation/column-collapse/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let fine = if effort == Effort::Full { 2 } else { 1 };
        for aspect in ASPECTS {
            // eight cells over half of the width, and no less than sixteen over the height
            let rows = fine * (8.0 * aspect).max(16.0) as u32;
            self.limit(Column { aspect, rows }, reference, report)?;
        }
        for aspect in [1.0, 2.0] {
            for scheme in ["explicit", "implicit"] {
                self.stands_and_falls(Column { aspect, rows: 8 * fine }, scheme, reference, report)?;
            }
        }
        self.runouts(effort, reference, report)
    }
}

#[derive(Clone, Copy)]
struct Column {
    aspect: f64,
    /// Cells over the height.
    rows: u32,
}

impl Column {
    /// L (m); H is 1 m.
    fn half_width(self) -> f64 {
        1.0 / self.aspect
    }

    /// Smallest load of a mechanism.
    fn upper(self) -> f64 {
        if self.aspect > 1.0 { 2.0 / (1.0 - 0.5 * self.half_width()) } else { 4.0 }
    }

    fn name(self) -> String {
        format!("H / L = {}, H / h = {}", self.aspect, self.rows)
    }

    /// The column under the load N on a grid that reaches `room` (m) beyond it.
    fn keys(self, load: f64, room: f64) -> Vec<String> {
        let width = self.half_width();
        keys(&[
            ("grid.cell", format!("{:?}", 1.0 / f64::from(self.rows))),
            ("grid.size", format!("[{:?}, 1.0]", width + room)),
            ("material.clay.unit_weight", format!("{load:?}")),
            ("region.column.polygon", rectangle([0.0, 0.0], [width, 1.0])),
        ])
    }
}

impl ColumnCollapse {
    /// Load at which equilibrium is lost, in small strain and without inertia.
    fn limit(&self, column: Column, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let most = 5.0;
        let mut set = column.keys(most, 0.25);
        set.extend(keys(&[
            ("solver.scheme", "implicit".into()),
            ("solver.kinematics", "small".into()),
            ("solver.shape", "linear".into()),
            ("solver.locking", "b_bar".into()),
            ("implicit.regime", "quasi_static".into()),
            ("material.clay.poisson_ratio", "0.49".into()),
            ("gravity.ramp_time", "1.0".into()),
            ("end.time", "1.0".into()),
        ]));
        let mut run = Run::new(self.files().case, &set)?;
        let bracket = last_equilibrium(&mut run)?.ok_or("the column stands under any load")?;
        report.count(&run.sim);
        let load = most * bracket.middle();
        report.row_of(reference, "lower", &column.name(), Some(2.0), load)?;
        report.row_of(reference, "upper", &column.name(), Some(column.upper()), load)
    }

    /// In finite strain, under a load that grows slowly to a tenth below the lower and a quarter above the upper bound.
    fn stands_and_falls(
        &self,
        column: Column,
        scheme: &str,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        let name = format!("H / L = {}, {scheme}", column.aspect);
        for (key, load) in [("stands", 1.8), ("falls", 1.25 * column.upper())] {
            let mut set = column.keys(load, 1.0);
            set.extend(keys(&[("solver.scheme", scheme.into())]));
            let mut run = Run::new(self.files().case, &set)?;
            run.until(run.case.end.time, |_| ())?;
            report.count(&run.sim);
            report.row_of(reference, key, &name, None, runout(&run, column))?;
        }
        Ok(())
    }

    /// Sudden release under N = 6.
    fn runouts(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let (aspects, rows): (&[f64], u32) = match effort {
            Effort::Short => (&[1.0, 2.0], 8),
            Effort::Full => (&ASPECTS, 16),
        };
        let load = reference.given("load")?;
        let mut lines: Vec<(&str, Vec<(f64, f64)>)> = vec![("explicit", Vec::new()), ("implicit", Vec::new())];
        for &aspect in aspects {
            let column = Column { aspect, rows };
            for (scheme, line) in &mut lines {
                let mut set = column.keys(load, reference.given("room")?);
                set.extend(keys(&[("solver.scheme", (*scheme).into()), ("gravity.schedule", "at_once".into())]));
                let mut run = Run::new(self.files().case, &set)?;
                run.until(run.case.end.time, |_| ())?;
                report.count(&run.sim);
                let name = format!("{}, {scheme}", column.name());
                line.push((aspect, runout(&run, column)));
                let top = largest(run.sim.snapshot().position.iter().map(|x| x[1]));
                let energies = run.sim.energies();
                report.row_of(reference, "runout", &name, None, runout(&run, column))?;
                report.row_of(reference, "height", &name, None, top * load)?;
                report.row_of(reference, "moving", &name, None, energies.kinetic / energies.dissipated)?;
                report.row_of(reference, "numerical", &name, None, energies.numerical / energies.external)?;
            }
        }
        let mut figure = Figure::new(
            &format!("Run-out of a clay column released under g H / c = {load}"),
            "the largest way of a point along the smooth base, by both schemes",
            "H / L",
            "(x - L) / H",
        );
        for (scheme, line) in lines {
            figure = figure.with(scheme, Kind::Marked, line);
        }
        report.figure(figure);
        Ok(())
    }
}

/// Way of the farthest point beyond the toe, over H; a point stands for half of its width more, as at the start.
fn runout(run: &Run, column: Column) -> f64 {
    let s = run.sim.snapshot();
    let inset = column.half_width() - largest(s.reference.iter().map(|x| x[0]));
    largest(s.position.iter().map(|x| x[0])) + inset - column.half_width()
}
