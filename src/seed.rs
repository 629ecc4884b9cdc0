//! From geometry to material points.

use crate::{math::outline::Outline, space::Grid};

/// The rule for cells that the soil fills only in part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CutRule {
    /// As if it were full.
    Full,
    /// Only the points inside the outline.
    Inside,
    /// Only the points inside, with volumes that add up to the exact area.
    Scaled,
}

/// A point to be: where, how large, of which region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seed {
    pub x: [f64; 2],
    /// Volume per metre of thickness (m3/m).
    pub volume: f64,
    pub region: usize,
}

/// Points and the cells they start in.
#[derive(Clone, Debug, Default)]
pub struct Seeding {
    pub points: Vec<Seed>,
    /// Cells with at least one point.
    pub cells: u64,
    /// Of these, cells that an outline cuts.
    pub cut_cells: u64,
}

/// Share of a cell's area below which a region counts as only touching it.
const TOUCH: f64 = 1e-6;

/// Fills the regions with points at the local positions `positions` x `positions` of each cell,
/// cell by cell, row by row.
pub fn seed(grid: &Grid, outlines: &[Outline], positions: &[f64], rule: CutRule) -> Seeding {
    let mut out = Seeding::default();
    let [first, last] = cell_range(grid, outlines);
    for cy in first[1]..last[1] {
        for cx in first[0]..last[0] {
            seed_cell(grid, [cx, cy], outlines, positions, rule, &mut out);
        }
    }
    out
}

fn cell_range(grid: &Grid, outlines: &[Outline]) -> [[u32; 2]; 2] {
    let mut range = [[u32::MAX; 2], [0; 2]];
    for [low, high] in outlines.iter().map(Outline::bounds) {
        for a in 0..2 {
            let cell = |x: f64| ((x - grid.origin[a]) / grid.h).clamp(0.0, f64::from(grid.cells[a]));
            range[0][a] = range[0][a].min(cell(low[a]).floor() as u32);
            range[1][a] = range[1][a].max(cell(high[a]).ceil() as u32);
        }
    }
    range
}

fn seed_cell(grid: &Grid, cell: [u32; 2], outlines: &[Outline], local: &[f64], rule: CutRule, out: &mut Seeding) {
    let min = [0, 1].map(|a| grid.origin[a] + grid.h * f64::from(cell[a]));
    let max = [0, 1].map(|a| grid.origin[a] + grid.h * (f64::from(cell[a]) + 1.0));
    let full = grid.h * grid.h;
    let shares: Vec<f64> = outlines.iter().map(|o| o.area_in(min, max)).collect();
    let covered: f64 = shares.iter().sum();
    let Some(largest) = (0..shares.len()).max_by(|&a, &b| shares[a].total_cmp(&shares[b])) else { return };
    if covered <= TOUCH * full {
        return;
    }
    let before = out.points.len();
    let volume = full / (local.len() * local.len()) as f64;
    for eta in local {
        for xi in local {
            let x = [min[0] + xi * grid.h, min[1] + eta * grid.h];
            let region = outlines.iter().position(|o| o.contains(x));
            let region = if rule == CutRule::Full { region.or(Some(largest)) } else { region };
            out.points.extend(region.map(|region| Seed { x, volume, region }));
        }
    }
    if rule == CutRule::Scaled {
        scale_volumes(&mut out.points[before..], &shares);
    }
    out.cells += u64::from(out.points.len() > before);
    out.cut_cells += u64::from(out.points.len() > before && covered < (1.0 - TOUCH) * full);
}

/// Gives the points of each region in a cell equal parts of the region's area there. A sliver
/// that holds no point is left to the neighbouring cells' points and lost: less than one point.
fn scale_volumes(points: &mut [Seed], shares: &[f64]) {
    for (region, share) in shares.iter().enumerate() {
        let n = points.iter().filter(|p| p.region == region).count();
        points.iter_mut().filter(|p| p.region == region).for_each(|p| p.volume = share / n as f64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::gauss;

    fn slope(h: f64, rule: CutRule) -> Seeding {
        let grid = Grid { origin: [0.0, 0.0], h, cells: [(40.0 / h) as u32, (7.0 / h).ceil() as u32] };
        let outline = Outline::Polygon(vec![[0.0, 0.0], [25.0, 0.0], [20.0, 5.0], [0.0, 5.0]]);
        seed(&grid, &[outline], &gauss::gauss(2), rule)
    }

    #[test]
    fn the_papers_slope_has_1810_cells_and_7240_points() {
        let s = slope(0.25, CutRule::Full);
        assert_eq!((s.cells, s.cut_cells, s.points.len()), (1810, 20, 7240));
    }

    #[test]
    fn scaled_volumes_add_up_to_the_area() {
        let s = slope(0.25, CutRule::Scaled);
        let area: f64 = s.points.iter().map(|p| p.volume).sum();
        assert!((area - 112.5).abs() < 1e-10, "{area}");
    }

    #[test]
    fn the_refined_mesh_has_29_rows() {
        assert_eq!(slope(5.0 / 29.0, CutRule::Full).cells, 116 * 29 + 29 * 28 / 2 + 29);
    }
}
