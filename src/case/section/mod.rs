//! The tables of a case file, one reader each.

mod boundary;
mod ensemble;
mod field;
mod gravity;
mod grid;
mod guard;
mod implicit;
mod load;
mod material;
mod probe;
mod region;
mod run;
mod slide;
mod solver;
mod strength_reduction;

use super::check;
use super::keys::Keys;
use super::log::{Log, Problem};
use super::source::Span;
use super::tree::Table;
use super::{Case, Kinematics};

/// Name of an item of a list that has none, by its place in the file: "region 1".
pub(super) fn default_name(list: &str, index: usize) -> String {
    format!("{list} {}", index + 1)
}

/// Reads the whole tree; `None` where an error was noted.
pub(super) fn case(log: &Log, root: &Table) -> Option<Case> {
    let mut keys = Keys::new(log, String::new(), Span::new(0, 0..0), Some(root));
    let case = tables(log, &mut keys);
    keys.finish();
    case
}

fn tables(log: &Log, keys: &mut Keys<'_>) -> Option<Case> {
    let title = keys.or("title", "untitled".to_owned(), |c| c.text().map(str::to_owned));
    let seed = keys.or("seed", 1, |c| c.whole(0, i64::MAX as u64));
    let grid = grid::grid(keys);
    let points = grid::points(keys);
    let solver = solver::solver(keys);
    let chosen = solver.as_ref().map(|solver| solver::Chosen::new(keys, solver));
    let explicit = solver::explicit(keys, chosen.as_ref());
    let implicit = implicit::implicit(keys, chosen.as_ref());
    let guard = guard::guard(keys);
    let gravity = gravity::gravity(keys);
    let initial_stress = gravity::initial_stress(keys);
    let damping = run::damping(keys);
    let jitter = run::jitter(keys);
    let end = run::end(keys);
    let output = run::output(keys);
    let boundary = boundary::boundary(keys);
    let acceleration = gravity.as_ref().map_or(gravity::STANDARD, |g| g.acceleration);
    let materials = material::materials(keys, acceleration);
    let regions = region::regions(keys);
    let load = load::loads(keys);
    let drive = load::drives(keys);
    let ensemble = ensemble::ensemble(keys);
    let outlines = regions.as_deref().and_then(region::outlines);
    let field = field::fields(keys, materials.as_ref(), regions.as_deref());
    let probe = probe::probes(keys, outlines.as_deref());
    let slide = slide::slide(keys, outlines.as_deref());
    let strength_reduction = strength_reduction::strength_reduction(keys, materials.as_ref());
    check::regions(log, grid.as_ref(), materials.as_ref(), regions.as_deref());
    let cell_at = grid.as_ref()?.cell_at;
    let mut case = Case {
        title: title?,
        seed: seed?,
        grid: grid?.value,
        points: points?,
        solver: solver?,
        explicit: explicit?,
        implicit: implicit?,
        guard: guard?,
        gravity: gravity?,
        initial_stress: initial_stress?,
        damping: damping?,
        jitter: jitter?,
        end: end?,
        output: output?,
        slide: slide?,
        strength_reduction: strength_reduction?,
        boundary: boundary?,
        material: materials?.complete()?,
        region: regions?.into_iter().map(|region| region.value).collect::<Option<_>>()?,
        load: load?,
        drive: drive?,
        probe: probe?,
        ensemble: ensemble?,
        field: field?,
    };
    end_after_failure(keys, &mut case)?;
    check::size(log, cell_at, &case).then_some(case)
}

/// A run of small strain ends where its displacements mean nothing more; without a crest nothing tells how far
/// the soil has moved since the onset.
fn end_after_failure(keys: &Keys<'_>, case: &mut Case) -> Option<()> {
    match (&case.slide, case.end.after_failure) {
        (None, Some(_)) => {
            let message = "`end.after_failure` needs the table `slide`";
            let problem = Problem::new(message, "displacements since the onset are watched for a slide");
            let cursor = keys.named("end")?.table()?.named("after_failure")?;
            cursor.key_error(problem.help("add `[slide]`, or leave `after_failure` out"));
            None
        }
        (Some(slide), None) if case.solver.kinematics == Kinematics::Small => {
            case.end.after_failure = slide.initial_levels.last().copied();
            Some(())
        }
        _ => Some(()),
    }
}
