//! Cells that hold one point in their corner, in the implicit scheme.

use super::super::{
    cut_cell::{CutCell, Setup},
    remedy::Bench,
};

/// Cells by which the last points lie past a node.
const PAST: f64 = 1e-8;

pub(super) fn play(bench: &mut Bench<'_>) -> Result<(), String> {
    let [whole, bare, ghosted] = bench.aside(&CutCell, |reference, report| {
        let gamma = reference.given("gamma")?;
        let setup = Setup { past: None, gamma: 0.0, mass: None, finite: true, steps: 1.0 };
        let cut = Setup { past: Some(PAST), ..setup };
        let mut stand = |setup| CutCell.stand(setup, reference, report);
        Ok([stand(setup)?, stand(cut)?, stand(Setup { gamma, ..cut })?])
    })?;
    let what = |figure| ["cut cell", "ghost penalty", "implicit", figure];
    let (without, with) = (bare.condition / whole.condition, ghosted.condition / whole.condition);
    bench.line(what("condition number over that of whole cells"), without, with);
    bench.judge("condition", "ghost penalty", with)?;
    bench.line(what("Newton iterations of a step"), bare.iterations, ghosted.iterations);
    bench.report.note("cut cell: a direct factor does without the penalty, which is off by default: the badly scaled row costs no iteration");
    Ok(())
}
