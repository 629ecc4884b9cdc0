//! A thick cylinder of perfectly plastic clay, burst from within.
//!
//! The program has no pressure on a boundary. The study adds a radial body force f(r) instead, even over the inner
//! quarter of the wall, and its limit is exact all the same. Equilibrium and yield in plane strain,
//! ```text
//! s_r' + (s_r - s_t) / r + f = 0,   s_t - s_r = 2 c,   s_r(a) = s_r(b) = 0
//! =>  p = int_a^b f dr = 2 c ln(b / a)
//! ```
//! the lower bound; u_r = 1 / r is the mechanism of the upper one, int 2 c r^-2 2 pi r dr = 2 pi int f dr. Wherever the
//! force acts, p is the pressure that bursts the cylinder.
//!
//! The ring is a staircase of cells; the volumes of its cut cells are those of the ring.

use std::f64::consts::FRAC_PI_2;

use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    limit::{Bracket, last_equilibrium},
    measure::order,
    reference::Reference,
    setup::{Run, keys},
};
use crate::effect::BodyForce;

/// See the module.
pub struct ThickCylinder;

/// Corners of the polygon on each arc: it lacks 1 - cos(pi / 512), 2e-5, of the radius.
const CORNERS: usize = 128;

impl Problem for ThickCylinder {
    fn name(&self) -> &'static str {
        "thick-cylinder"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/thick-cylinder/case.toml"),
            reference: include_str!("../../../validation/thick-cylinder/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let sizes: &[u32] = match effort {
            Effort::Short => &[8, 16],
            Effort::Full => &[8, 16, 32, 64],
        };
        let mut errors = Vec::new();
        for &cells in sizes {
            let last = Some(&cells) == sizes.last();
            let ring = Ring::read(reference, cells)?;
            let found = ring.burst(self.files().case, last, reference, report)?;
            errors.push((1.0 / f64::from(cells), found / ring.exact() - 1.0));
        }
        report.row(reference, "order", order(&errors))?;
        let points = errors.iter().map(|(h, e)| (*h, e.abs())).collect();
        let figure = Figure::convergence(
            "Error of the pressure that bursts a thick cylinder",
            "mean dilatation over cells; the ring is a staircase of cells, cut cells scaled to their area",
            "cell over wall thickness",
            "error, relative",
        );
        report.figure(figure.with("implicit", Kind::Marked, points).with_slope(1));
        Ok(())
    }
}

struct Ring {
    /// a and b (m).
    inner: f64,
    outer: f64,
    /// c (kPa).
    cohesion: f64,
    /// Cells over the wall.
    cells: u32,
}

impl Ring {
    fn read(reference: &Reference, cells: u32) -> Result<Self, String> {
        let [inner, outer, cohesion] = ["inner", "outer", "cohesion"].map(|name| reference.given(name));
        Ok(Ring { inner: inner?, outer: outer?, cohesion: cohesion?, cells })
    }

    /// 2 c ln(b / a) (kPa).
    fn exact(&self) -> f64 {
        2.0 * self.cohesion * (self.outer / self.inner).ln()
    }

    fn h(&self) -> f64 {
        (self.outer - self.inner) / f64::from(self.cells)
    }

    /// A quarter of the ring as a polygon.
    fn polygon(&self) -> String {
        let arc = |radius: f64| (0..=CORNERS).map(move |k| (radius, FRAC_PI_2 * k as f64 / CORNERS as f64));
        let corner = |(radius, angle): (f64, f64)| format!("[{:?}, {:?}]", radius * angle.cos(), radius * angle.sin());
        let corners: Vec<String> = arc(self.inner).chain(arc(self.outer).rev()).map(corner).collect();
        format!("[{}]", corners.join(", "))
    }

    fn build(&self, text: &str) -> Result<Run, String> {
        let size = self.outer + self.h();
        let set = keys(&[
            ("grid.cell", format!("{:?}", self.h())),
            ("grid.size", format!("[{size:?}, {size:?}]")),
            ("region.wall.polygon", self.polygon()),
        ]);
        let (inner, depth, most) = (self.inner, 0.25 * (self.outer - self.inner), self.exact());
        let density = 1.0;
        // at time 1 the force comes to the exact limit; it is even over the loaded part
        let force = move |x: [f64; 2], time: f64| {
            let radius = x[0].hypot(x[1]);
            let pull = if radius < inner + depth { most * time / (depth * density) } else { 0.0 };
            x.map(|x| pull * x / radius)
        };
        Run::adding(text, &set, &|_| vec![Box::new(BodyForce::new(force))])
    }

    /// The pressure with the last equilibrium (kPa).
    fn burst(&self, text: &str, last: bool, reference: &Reference, report: &mut Report) -> Result<f64, String> {
        let mut run = self.build(text)?;
        let share = self.share(&run);
        let bracket: Bracket = last_equilibrium(&mut run)?.ok_or("the cylinder holds any pressure")?;
        report.count(&run.sim);
        let pressure = bracket.middle() * self.exact() * share;
        let name = format!("{} cells over the wall", self.cells);
        let key = if last { "pressure" } else { "coarse" };
        report.row_of(reference, key, &name, Some(self.exact()), pressure)?;
        report.row_of(reference, "bracket", &name, None, bracket.half_width())?;
        report.row_of(reference, "share", &name, None, share)?;
        if last {
            report.figure(self.profile(&run));
        }
        Ok(pressure)
    }

    /// int f dr of the points over that of the exact ring: sum of m b / r over an angle of pi / 2.
    fn share(&self, run: &Run) -> f64 {
        let s = run.sim.snapshot();
        let depth = 0.25 * (self.outer - self.inner);
        let radius = |i: usize| s.reference[i][0].hypot(s.reference[i][1]);
        let loaded = (0..s.len()).filter(|&i| radius(i) < self.inner + depth);
        loaded.map(|i| s.initial_volume[i] / radius(i)).sum::<f64>() / (FRAC_PI_2 * depth)
    }

    /// s_t - s_r over the radius.
    fn profile(&self, run: &Run) -> Figure {
        let s = run.sim.snapshot();
        let difference = |i: usize| {
            let [x, y] = s.reference[i];
            let (r2, t) = (x * x + y * y, &s.stress[i]);
            let radial = (t.xx * x * x + 2.0 * t.xy * x * y + t.yy * y * y) / r2;
            (r2.sqrt(), (t.xx + t.yy - 2.0 * radial) / (2.0 * self.cohesion))
        };
        Figure::new(
            "Thick cylinder at its limit",
            "where the hoop stress exceeds the radial one by 2 c the wall yields; points in cut cells at its faces lag behind",
            "radius (m)",
            "(hoop - radial stress) / 2 c",
        )
        .with("points", Kind::Points, (0..s.len()).map(difference).collect())
        .with("exact", Kind::Exact, vec![(self.inner, 1.0), (self.outer, 1.0)])
    }
}
