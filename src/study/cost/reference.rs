//! What errors are measured against: an exact value, else the limit of a ladder of meshes, else the finest run.
//!
//! Rate and limit are those of the finest three meshes (`math::stats::richardson`). The rate is clean where the
//! differences have one sign and it lies in [`RATES`].

use std::collections::BTreeMap;

use serde::Serialize;

use super::setting::Setting;
use crate::math::stats::richardson::{self, RATES};

/// Where the reference comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Basis {
    /// The exact value of a probe.
    Exact,
    /// The limit of a ladder of meshes with a clean rate.
    Richardson,
    /// The run with the smallest cells and, among these, the most steps; its own error is known by other runs alone.
    FinestRun,
}

/// The value that errors are measured against.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reference {
    pub basis: Basis,
    pub value: f64,
    /// How well it is known, in the unit of the quantity; `None`: not known.
    pub uncertainty: Option<f64>,
    /// In words.
    pub source: String,
    /// The setting of the finest run, where that is the reference.
    pub setting: Option<String>,
}

impl Reference {
    /// |value - reference| over |reference|; over 1 in its unit where the reference is 0.
    pub fn error(&self, value: f64) -> f64 {
        (value - self.value).abs() / self.scale()
    }

    /// The uncertainty as an error.
    pub fn floor(&self) -> Option<f64> {
        self.uncertainty.map(|u| u / self.scale())
    }

    /// Whether errors are shares of the reference.
    pub fn is_relative(&self) -> bool {
        self.value != 0.0
    }

    fn scale(&self) -> f64 {
        if self.is_relative() { self.value.abs() } else { 1.0 }
    }
}

/// Meshes that differ in the cell size alone, from the coarsest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ladder {
    pub setting: String,
    pub cells_m: Vec<f64>,
    pub values: Vec<f64>,
    /// p of the finest three; `None` where they show none.
    pub order: Option<f64>,
    /// The limit, where the rate is clean.
    pub limit: Option<f64>,
    /// Whether no other ladder of three meshes has a finer time step, and all else alike.
    pub finest_step: bool,
}

/// A setting with the value that it gave.
pub struct Point<'a> {
    pub setting: &'a Setting,
    pub value: f64,
    /// Steps taken.
    pub steps: u64,
}

/// The ladders of at least two meshes.
pub fn ladders(points: &[Point<'_>]) -> Vec<Ladder> {
    let mut by_name: BTreeMap<String, Vec<&Point<'_>>> = BTreeMap::new();
    for p in points {
        by_name.entry(p.setting.ladder()).or_default().push(p);
    }
    // in the order of the settings, not of the names
    let mut found: Vec<Vec<&Point<'_>>> = by_name.into_values().filter(|ladder| ladder.len() > 1).collect();
    found.sort_by_key(|ladder| points.iter().position(|p| std::ptr::eq(p, ladder[0])));
    // finer steps on fewer meshes give no limit in their place
    let whole: Vec<&Point<'_>> = found.iter().filter(|ladder| ladder.len() > 2).flatten().copied().collect();
    found.iter().map(|ladder| one(ladder, &whole)).collect()
}

/// One ladder, beside the points of all that have three meshes.
fn one(ladder: &[&Point<'_>], whole: &[&Point<'_>]) -> Ladder {
    let mut steps = ladder.to_vec();
    steps.sort_by(|a, b| b.setting.case.grid.cell.total_cmp(&a.setting.case.grid.cell));
    let cells: Vec<f64> = steps.iter().map(|p| p.setting.case.grid.cell).collect();
    let values: Vec<f64> = steps.iter().map(|p| p.value).collect();
    let order = finest(&cells).zip(finest(&values)).and_then(|(h, v)| richardson::order(h, v));
    let coarser = |p: &Point<'_>| whole.iter().any(|q| q.setting.refines(p.setting) && same_mesh(p, q));
    Ladder {
        setting: steps[0].setting.ladder(),
        order,
        limit: order.and_then(|p| limit(&cells, &values, p)),
        finest_step: !ladder.iter().any(|p| coarser(p)),
        cells_m: cells,
        values,
    }
}

fn same_mesh(a: &Point<'_>, b: &Point<'_>) -> bool {
    let mesh = |p: &Point<'_>| (p.setting.case.grid.cell, p.setting.case.points.per_axis);
    mesh(a) == mesh(b)
}

/// The finest three of a list.
fn finest(list: &[f64]) -> Option<&[f64; 3]> {
    list.last_chunk()
}

/// The limit, where the rate is clean.
fn limit(cells: &[f64], values: &[f64], order: f64) -> Option<f64> {
    let clean = (RATES[0]..=RATES[1]).contains(&order);
    clean.then(|| richardson::limit(cells, values, order)).flatten()
}

/// The reference of a study; `None` where no run gave a value.
pub fn reference(exact: Option<(f64, String)>, ladders: &[Ladder], points: &[Point<'_>]) -> Option<Reference> {
    if let Some((value, source)) = exact {
        let source = format!("exact value of the case ({source})");
        return Some(Reference { basis: Basis::Exact, value, uncertainty: Some(0.0), source, setting: None });
    }
    richardson(ladders).or_else(|| finest_run(ladders, points))
}

/// Of the clean ladders with the finest steps the one whose finest run is nearest to its limit. How far the limits
/// of the others lie from it tells how well it is known; with no other, how far the limit lies from the finest run.
fn richardson(ladders: &[Ladder]) -> Option<Reference> {
    let clean: Vec<(&Ladder, f64)> =
        ladders.iter().filter(|l| l.finest_step).filter_map(|l| Some((l, l.limit?))).collect();
    let gap = |(l, limit): &(&Ladder, f64)| l.values.last().map_or(f64::INFINITY, |v| (limit - v).abs());
    let chosen = clean.iter().min_by(|a, b| gap(a).total_cmp(&gap(b)))?;
    let spread = clean.iter().map(|(_, limit)| (limit - chosen.1).abs()).fold(0.0, f64::max);
    let order = chosen.0.order.unwrap_or(f64::NAN);
    let source = format!(
        "Richardson limit of \"{}\" (order {order:.2}); {} clean ladder(s) with the finest steps",
        chosen.0.setting,
        clean.len()
    );
    let uncertainty = Some(if clean.len() > 1 { spread } else { gap(chosen) });
    Some(Reference { basis: Basis::Richardson, value: chosen.1, uncertainty, source, setting: None })
}

fn finest_run(ladders: &[Ladder], points: &[Point<'_>]) -> Option<Reference> {
    let cell = |p: &Point<'_>| p.setting.case.grid.cell;
    let mut order: Vec<&Point<'_>> = points.iter().collect();
    order.sort_by(|a, b| cell(a).total_cmp(&cell(b)).then(b.steps.cmp(&a.steps)));
    let (point, others) = order.split_first()?;
    let label = point.setting.label();
    Some(Reference {
        basis: Basis::FinestRun,
        value: point.value,
        uncertainty: doubt(point, others, ladders),
        source: format!("finest run, {label}: what its own error is can only be guessed from the other runs"),
        setting: Some(label),
    })
}

/// How far the finest run may be off: by how much it misses the limits of clean ladders. With none, how far the next
/// finest run lies from it, or the next coarser one of its own ladder, as two of one mesh tell little; `None` where
/// there is no other run.
fn doubt(finest: &Point<'_>, others: &[&Point<'_>], ladders: &[Ladder]) -> Option<f64> {
    let far = |value: f64| (value - finest.value).abs();
    let limits = ladders.iter().filter_map(|l| l.limit).map(far).reduce(f64::max);
    let own = others.iter().find(|p| p.setting.ladder() == finest.setting.ladder());
    let next = others.first().into_iter().chain(own).map(|p| far(p.value));
    limits.or_else(|| next.reduce(f64::max))
}
