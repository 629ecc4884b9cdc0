//! Nodes with hardly any mass, in the explicit scheme: points parked just past a node.

use super::super::{light_node::LightNode, measure::largest, reference::Reference, remedy::Bench};

pub(super) fn play(bench: &mut Bench<'_>) -> Result<(), String> {
    let bare = growth(bench, "usl", false)?;
    for (remedy, update) in [("MUSL", "musl"), ("mass floor", "usl")] {
        let ours = growth(bench, update, true)?;
        bench.line(["light node", remedy, "explicit", "largest energy over the first"], bare, ours);
        bench.judge("growth", remedy, ours)?;
    }
    bench.report.note("light node: 2000 steps of USL without a mass floor are compared with; the implicit scheme divides by no nodal mass");
    Ok(())
}

/// The largest of all places.
fn growth(bench: &mut Bench<'_>, update: &'static str, floor: bool) -> Result<f64, String> {
    let places: &[f64] = if bench.is_full() { &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1] } else { &[1e-6, 1e-3, 1e-1] };
    let grown = bench.aside(&LightNode, |reference: &Reference, report| {
        places
            .iter()
            .map(|past| LightNode.growth(update, floor, *past, reference, report))
            .collect::<Result<Vec<_>, _>>()
    })?;
    Ok(largest(grown))
}
