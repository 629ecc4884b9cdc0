//! `rmpm explain`.

use super::{Failure, exit::print, input::CaseArgs};
use crate::scene;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    case: CaseArgs,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let (case, _) = args.case.read()?;
    let scene = args.case.build(&case)?;
    let paths: String = scene::paths(&case).iter().map(|path| format!("- {path}\n")).collect();
    print(&format!("{}\n{paths}", scene::explain(&scene)))
}
