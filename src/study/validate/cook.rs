//! Cook's membrane: bending and shear of a tapered panel, nearly incompressible, its sides oblique
//! to the grid.

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    reference::Reference,
    setup::{Run, keys},
};
use crate::snapshot::Snapshot;

/// See the module.
pub struct Cook;

/// The corner that is read (m).
const TIP: [f64; 2] = [48.0, 60.0];

/// The applied load is a thousandth of the problem's.
const SCALE: f64 = 1000.0;

impl Problem for Cook {
    fn name(&self) -> &'static str {
        "cook"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/cook/case.toml"),
            reference: include_str!("../../../validation/cook/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let sizes: &[f64] = match effort {
            Effort::Short => &[4.0, 2.0, 1.0],
            Effort::Full => &[4.0, 2.0, 1.0, 0.5, 0.25],
        };
        let (mut cured, mut locked) = (Vec::new(), Vec::new());
        for (k, &h) in sizes.iter().enumerate() {
            let key = if k + 1 == sizes.len() { "tip" } else { "coarse" };
            cured.push((h, self.panel(Setup { h, ..Setup::CURED }, key, reference, report)?));
        }
        for &h in sizes {
            let tip = self.panel(Setup { h, locking: "none", ..Setup::CURED }, "locked", reference, report)?;
            locked.push((h, tip));
        }
        report.figure(tips(cured, locked, reference.exact("tip")?));
        for cut in ["inside", "full"] {
            self.panel(Setup { cut, ..Setup::CURED }, "cut", reference, report)?;
        }
        for points in [2, 4] {
            self.panel(Setup { points, ..Setup::CURED }, "cut", reference, report)?;
        }
        Ok(())
    }
}

#[derive(Clone, Copy)]
pub(super) struct Setup {
    pub h: f64,
    pub points: usize,
    pub locking: &'static str,
    pub cut: &'static str,
}

impl Setup {
    pub(super) const CURED: Setup = Setup { h: 1.0, points: 3, locking: "b_bar", cut: "scaled" };

    fn name(self) -> String {
        format!("h = {} m, {} x {} points, cut cells {}", self.h, self.points, self.points, self.cut)
    }

    /// The load on the rightmost column of points, which is less than h / n wide.
    fn keys(self) -> Vec<String> {
        let left = TIP[0] - self.h / self.points as f64;
        keys(&[
            ("grid.cell", format!("{:?}", self.h)),
            ("points.per_axis", self.points.to_string()),
            ("points.cut_cells", self.cut.into()),
            ("solver.locking", self.locking.into()),
            ("load.shear.box", format!("[[{left:?}, 40.0], [48.0, 61.0]]")),
        ])
    }
}

impl Cook {
    /// Deflection of the tip (m); a row against the answer `key`.
    pub(super) fn panel(
        &self,
        setup: Setup,
        key: &str,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<f64, String> {
        let mut run = Run::new(self.files().case, &setup.keys())?;
        run.until(run.case.end.time, |_| ())?;
        report.count(&run.sim);
        let tip = SCALE * tip(&run.sim.snapshot(), setup.h);
        report.row_of(reference, key, &setup.name(), None, tip)?;
        Ok(tip)
    }
}

/// The tip over the cell, with and without a cure for locking.
fn tips(cured: Vec<(f64, f64)>, locked: Vec<(f64, f64)>, exact: f64) -> Figure {
    let largest = cured.iter().fold(0.0, |a: f64, p| a.max(p.0));
    Figure::new(
        "Cook's membrane: deflection of the tip",
        "3 x 3 points a cell; plain bilinear cells lock where the soil keeps its volume",
        "cell (m)",
        "deflection of the tip (m)",
    )
    .with("mean dilatation", Kind::Marked, cured)
    .with("plain cells", Kind::Marked, locked)
    .with("reference", Kind::Exact, vec![(0.0, exact), (largest, exact)])
}

/// Vertical displacement at the tip (m): the plane through the points within a cell and a half of it.
fn tip(s: &Snapshot, h: f64) -> f64 {
    let near = (0..s.len()).filter(|&i| s.reference[i].iter().zip(TIP).all(|(x, tip)| (x - tip).abs() < 1.5 * h));
    let mut sums = [[0.0; 4]; 3];
    for i in near {
        let row = [1.0, s.reference[i][0] - TIP[0], s.reference[i][1] - TIP[1], s.displacement(i)[1]];
        for a in 0..3 {
            for b in 0..4 {
                sums[a][b] += row[a] * row[b];
            }
        }
    }
    eliminate(sums)
}

/// First unknown of three equations, by elimination from the last.
fn eliminate(mut m: [[f64; 4]; 3]) -> f64 {
    for pivot in [2, 1] {
        for row in 0..pivot {
            let factor = m[row][pivot] / m[pivot][pivot];
            for column in 0..4 {
                m[row][column] -= factor * m[pivot][column];
            }
        }
    }
    m[0][3] / m[0][0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_unknown_of_three_equations() {
        // 2 x + y = 4, x + 3 y + z = 10, y + 4 z = 14, with x = 1, y = 2, z = 3
        let m = [[2.0, 1.0, 0.0, 4.0], [1.0, 3.0, 1.0, 10.0], [0.0, 1.0, 4.0, 14.0]];
        assert!((eliminate(m) - 1.0).abs() < 1e-14);
    }
}
