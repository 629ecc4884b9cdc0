//! gamma H / cu at which an undrained slope fails.
//!
//! Gravity grows until no step finds equilibrium. That this is a limit point, and not the end of
//! Newton's patience, shows in the bracket: it stays with twice the iterations and with shorter steps.

use super::{
    Effort, Files, Problem, Report,
    limit::{Bracket, last_equilibrium},
    reference::Reference,
    setup::{Run, keys},
};

/// See the module.
pub struct UndrainedSlopes;

/// Height of the slope (m).
const HEIGHT: f64 = 10.0;

impl Problem for UndrainedSlopes {
    fn name(&self) -> &'static str {
        "undrained-slopes"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/undrained-slopes/case.toml"),
            reference: include_str!("../../../validation/undrained-slopes/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for slope in SLOPES {
            let sizes = if effort == Effort::Short { slope.short } else { &[10, 20, 40] };
            for &rows in sizes {
                let finest = Some(&rows) == sizes.last();
                self.number(slope, rows, finest, reference, report)?;
            }
        }
        self.cut_cells(reference, report)?;
        self.locked(reference, report)?;
        self.limit_point(reference, report)
    }
}

/// gamma H / cu at full gravity.
const FULL: f64 = 10.0;

/// A slope on a firm base.
#[derive(Clone, Copy)]
pub(super) struct Slope {
    /// Its answer in the reference.
    pub key: &'static str,
    /// Horizontal run over height.
    run: f64,
    /// Depth of the firm base below the crest, over H.
    depth: f64,
    /// Level ground behind the crest and beyond the toe, over H.
    crest: f64,
    toe: f64,
    /// Whether circles come within 3 % of the best mechanism: those that go through the toe, or
    /// that dip below it a little.
    tight: bool,
    /// H / h of the short form.
    short: &'static [u32],
}

pub(super) const SLOPES: [Slope; 4] = [
    Slope { key: "steep_1_5", run: 1.0, depth: 1.5, crest: 3.0, toe: 2.0, tight: false, short: &[10] },
    Slope { key: "steep_2", run: 1.0, depth: 2.0, crest: 3.0, toe: 3.0, tight: false, short: &[10] },
    Slope { key: "steep_1", run: 1.0, depth: 1.0, crest: 3.0, toe: 0.0, tight: true, short: &[10, 20] },
    Slope { key: "gentle_2", run: 2.0, depth: 2.0, crest: 3.0, toe: 3.0, tight: true, short: &[10] },
];

impl Slope {
    pub fn name(self, rows: u32) -> String {
        format!("{}:1, D = {}, H/h = {rows}", self.run, self.depth)
    }

    /// A millionth of H is added along the slope: points on the line itself then lie in the soil.
    pub fn keys(self, rows: u32) -> Vec<String> {
        let h = HEIGHT / f64::from(rows);
        let metres = |share: f64| share * HEIGHT;
        let (crest, run, toe) = (metres(self.crest + 1e-6), metres(self.run), metres(self.toe));
        let (top, ground) = (metres(self.depth), metres(self.depth - 1.0));
        let right = crest.round() + run + toe;
        let mut corners = format!("[[0.0, 0.0], [{:?}, 0.0]", if toe > 0.0 { right } else { crest + run });
        if toe > 0.0 {
            corners += &format!(", [{right:?}, {ground:?}], [{:?}, {ground:?}]", crest + run);
        }
        corners += &format!(", [{crest:?}, {top:?}], [0.0, {top:?}]]");
        // where there is no ground beyond the toe, the slope ends before the side of the grid
        let width = if toe > 0.0 { right } else { right + 2.0 * h };
        keys(&[
            ("grid.cell", format!("{h:?}")),
            ("grid.size", format!("[{width:?}, {:?}]", top + h)),
            ("region.slope.polygon", corners),
        ])
    }
}

impl UndrainedSlopes {
    fn number(
        &self,
        slope: Slope,
        rows: u32,
        finest: bool,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        let circle = reference.exact(slope.key)?;
        let ours = FULL * self.failure(slope, rows, &[], report)?.middle();
        let key = match (finest, slope.tight) {
            (false, _) => "coarse",
            (true, true) => "number",
            (true, false) => "loose",
        };
        let name = slope.name(rows);
        report.row_of(reference, key, &name, Some(circle), ours)?;
        if finest {
            report.row_of(reference, "bound", &name, None, ours / circle)?;
        }
        if finest && slope.key == "gentle_2" {
            report.row_of(reference, "safety", &name, None, 0.25 * ours)?;
        }
        Ok(())
    }

    fn failure(&self, slope: Slope, rows: u32, more: &[String], report: &mut Report) -> Result<Bracket, String> {
        let mut set = slope.keys(rows);
        set.extend_from_slice(more);
        let mut run = Run::new(self.files().case, &set)?;
        let bracket = last_equilibrium(&mut run)?;
        report.count(&run.sim);
        bracket.ok_or_else(|| format!("{} stands at gamma H / cu = {FULL}", slope.name(rows)))
    }

    /// What the cells along the face do, and other shape functions.
    fn cut_cells(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for rule in ["points.cut_cells=inside", "points.cut_cells=full", "solver.shape=gimp"] {
            let bracket = self.failure(SLOPES[0], 10, &[rule.to_owned(), "points.layout=even".to_owned()], report)?;
            let name = format!("{}, {rule}", SLOPES[0].name(10));
            report.row_of(reference, "cut", &name, None, FULL * bracket.middle())?;
        }
        Ok(())
    }

    /// Plain cells do not fail where soil does.
    fn locked(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let mut set = SLOPES[0].keys(10);
        set.push("solver.locking=none".to_owned());
        let mut run = Run::new(self.files().case, &set)?;
        let stands = last_equilibrium(&mut run)?.map_or(run.sim.time, Bracket::middle);
        report.count(&run.sim);
        report.row_of(reference, "locked", &SLOPES[0].name(10), None, FULL * stands)
    }

    /// The bracket with more iterations, and with shorter steps.
    fn limit_point(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let base = self.failure(SLOPES[0], 10, &[], report)?;
        report.row(reference, "width", base.half_width())?;
        for (name, set) in [
            ("60 iterations", [("implicit.max_iterations", "60".to_owned())]),
            ("steps half as long", [("implicit.time_step", "0.025".to_owned())]),
        ] {
            let other = self.failure(SLOPES[0], 10, &keys(&set), report)?;
            report.row_of(reference, "moved", name, None, (other.middle() / base.middle() - 1.0).abs())?;
        }
        Ok(())
    }
}
