//! Points that cross the faces of cells: the stress of the column that is squeezed to half its height.

use super::super::{column::Column, remedy::Bench};

/// Rows of cells.
const ROWS: usize = 32;

/// Shapes whose gradients do not jump at the faces.
const SHAPES: [&str; 3] = ["gimp", "gimp_wide", "bspline"];

pub(super) fn play(bench: &mut Bench<'_>) -> Result<(), String> {
    for scheme in ["explicit", "implicit"] {
        let linear = error(bench, scheme, "linear")?;
        for shape in SHAPES {
            let what = ["cell crossing", shape, scheme, "mean error of the stress over the largest"];
            let ours = error(bench, scheme, shape)?;
            bench.helps(what, linear, ours)?;
        }
    }
    Ok(())
}

/// The explicit column takes its weight on slowly, and is damped to rest.
fn error(bench: &mut Bench<'_>, scheme: &str, shape: &str) -> Result<f64, String> {
    let mut set = vec![("solver.shape", shape.to_owned()), ("solver.scheme", scheme.to_owned())];
    if scheme == "explicit" {
        let rest = [("gravity.ramp_time", "40.0"), ("end.time", "80.0"), ("damping.local", "0.3")];
        set.extend(rest.map(|(key, value)| (key, value.to_owned())));
    }
    bench.aside(&Column, |reference, report| Ok(Column.squeeze(ROWS, &set, reference, report)?.stress))
}
