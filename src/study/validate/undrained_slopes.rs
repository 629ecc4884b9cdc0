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
        let rows: &[u32] = match effort {
            Effort::Short => &[10],
            Effort::Full => &[10, 20, 40],
        };
        for slope in SLOPES {
            for (k, &n) in rows.iter().enumerate() {
                let finest = k + 1 == rows.len() && effort == Effort::Full;
                let key = if finest { "number" } else { "coarse" };
                let exact = reference.exact(slope.key)?;
                let bracket = self.failure(slope, n, &[], report)?;
                report.row_of(reference, key, &slope.name(n), Some(exact), FULL * bracket.middle())?;
            }
        }
        self.cut_cells(reference, report)?;
        self.limit_point(reference, report)
    }
}

/// gamma H / cu at full gravity.
const FULL: f64 = 10.0;

/// A slope on a firm base.
#[derive(Clone, Copy)]
struct Slope {
    /// Its answer in the reference.
    key: &'static str,
    /// Horizontal run over height.
    run: f64,
    /// Depth of the firm base below the crest, over H.
    depth: f64,
    /// Level ground behind the crest and beyond the toe, over H.
    crest: f64,
    toe: f64,
}

const SLOPES: [Slope; 4] = [
    Slope { key: "steep_1_5", run: 1.0, depth: 1.5, crest: 3.0, toe: 2.0 },
    Slope { key: "steep_2", run: 1.0, depth: 2.0, crest: 3.0, toe: 3.0 },
    Slope { key: "steep_1", run: 1.0, depth: 1.0, crest: 3.0, toe: 0.0 },
    Slope { key: "gentle_2", run: 2.0, depth: 2.0, crest: 3.0, toe: 3.0 },
];

impl Slope {
    fn name(self, rows: u32) -> String {
        format!("{}:1, D = {}, H/h = {rows}", self.run, self.depth)
    }

    /// A millionth of H is added along the slope: points on the line itself then lie in the soil.
    fn keys(self, rows: u32) -> Vec<String> {
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
    fn failure(&self, slope: Slope, rows: u32, more: &[String], report: &mut Report) -> Result<Bracket, String> {
        let mut set = slope.keys(rows);
        set.extend_from_slice(more);
        let mut run = Run::new(self.files().case, &set)?;
        let bracket = last_equilibrium(&mut run)?;
        report.count(&run.sim);
        Ok(bracket)
    }

    /// What the cells along the face do.
    fn cut_cells(&self, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for rule in ["inside", "full"] {
            let more = keys(&[("points.cut_cells", rule.into())]);
            let bracket = self.failure(SLOPES[0], 10, &more, report)?;
            let name = format!("{}, cut cells {rule}", SLOPES[0].name(10));
            report.row_of(reference, "cut", &name, None, FULL * bracket.middle())?;
        }
        Ok(())
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
