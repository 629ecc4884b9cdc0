//! `rmpm check`.

use super::{Failure, exit::print, input::CaseArgs};
use crate::{
    case::{Case, Scheme},
    scene::Scene,
};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    case: CaseArgs,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let (case, _) = args.case.read()?;
    let mut scene = args.case.build(&case)?;
    let dt = first_step(&case, &mut scene);
    let mut text = format!("{}: sound\n  {}\n", args.case.case.display(), case.title);
    text += &format!(
        "  {} points in {} cells ({} cut), h = {} m\n",
        scene.simulation.body.len(),
        scene.cells,
        scene.cut_cells,
        case.grid.cell
    );
    text += &format!("  first time step {dt:.3e} s: about {:.0} steps to {} s\n", case.end.time / dt, case.end.time);
    text +=
        &format!("  memory for a run with its pictures: about {:.0} MB\n", case.memory_estimate_bytes() as f64 / 1e6);
    for w in &scene.warnings {
        text += &format!("  note: {} (key `{}`)\n", w.text, w.key);
    }
    print(&text)
}

/// Length of the first time step (s).
fn first_step(case: &Case, scene: &mut Scene) -> f64 {
    match case.solver.scheme {
        Scheme::Explicit => case.explicit.time_step.or_else(|| scene.simulation.stable_dt()).unwrap_or(f64::NAN),
        Scheme::Implicit => case.implicit.time_step,
    }
}
