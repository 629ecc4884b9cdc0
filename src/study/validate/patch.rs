//! The patch test, on the straining kernel alone.

use nalgebra::{Matrix2, SymmetricEigen};

use super::{
    Effort, Files, Problem, Report,
    measure::largest,
    reference::Reference,
    setup::{Run, keys},
};
use crate::{
    assembly::{Scatter, Scratch, Strain},
    body::{Body, Part},
    case::Kinematics,
    field::stream::{Purpose, Stream},
    math::{simd::FpPath, tensor::Voigt},
    nodes::Nodes,
    snapshot::Snapshot,
    space::{BSpline, Linear, Shape},
    work::Work,
};

/// See the module.
pub struct Patch;

impl Problem for Patch {
    fn name(&self) -> &'static str {
        "patch"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/patch/case.toml"),
            reference: include_str!("../../../validation/patch/reference.toml"),
        }
    }

    fn fill(&self, _: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let [xx, xy, yx, yy] = ["xx", "xy", "yx", "yy"].map(|k| reference.given(k));
        let rate = Matrix2::new(xx?, xy?, yx?, yy?);
        let dt = reference.given("step")?;
        for kinematics in ["hencky", "rate"] {
            let mut run = Run::new(self.files().case, &keys(&[("solver.kinematics", kinematics.into())]))?;
            scatter_points(&mut run);
            strain(&mut run, dt, |x| rate * nalgebra::Vector2::from(x))?;
            judge(&run, kinematics, rate * dt, reference, report)?;
            let spline = format!("{kinematics}, bspline");
            let mut run = Run::new(self.files().case, &keys(&[("solver.kinematics", kinematics.into())]))?;
            scatter_points(&mut run);
            strain_with(BSpline, &mut run, dt, |x| rate * nalgebra::Vector2::from(x))?;
            judge(&run, &spline, rate * dt, reference, report)?;
        }
        Ok(())
    }
}

/// Rows of a body after one step with displacement gradient `du`.
fn judge(run: &Run, name: &str, du: Matrix2<f64>, reference: &Reference, report: &mut Report) -> Result<(), String> {
    report.count_work(&Work { steps: 1, particle_steps: run.sim.body.len() as u64, ..Work::default() });
    compare(&run.sim.snapshot(), closed_form(run, du), name, reference, report)?;
    let volume = (Matrix2::identity() + du).determinant();
    let gap = largest(run.sim.body.committed.jacobian.iter().map(|j| (j - volume).abs()));
    report.row_of(reference, "volume", name, None, gap)
}

/// Puts every point anywhere in the block, so that some cells are crowded and some empty.
fn scatter_points(run: &mut Run) {
    let mut stream = Stream::new(7, 0, Purpose::Jitter);
    let (h, far) = (run.grid.h, run.grid.far());
    for axis in 0..2 {
        let place = |x: &mut f64| *x = h + (far[axis] - 2.0 * h) * stream.uniform();
        run.sim.body.committed.x[axis].iter_mut().for_each(place);
    }
}

/// Strains the body by one step of a prescribed nodal velocity; points stay where they are.
pub(super) fn strain(
    run: &mut Run,
    dt: f64,
    velocity: impl Fn([f64; 2]) -> nalgebra::Vector2<f64>,
) -> Result<(), String> {
    strain_with(Linear, run, dt, velocity)
}

fn strain_with<S: Shape<N>, const N: usize>(
    shape: S,
    run: &mut Run,
    dt: f64,
    velocity: impl Fn([f64; 2]) -> nalgebra::Vector2<f64>,
) -> Result<(), String> {
    let (body, path) = (&mut run.sim.body, FpPath::best());
    let mut nodes = Nodes::new(run.grid);
    let mut scratch = Box::<Scratch<N>>::default();
    path.run(Scatter { scratch: &mut scratch, body, nodes: &mut nodes, cells: None, stretch: 0..body.len(), shape });
    for s in 0..nodes.count {
        let v = velocity(run.grid.node_position(nodes.id[s]));
        nodes.strain_velocity[0][s] = v.x;
        nodes.strain_velocity[1][s] = v.y;
    }
    let (scratch, nodes) = (scratch.as_mut(), &nodes);
    let pass = |body: &Body, part: Part| path.run(Strain { scratch, body, part, nodes, cells: None, dt, shape });
    body.apart(pass).map_err(|fault| fault.to_string())?;
    body.trial.x.clone_from(&body.committed.x);
    body.trial.v.clone_from(&body.committed.v);
    body.commit();
    Ok(())
}

/// Cauchy stress (kPa) after one step with displacement gradient `du` from rest.
fn closed_form(run: &Run, du: Matrix2<f64>) -> Voigt {
    let e = run.case.material["soil"].elastic();
    let (young, nu) = (e.young_modulus, e.poisson_ratio);
    let lambda = young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let shear = young / (2.0 * (1.0 + nu));
    let f = Matrix2::identity() + du;
    let (strain, factor) = match run.case.solver.kinematics {
        Kinematics::Hencky => (half_log(f * f.transpose()), 1.0 / f.determinant()),
        Kinematics::Rate | Kinematics::Small => ((du + du.transpose()) * 0.5, 1.0),
    };
    let mean = lambda * strain.trace();
    let s = (Matrix2::identity() * mean + strain * (2.0 * shear)) * factor;
    Voigt::new(s[(0, 0)], s[(1, 1)], mean * factor, s[(0, 1)])
}

/// 1/2 ln(b) by eigenvectors.
fn half_log(b: Matrix2<f64>) -> Matrix2<f64> {
    let eigen = SymmetricEigen::new(b);
    let logs = Matrix2::from_diagonal(&eigen.eigenvalues.map(|v| 0.5 * v.ln()));
    eigen.eigenvectors * logs * eigen.eigenvectors.transpose()
}

fn compare(s: &Snapshot, exact: Voigt, name: &str, reference: &Reference, report: &mut Report) -> Result<(), String> {
    let size = exact.dot(exact).sqrt();
    let apart = |a: Voigt, b: Voigt| (a - b).dot(a - b).sqrt() / size;
    report.row_of(reference, "spread", name, None, largest(s.stress.iter().map(|&a| apart(a, s.stress[0]))))?;
    report.row_of(reference, "stress", name, None, largest(s.stress.iter().map(|&a| apart(a, exact))))
}
