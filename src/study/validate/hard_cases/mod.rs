//! What breaks the material point method, each with and without its remedy: one case a file.

mod cell_crossing;
mod crush;
mod cut_cells;
mod extreme_fields;
mod fracture;
mod light_nodes;
mod limit_load;
mod locking;
mod noise;
mod played;
mod softening;
mod stick_slip;

use super::{Effort, Files, Problem, Report, reference::Reference, remedy::Bench};

/// See the module.
pub struct HardCases;

impl Problem for HardCases {
    fn name(&self) -> &'static str {
        "hard-cases"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../../validation/hard-cases/case.toml"),
            reference: include_str!("../../../../validation/hard-cases/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let bench = &mut Bench { effort, reference, report };
        cell_crossing::play(bench)?;
        light_nodes::play(bench)?;
        cut_cells::play(bench)?;
        locking::play(bench)?;
        noise::play(bench)?;
        softening::play(bench)?;
        limit_load::play(bench)?;
        stick_slip::play(bench)?;
        fracture::play(bench)?;
        crush::play(bench)?;
        extreme_fields::play(bench)
    }
}
