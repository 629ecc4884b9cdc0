//! Stress behind a slope that still stands.
//!
//! Soil that is laterally confined carries the weight above it, whatever its stiffness:
//! sigma_yy = -gamma z with z the depth in the reference position, since mass stays above it, and
//! sigma_xx = nu/(1-nu) sigma_yy in small strain.

use std::collections::BTreeMap;

use super::{
    Effort, Files, Problem, Report,
    measure::{largest, mean},
    reference::Reference,
    setup::{Run, keys, rectangle},
};
use crate::{
    case::{GravitySchedule, Material},
    snapshot::Snapshot,
};

/// See the module.
pub struct InSitu;

impl Problem for InSitu {
    fn name(&self) -> &'static str {
        "in-situ"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/in-situ/case.toml"),
            reference: include_str!("../../../validation/in-situ/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        self.elastic("gauss", reference, report)?;
        self.ramp(reference, report)?;
        self.confined(reference, report)?;
        if effort == Effort::Full {
            self.elastic("even", reference, report)?;
        }
        Ok(())
    }
}

impl InSitu {
    /// Full gravity on the elastic slope, to the end of its settling.
    fn elastic(&self, layout: &str, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let set = [("gravity.schedule", "elastic_first".to_owned()), ("points.layout", layout.to_owned())];
        let mut run = Run::new(self.files().case, &keys(&set))?;
        let before = run.sim.snapshot();
        settle(&mut run)?;
        report.count(&run.sim);
        let after = run.sim.snapshot();
        let name = format!("full gravity, elastic, {layout} points");
        Column::read(&run, reference, &before, &after, 1.0)?.rows(&name, reference, report)
    }

    /// A smooth column of the same height between rollers: K0 point by point.
    fn confined(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let height = reference.given("height")?;
        let set = keys(&[
            ("gravity.schedule", "elastic_first".into()),
            // local damping looks at the sign of a velocity, also of one that is rounding
            ("gravity.settle_damping", "0.0".into()),
            ("grid.size", format!("[1.0, {:?}]", height + 2.0)),
            ("boundary.right", "roller".into()),
            ("boundary.base", "roller".into()),
            ("region.slope.polygon", rectangle([0.0, 0.0], [1.0, height])),
        ]);
        let mut run = Run::new(self.files().case, &set)?;
        settle(&mut run)?;
        report.count(&run.sim);
        let k0 = k0(&run)?.0;
        let apart = run.sim.snapshot().stress.into_iter().map(|s| (s.xx / (k0 * s.yy) - 1.0).abs());
        report.row(reference, "ratio", largest(apart))
    }

    /// Halfway up the ramp.
    fn ramp(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let mut run = Run::new(self.files().case, &[])?;
        let before = run.sim.snapshot();
        run.until(reference.given("look")?, |_| ())?;
        report.count(&run.sim);
        let after = run.sim.snapshot();
        let share = reference.given("share")?;
        Column::read(&run, reference, &before, &after, share)?.rows("half gravity on the ramp", reference, report)?;
        let quiet = reference.given("quiet")?;
        let yielded =
            (0..after.len()).filter(|&i| before.position[i][0] < quiet && after.plastic_strain[i] > 0.0).count();
        report.row(reference, "yielded", yielded as f64)
    }
}

/// Runs an elastic in-situ phase to its end.
fn settle(run: &mut Run) -> Result<(), String> {
    match run.case.gravity.schedule {
        GravitySchedule::ElasticFirst { ramp_time, settle_time, .. } => run.until(ramp_time + settle_time, |_| ()),
        _ => Err("gravity.schedule is not elastic_first".into()),
    }
}

/// nu / (1 - nu), and the unit weight (kN/m3), of the clay.
fn k0(run: &Run) -> Result<(f64, f64), String> {
    let elastic = run.case.material.get("clay").map(Material::elastic).ok_or("there is no clay")?;
    Ok((elastic.poisson_ratio / (1.0 - elastic.poisson_ratio), elastic.unit_weight))
}

/// One row of points: those with the same height at the start.
struct RowOfPoints {
    /// Mean of sigma / exact - 1.
    yy: f64,
    xx: f64,
    /// Cell at the start and now.
    cell: i64,
    cell_now: i64,
}

/// The rows behind the slope, from the base up.
struct Column {
    rows: Vec<RowOfPoints>,
}

impl Column {
    /// Rows of the columns between `from` and `to`, save those within `skin` of the surface.
    /// `share` is the share of gravity that acts.
    fn read(run: &Run, reference: &Reference, before: &Snapshot, after: &Snapshot, share: f64) -> Result<Self, String> {
        let (from, to) = (reference.given("from")?, reference.given("to")?);
        let (top, skin) = (reference.given("height")?, reference.given("skin")?);
        let (k0, unit_weight) = k0(run)?;
        let mut rows: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
        for (i, x) in before.position.iter().enumerate() {
            if x[0] > from && x[0] < to && x[1] < top - skin {
                rows.entry((x[1] * 1e6).round() as i64).or_default().push(i);
            }
        }
        let cell = |y: f64| (y / run.grid.h).floor() as i64;
        let row = |points: Vec<usize>| {
            let y = before.position[points[0]][1];
            let exact = -unit_weight * share * (top - y);
            RowOfPoints {
                yy: mean(points.iter().map(|&i| after.stress[i].yy)) / exact - 1.0,
                xx: mean(points.iter().map(|&i| after.stress[i].xx)) / (k0 * exact) - 1.0,
                cell: cell(y),
                cell_now: cell(mean(points.iter().map(|&i| after.position[i][1]))),
            }
        };
        Ok(Column { rows: rows.into_values().map(row).collect() })
    }

    /// Cells that a row has left or entered: they hold one row too few or too many.
    fn disturbed(&self) -> Vec<i64> {
        self.rows.iter().filter(|r| r.cell != r.cell_now).flat_map(|r| [r.cell, r.cell_now]).collect()
    }

    fn rows(&self, name: &str, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let disturbed = self.disturbed();
        let quiet = self.rows.iter().filter(|r| !disturbed.contains(&r.cell_now));
        report.row_of(reference, "mean_yy", name, None, mean(self.rows.iter().map(|r| r.yy.abs())))?;
        report.row_of(reference, "elsewhere_yy", name, None, largest(quiet.map(|r| r.yy.abs())))?;
        report.row_of(reference, "worst_yy", name, None, largest(self.rows.iter().map(|r| r.yy.abs())))?;
        report.row_of(reference, "mean_xx", name, None, mean(self.rows.iter().map(|r| r.xx.abs())))?;
        report.row_of(reference, "worst_xx", name, None, largest(self.rows.iter().map(|r| r.xx.abs())))?;
        let crossed = self.rows.iter().filter(|r| r.cell != r.cell_now).count();
        report.row_of(reference, "crossed", &format!("{name}, of {}", self.rows.len()), None, crossed as f64)?;
        Ok(())
    }
}
