//! Manufactured solutions: a motion is chosen, the body force that makes it exact is derived, and the error of the
//! displacements must fall as h^2.

mod axis_aligned;
mod motion;
mod vortex;

use std::f64::consts::PI;

use self::{
    axis_aligned::AxisAligned,
    motion::{Elastic, Motion},
    vortex::Vortex,
};
use super::{
    Effort, Figure, Files, Problem, Report,
    figure::Kind,
    measure::order,
    reference::Reference,
    setup::{Run, keys},
};
use crate::{
    body::Body,
    case::{self, Case},
    effect::{BodyForce, Effect},
    snapshot::Snapshot,
};

/// See the module.
pub struct Manufactured;

/// Shape functions that are tried; a further one is a further word.
const SHAPES: [&str; 4] = ["linear", "gimp", "bspline", "gimp_wide"];

impl Problem for Manufactured {
    fn name(&self) -> &'static str {
        "manufactured"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../../validation/manufactured/case.toml"),
            reference: include_str!("../../../../validation/manufactured/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let square = Field { key: "square", case: self.files().case, width: 1.0, make: axis_aligned };
        let ring = Field { key: "ring", case: RING, width: 2.6, make: vortex };
        for amplitude in ["small", "large"] {
            square.refine(amplitude, &[8, 16, 32, 64], effort, reference, report)?;
            ring.refine(amplitude, &[40, 80, 160], effort, reference, report)?;
        }
        Ok(())
    }
}

const RING: &str = include_str!("../../../../validation/manufactured/vortex.toml");

fn axis_aligned(elastic: Elastic, amplitude: f64) -> AxisAligned {
    AxisAligned { amplitude, frequency: PI * elastic.bar_wave(), elastic }
}

fn vortex(elastic: Elastic, turn: f64) -> Vortex {
    Vortex { turn, elastic }
}

/// A motion with its case.
struct Field<M> {
    /// In the keys of its answers.
    key: &'static str,
    case: &'static str,
    /// Of the square that is filled (m).
    width: f64,
    /// From the elastic material and the amplitude.
    make: fn(Elastic, f64) -> M,
}

#[derive(Clone, Copy)]
struct Setup {
    scheme: &'static str,
    shape: &'static str,
    amplitude: f64,
}

/// The sizes that are run: the implicit scheme takes ten times as long.
fn sizes<'a>(scheme: &str, effort: Effort, cells: &'a [usize]) -> &'a [usize] {
    let left_out = match (effort, scheme) {
        (Effort::Full, "explicit") => 0,
        (Effort::Full, _) | (Effort::Short, "explicit") => 1,
        (Effort::Short, _) => 2,
    };
    &cells[..cells.len() - left_out]
}

impl<M: Motion> Field<M> {
    /// Schemes and shape functions that are run. In short none has the wide patch, whose figures are those of `gimp` as long
    /// as no domain is longer than a cell, and the implicit scheme leaves out the ring and motions through many cells.
    fn schemes(&self, amplitude: &str, effort: Effort) -> Vec<(&'static str, &'static str)> {
        let all = ["explicit", "implicit"].into_iter().flat_map(|scheme| SHAPES.map(|shape| (scheme, shape)));
        let quick = |scheme: &str| scheme == "explicit" || (amplitude == "small" && self.key == "square");
        all.filter(|(scheme, shape)| effort == Effort::Full || (*shape != "gimp_wide" && quick(scheme))).collect()
    }

    /// Both schemes and all shape functions on finer and finer grids.
    fn refine(
        &self,
        amplitude: &str,
        cells: &[usize],
        effort: Effort,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        let key = format!("{}_{amplitude}", self.key);
        let mut figure = Figure::convergence(
            &format!("{}: error of the displacement, amplitude {}", self.key, reference.given(&key)?),
            "root of the mean square over all points, against the exact motion; steps in proportion to cells",
            "cell (m)",
            "error over amplitude",
        );
        for (scheme, shape) in self.schemes(amplitude, effort) {
            let setup = Setup { scheme, shape, amplitude: reference.given(&key)? };
            let errors = self.errors(setup, sizes(scheme, effort, cells), report)?;
            let smooth = if shape == "linear" { "linear" } else { "smooth" };
            let name = format!("{shape}, {scheme}");
            let (before, floor) = before_floor(shape, amplitude, &errors);
            report.row_of(reference, &format!("{key}_{smooth}"), &(name.clone() + floor), None, order(before))?;
            let finest = errors.last().map_or(f64::NAN, |e| e.1);
            report.row_of(reference, &format!("{}_finest", self.key), &format!("{amplitude}, {name}"), None, finest)?;
            report.note(format!("{} {amplitude}, {name}: {}", self.key, told(&errors)));
            figure = figure.with(name, Kind::Marked, errors);
        }
        report.figure(figure.with_slope(2));
        Ok(())
    }

    /// Cell (m) and error over the amplitude.
    fn errors(&self, setup: Setup, cells: &[usize], report: &mut Report) -> Result<Vec<(f64, f64)>, String> {
        let mut errors = Vec::new();
        for &n in cells {
            let h = self.width / n as f64;
            let (mut run, motion) = self.build(setup, h)?;
            run.until(run.case.end.time, |_| ())?;
            report.count(&run.sim);
            errors.push((h, error(&motion, &run.sim.snapshot()) / setup.amplitude));
        }
        Ok(errors)
    }

    fn build(&self, setup: Setup, h: f64) -> Result<(Run, M), String> {
        let (plain, _) = case::read("case.toml", self.case, &[]).map_err(|e| e.to_string())?;
        let motion = (self.make)(elastic(&plain)?, setup.amplitude);
        let pass = h / (elastic(&plain)?.wave() + motion.fastest());
        let (explicit, implicit) = (0.3 * pass, 0.6 * pass);
        let set = keys(&[
            ("grid.cell", format!("{h:?}")),
            ("solver.scheme", setup.scheme.into()),
            ("solver.shape", setup.shape.into()),
            ("explicit.time_step", format!("{explicit:?}")),
            ("implicit.time_step", format!("{implicit:?}")),
        ]);
        let lag = if setup.scheme == "explicit" { 0.5 * explicit } else { 0.0 };
        Ok((Run::adding(self.case, &set, &|body| driven_by(motion, lag, body))?, motion))
    }
}

/// The errors before the floor of noise, and words for that. Splines have no domains that stretch with the soil: after a
/// stretch of 16 % (A = 0.05 m) the points do not tile their supports, which shows from the third grid on.
fn before_floor<'a>(shape: &str, amplitude: &str, errors: &'a [(f64, f64)]) -> (&'a [(f64, f64)], &'static str) {
    match (shape, amplitude) {
        ("bspline", "large") if errors.len() > 2 => (&errors[..2], ", above its floor of noise"),
        _ => (errors, ""),
    }
}

/// The errors, with the order between each two: where it falls away is the floor.
fn told(errors: &[(f64, f64)]) -> String {
    let first = errors.first().map(|(h, e)| format!("{e:.2e} at h = {h:.4} m")).unwrap_or_default();
    let more = errors.windows(2).map(|pair| format!(", {:.2e} (order {:.2})", pair[1].1, order(pair)));
    first + &more.collect::<String>()
}

fn elastic(case: &Case) -> Result<Elastic, String> {
    let material = case.material.values().next().ok_or("there is no material")?.elastic();
    let density = material.unit_weight / case.gravity.acceleration;
    Ok(Elastic::new(material.young_modulus, material.poisson_ratio, density))
}

/// The velocities and the force of a motion. With the explicit scheme velocities stand half a step before positions:
/// they start there (`lag`, s), and the force is that of the positions, half a step before the middle of the step.
fn driven_by<M: Motion>(motion: M, lag: f64, body: &mut Body) -> Vec<Box<dyn Effect>> {
    for i in 0..body.len() {
        let v = motion.velocity(body.reference(i), -lag);
        (0..2).for_each(|axis| body.committed.v[axis][i] = v[axis]);
    }
    vec![Box::new(BodyForce::new(move |x, t| motion.body_force(x, t - lag)))]
}

/// Root of the mean square of the distance from the exact places (m).
fn error<M: Motion>(motion: &M, s: &Snapshot) -> f64 {
    let square = |i: usize| {
        let exact = motion.place(s.reference[i], s.time);
        (0..2).map(|axis| (s.position[i][axis] - exact[axis]).powi(2)).sum::<f64>()
    };
    ((0..s.len()).map(square).sum::<f64>() / s.len() as f64).sqrt()
}
