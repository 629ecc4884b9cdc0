//! `rmpm check`.

use super::{Failure, input::CaseArgs};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    case: CaseArgs,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let (case, _) = args.case.read()?;
    let mut scene = args.case.build(&case)?;
    let dt = scene.simulation.stable_dt().unwrap_or(f64::NAN);
    println!("{}: sound", args.case.case.display());
    println!("  {}", case.title);
    println!("  {} points in {} cells ({} cut), h = {} m", scene.simulation.body.len(), scene.cells, scene.cut_cells, case.grid.cell);
    println!("  first time step {:.3e} s, at most {:.0} steps", case.explicit.time_step.unwrap_or(dt), case.end.time / case.explicit.time_step.unwrap_or(dt));
    println!("  memory about {:.1} MB", scene.simulation.bytes() as f64 / 1e6);
    Ok(())
}
