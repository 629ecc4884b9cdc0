//! The process of failure on one sheet, as Fig. 8 of the paper: onset, first block, and the end, each by peak strength,
//! stage of the law and plastic strain.

use std::{io, path::Path};

use super::{load, nearest, options, range};
use crate::{
    case::Case,
    measure::Plateau,
    output::plot::{self, FieldKind, Part},
    snapshot::Snapshot,
};

/// Width of a column (pixels).
const WIDTH: u32 = 1000;

/// Draws `pictures/process.png` of a slope that has failed: the frames nearest to the onset, to the start of the
/// first plateau of r(t), and to the end. A run without a block has no picture of one.
pub fn draw(
    folder: &Path,
    case: &Case,
    frames: &[(f64, String)],
    began: Option<f64>,
    blocks: &[Plateau],
) -> io::Result<()> {
    let (Some(began), Some(end)) = (began, frames.last()) else { return Ok(()) };
    let mut stages = vec![("onset of failure", began)];
    stages.extend(blocks.first().map(|block| ("first block formed", block.from_s)));
    stages.push(("end of the run", end.0));
    let chosen: Vec<usize> = stages.iter().filter_map(|(_, time)| nearest(frames, *time)).collect();
    let snapshots = load(folder, frames, &chosen)?;
    let views: Vec<&Snapshot> = snapshots.iter().collect();
    let captions: Vec<String> =
        stages.iter().zip(&snapshots).map(|((name, _), s)| format!("{name}, t = {:.2} s", s.time)).collect();
    let columns: Vec<_> = [FieldKind::PeakStrength, FieldKind::Stage, FieldKind::PlasticStrain]
        .map(|kind| plot::FieldOptions {
            width: WIDTH,
            title: Some(kind.title().to_owned()),
            captions: captions.clone(),
            range: range(case, kind),
            ..options(case, kind)
        })
        .into();
    let row = columns.iter().map(|o| Part::Field(&views, o)).collect();
    plot::sheet(&folder.join("pictures").join("process.png"), &[row])
}
