//! A band of softening soil: what it dissipates on finer cells.

use super::super::{
    remedy::Bench,
    shear_layer::{Family, ShearLayer},
};

/// Cells (m), each half the one before. Without a length the layer snaps back on finer ones.
const COARSE: [f64; 2] = [0.25, 0.125];
/// Those on which the average of the nonlocal remedy is resolved.
const FINE: [f64; 2] = [0.125, 0.0625];

pub(super) fn play(bench: &mut Bench<'_>) -> Result<(), String> {
    for scheme in ["explicit", "implicit"] {
        let bare = halved(bench, scheme, "none", COARSE)?;
        for (remedy, cells) in [("fracture_energy", COARSE), ("nonlocal", FINE)] {
            // the finer explicit layer takes a while
            if cells == FINE && scheme == "explicit" && !bench.is_full() {
                continue;
            }
            let ours = halved(bench, scheme, remedy, cells)?;
            bench.line(["softening", remedy, scheme, "dissipation on h/2 over that on h"], bare, ours);
            bench.judge("halved", &format!("{remedy}, {scheme}"), ours)?;
        }
        bench.judge("drift", scheme, bare)?;
    }
    Ok(())
}

fn halved(bench: &mut Bench<'_>, scheme: &'static str, remedy: &'static str, cells: [f64; 2]) -> Result<f64, String> {
    let family = Family { scheme, shape: "linear", remedy };
    let [coarse, fine] = bench.aside(&ShearLayer, |reference, report| {
        let mut energy = |h| Ok::<_, String>(ShearLayer.band(family, h, reference, report)?.energy);
        Ok([energy(cells[0])?, energy(cells[1])?])
    })?;
    Ok(fine / coarse)
}
