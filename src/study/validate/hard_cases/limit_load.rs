//! A block that its own weight makes flow: how much of gravity is reached, with how many iterations.

use super::super::{
    block_collapse::{Block, BlockCollapse, End},
    remedy::Bench,
};

/// No step is cut: the shortest is the first.
const UNCUT: (&str, &str) = ("implicit.min_time_step", "10.0");
/// On coarser cells the block comes down without inertia too.
const BLOCK: Block = Block { cell: 1, points: 3 };
const STILL: (&str, &str) = ("implicit.regime", "quasi_static");
const UNSEARCHED: (&str, &str) = ("implicit.line_search", "false");

pub(super) fn play(bench: &mut Bench<'_>) -> Result<(), String> {
    let still = fall(bench, &[STILL])?;
    let uncut = fall(bench, &[STILL, UNCUT])?;
    line(bench, "step cut", &uncut, &still);
    let unsearched = fall(bench, &[STILL, UNSEARCHED])?;
    line(bench, "line search", &unsearched, &still);
    let moving = fall(bench, &[])?;
    line(bench, "inertia (auto)", &still, &moving);
    bench.judge("carried", "inertia (auto)", moving.share)?;
    bench.judge("no_less", "step cut", still.share - uncut.share)
}

fn fall(bench: &mut Bench<'_>, set: &[(&str, &str)]) -> Result<End, String> {
    bench.aside(&BlockCollapse, |_, report| BlockCollapse.collapse(BLOCK, set, report))
}

fn line(bench: &mut Bench<'_>, remedy: &str, without: &End, with: &End) {
    let what = |figure| ["limit load", remedy, "implicit", figure];
    bench.line(what("share of gravity reached"), without.share, with.share);
    bench.line(what("Newton iterations"), without.iterations as f64, with.iterations as f64);
}
