//! A softening layer under shear: what its band dissipates, on finer and finer grids.

use super::{
    Effort, Files, Problem, Report,
    measure::largest,
    reference::Reference,
    setup::{Run, keys},
};
use crate::{
    body::{Column, Group},
    case::{Material, Strength},
    sim::Simulation,
};

/// See the module.
pub struct ShearLayer;

/// Shape functions that are tried.
const SHAPES: [&str; 2] = ["linear", "gimp"];

/// What gives softening a length, if anything.
const REMEDIES: [&str; 3] = ["fracture_energy", "nonlocal", "none"];

impl Problem for ShearLayer {
    fn name(&self) -> &'static str {
        "shear-layer"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/shear-layer/case.toml"),
            reference: include_str!("../../../validation/shear-layer/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for scheme in ["implicit", "explicit"] {
            for shape in SHAPES {
                for remedy in REMEDIES {
                    self.family(Family { scheme, shape, remedy }, effort, reference, report)?;
                }
            }
        }
        Ok(())
    }
}

/// Runs that differ in their cells.
#[derive(Clone, Copy)]
pub(super) struct Family {
    pub scheme: &'static str,
    pub shape: &'static str,
    pub remedy: &'static str,
}

/// What is read at the end of a run.
#[derive(Clone, Copy)]
pub(super) struct Reading {
    /// Energy of softening over that of a band of the reference length.
    pub energy: f64,
    /// (m)
    width: f64,
}

impl Family {
    /// The cells (m). Without a length, only those on which the layer does not snap back.
    fn cells(self, effort: Effort) -> &'static [f64] {
        match (effort, self.scheme, self.remedy) {
            (_, _, "none") | (Effort::Short, "explicit", _) => &[0.25, 0.125],
            (Effort::Full, "implicit", _) => &[0.25, 0.125, 0.0625, 0.03125],
            _ => &[0.25, 0.125, 0.0625],
        }
    }

    /// The answer that the energy on cells of `h` (m) goes with. An average is judged where its length is four cells.
    fn judged_as(self, h: f64) -> &'static str {
        match self.remedy {
            "none" => "drift",
            "nonlocal" if REFERENCE_LENGTH < 4.0 * h => "coarse",
            _ => "energy",
        }
    }
}

impl ShearLayer {
    fn family(&self, f: Family, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let name = format!("{}, {}, {}", f.scheme, f.shape, f.remedy);
        let mut energies = Vec::new();
        for h in f.cells(effort) {
            let found = self.band(f, *h, reference, report)?;
            let setup = format!("{name}, h = {h} m");
            let key = f.judged_as(*h);
            report.row_of(reference, key, &setup, None, found.energy)?;
            report.row_of(reference, "width", &setup, None, found.width)?;
            energies.extend((key == "energy").then_some(found.energy));
        }
        if energies.len() < 2 {
            return Ok(());
        }
        let least = -largest(energies.iter().map(|e| -e));
        report.row_of(reference, "spread", &name, None, largest(energies) / least)
    }

    pub(super) fn band(
        &self,
        f: Family,
        h: f64,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<Reading, String> {
        let set = keys(&[
            ("grid.cell", format!("{h:?}")),
            ("solver.scheme", f.scheme.into()),
            ("solver.shape", f.shape.into()),
            ("material.clay.regularisation", f.remedy.into()),
        ]);
        let mut run = Run::new(self.files().case, &set)?;
        let Some(Material::VonMises { strength, .. }) = run.case.material.get("clay").copied() else {
            return Err("the layer has no strength".to_owned());
        };
        weaken(&mut run.sim, &strength, reference)?;
        start_uniform(&mut run.sim);
        run.until(run.case.end.time, |_| ())?;
        report.count(&run.sim);
        Ok(read(&run.sim, &strength))
    }
}

/// Lowers the strength around one height, so that there is one band, and where it is: c = c0 (1 - a exp(-(y - y0)^2 / b^2)).
/// Soil far from there is too strong to yield. An average at a side of the soil sees one half of a band alone, so
/// that a band there would take half the energy, and be found first.
fn weaken(sim: &mut Simulation, strength: &Strength, reference: &Reference) -> Result<(), String> {
    let given = ["weak_place", "weak_share", "weak_reach", "strong_beyond"].map(|key| reference.given(key));
    let [place, share, reach, beyond] = given;
    let (place, share, reach, beyond) = (place?, share?, reach?, beyond?);
    let y = &sim.body.committed.x[1];
    let weak = |y: &f64| {
        let strong = if (y - place).abs() > beyond { 2.0 } else { 1.0 };
        strong * strength.cohesion * (1.0 - share * (-((y - place) / reach).powi(2)).exp())
    };
    for Group { range, params, law, .. } in &mut sim.body.groups {
        let column = law.params().iter().position(|name| *name == "cohesion");
        if let Some(column) = column.and_then(|k| params.get_mut(k)) {
            *column = Column::Varying(y[range.clone()].iter().map(weak).collect());
        }
    }
    Ok(())
}

/// The thickness of the layer (m), and the velocity of its top (m/s).
const THICKNESS: f64 = 3.0;
const VELOCITY: f64 = 0.006;

/// The motion of uniform shear, so that no wave starts from the top.
fn start_uniform(sim: &mut Simulation) {
    let state = &mut sim.body.committed;
    let [_, y] = &state.x;
    state.v[0].iter_mut().zip(y.iter()).for_each(|(v, y)| *v = VELOCITY * y / THICKNESS);
}

/// With the plastic work W and the plastic slip d = int sqrt(3) eps_p dy, W - c_r d over
/// sqrt(3) l_ref (c0 - c_r)^2 / (2 |H|), per area of the layer.
fn read(sim: &Simulation, strength: &Strength) -> Reading {
    let s = sim.snapshot();
    let sum = |power: i32| -> f64 { (0..s.len()).map(|i| s.initial_volume[i] * s.plastic_strain[i].powi(power)).sum() };
    let volume: f64 = s.initial_volume.iter().sum();
    let area = volume / THICKNESS;
    let slip = 3f64.sqrt() * sum(1) / area;
    let loss = strength.cohesion - strength.residual_cohesion;
    let exact = 3f64.sqrt() * REFERENCE_LENGTH * loss * loss / (2.0 * strength.softening_modulus.abs());
    let energy = (sim.energies().plastic / area - strength.residual_cohesion * slip) / exact;
    Reading { energy, width: sum(1).powi(2) / (sum(2) * area) }
}

/// l_ref of the case (m), also where softening is left as it stands.
const REFERENCE_LENGTH: f64 = 0.5;
