//! Soil that keeps its volume: bilinear cells lock.

use std::f64::consts::PI;

use super::super::{
    cook::{self, Cook},
    incompressible::{self, Incompressible},
    prandtl::{self, Prandtl},
    remedy::Bench,
};

pub(super) fn play(bench: &mut Bench<'_>) -> Result<(), String> {
    settlement(bench)?;
    tip(bench)?;
    footing(bench)
}

fn line(bench: &mut Bench<'_>, scheme: &str, figure: &str, plain: f64, cured: f64) -> Result<(), String> {
    bench.helps(["near incompressibility", "b_bar", scheme, figure], plain, cured)
}

/// A block with nu = 0.499 under its own weight, beside the implicit scheme with half the cells.
fn settlement(bench: &mut Bench<'_>) -> Result<(), String> {
    let cured = incompressible::Setup { ratio: 0.499, h: 0.5, locking: "b_bar" };
    let plain = incompressible::Setup { locking: "none", ..cured };
    let fine = incompressible::Setup { h: 0.25, ..cured };
    for scheme in ["explicit", "implicit"] {
        let [fine, plain, cured] = bench.aside(&Incompressible, |_, report| {
            let mut settle = |setup, scheme| Ok::<_, String>(Incompressible.softly(setup, scheme, report)?.settlement);
            Ok([settle(fine, "implicit")?, settle(plain, scheme)?, settle(cured, scheme)?])
        })?;
        let error = |ours: f64| (ours / fine - 1.0).abs();
        line(bench, scheme, "settlement, error", error(plain), error(cured))?;
    }
    Ok(())
}

fn tip(bench: &mut Bench<'_>) -> Result<(), String> {
    let (plain, cured) = bench.aside(&Cook, |reference, report| {
        let exact = reference.exact("tip")?;
        let cured = cook::Setup { h: 2.0, ..cook::Setup::CURED };
        let mut error = |setup| Ok::<_, String>((Cook.panel(setup, "coarse", reference, report)? / exact - 1.0).abs());
        Ok((error(cook::Setup { locking: "none", ..cured })?, error(cured)?))
    })?;
    line(bench, "implicit", "Cook's tip, error", plain, cured)
}

fn footing(bench: &mut Bench<'_>) -> Result<(), String> {
    let (plain, cured) = bench.aside(&Prandtl, |reference, report| {
        let mut error = |cure| {
            let setup = prandtl::Setup { cells: 8, rough: false, cure };
            // F / B, of what presses on B + h: nine nodes of eight cells
            let nominal = Prandtl.footing(setup, reference, report)?;
            Ok::<_, String>((nominal * 8.0 / 9.0 / (2.0 + PI) - 1.0).abs())
        };
        Ok((error(false)?, error(true)?))
    })?;
    line(bench, "implicit", "Prandtl's load, error", plain, cured)
}
