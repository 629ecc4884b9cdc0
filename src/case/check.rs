//! What no key shows alone: regions against materials, the grid and each other; the size of a run.

use std::collections::BTreeMap;

use super::limits::{figure, rounded};
use super::log::{Log, Problem};
use super::outline::place;
use super::source::Span;
use super::suggest;
use super::{Case, Grid, Material, Region, RegionShape, Scheme, ShapeFunctions, Transfer};
use crate::math::polygon::Point;

/// Most cells of a grid.
const MOST_CELLS: f64 = 4e9;

/// Most memory that a case may ask for (bytes); a run has its own, smaller cap.
const MOST_MEMORY: u64 = 64 << 30;

/// Most findings of one kind between regions.
const MOST_OVERLAPS: usize = 20;

/// The grid, and where its cell size stands.
pub(super) struct PlacedGrid {
    /// The grid.
    pub value: Grid,
    /// The value of `grid.cell`.
    pub cell_at: Span,
}

/// Materials by name, each with the place of its name; `None` for one with errors.
pub(super) struct Materials {
    /// Place and value by name.
    pub by_name: BTreeMap<String, (Span, Option<Material>)>,
}

impl Materials {
    /// All materials, if none has errors.
    pub fn complete(self) -> Option<BTreeMap<String, Material>> {
        self.by_name.into_iter().map(|(name, (_, material))| Some((name, material?))).collect()
    }
}

/// A region, and where its parts stand.
pub(super) struct PlacedRegion {
    /// Path such as `region.0`.
    pub path: String,
    /// The name, or the header of the region.
    pub name_at: Span,
    /// The name of the material.
    pub material_at: Span,
    /// The key `polygon` or `circle`.
    pub shape_at: Span,
    /// The corners of a polygon.
    pub corners_at: Vec<Span>,
    /// The region; `None` if it has errors.
    pub value: Option<Region>,
}

/// Checks the regions against everything around them.
pub(super) fn regions(
    log: &Log,
    grid: Option<&PlacedGrid>,
    materials: Option<&Materials>,
    regions: Option<&[PlacedRegion]>,
) {
    let Some(regions) = regions else { return };
    if let Some(materials) = materials {
        known_materials(log, materials, regions);
        unused_materials(log, materials, regions);
    }
    if let Some(grid) = grid {
        let found = regions.iter().filter_map(|placed| Some((placed, placed.value.as_ref()?)));
        found.for_each(|(placed, region)| inside_grid(log, &grid.value, placed, region));
    }
    unlike_names(log, regions);
    no_overlap(log, regions);
}

fn known_materials(log: &Log, materials: &Materials, regions: &[PlacedRegion]) {
    for placed in regions {
        let Some(region) = &placed.value else { continue };
        if materials.by_name.contains_key(&region.material) {
            continue;
        }
        let names = || materials.by_name.keys().map(String::as_str);
        let message = format!("unknown material `{}`", region.material);
        let label = format!("the materials are {}", suggest::list(names()));
        let help = suggest::did_you_mean(&region.material, names());
        let path = format!("{}.material", placed.path);
        log.error(placed.material_at, &path, Problem::new(message, label).help_if(help));
    }
}

fn unused_materials(log: &Log, materials: &Materials, regions: &[PlacedRegion]) {
    if regions.iter().any(|region| region.value.is_none()) {
        return;
    }
    for (name, (at, _)) in &materials.by_name {
        let used = regions.iter().filter_map(|r| r.value.as_ref()).any(|r| r.material == *name);
        if !used {
            let message = format!("material `{name}` is not used");
            let problem = Problem::new(message, "no region is made of it");
            log.warning(*at, &format!("material.{name}"), problem);
        }
    }
}

fn unlike_names(log: &Log, regions: &[PlacedRegion]) {
    let mut seen = BTreeMap::new();
    for placed in regions {
        let Some(region) = &placed.value else { continue };
        if let Some(first) = seen.insert(region.name.as_str(), &placed.path) {
            let message = format!("two regions have the name \"{}\"", region.name);
            let label = format!("`{first}` has this name");
            log.error(placed.name_at, &format!("{}.name", placed.path), Problem::new(message, label));
        }
    }
}

fn inside_grid(log: &Log, grid: &Grid, placed: &PlacedRegion, region: &Region) {
    let [low, high] = grid.bounds();
    let slack = 1e-9 * (high[0] - low[0]).max(high[1] - low[1]);
    let outside = |p: &Point| (0..2).any(|k| p[k] < low[k] - slack || p[k] > high[k] + slack);
    let (at, what) = match &region.shape {
        RegionShape::Polygon(corners) => {
            let Some(index) = corners.iter().position(outside) else { return };
            let at = placed.corners_at.get(index).copied().unwrap_or(placed.shape_at);
            (at, format!("corner {}", corners.get(index).copied().map(place).unwrap_or_default()))
        }
        RegionShape::Circle { .. } => {
            let ends = region.shape.bounds();
            if !ends.iter().any(outside) {
                return;
            }
            (placed.shape_at, format!("the circle from {} to {}", place(ends[0]), place(ends[1])))
        }
    };
    let message = format!("region \"{}\" leaves the grid: {what}", region.name);
    let label = format!("the grid reaches from {} to {}", place(low), place(high));
    let problem = Problem::new(message, label).help("change `grid.origin` or `grid.size`");
    log.error(at, &placed.path, problem);
}

fn no_overlap(log: &Log, regions: &[PlacedRegion]) {
    let found: Vec<_> = regions.iter().filter_map(|p| Some((p, p.value.as_ref()?))).collect();
    let pairs = found.iter().enumerate().flat_map(|(k, a)| found.iter().skip(k + 1).map(move |b| (a.1, b.0, b.1)));
    let overlaps = pairs
        .filter_map(|(first, placed, second)| Some((first, placed, second, overlap(&first.shape, &second.shape)?)));
    for (first, placed, second, area) in overlaps.take(MOST_OVERLAPS) {
        let message = format!("regions \"{}\" and \"{}\" overlap", first.name, second.name);
        let label = format!("{} m2 lie in both", rounded(area));
        let help = "regions may touch, but each point of the soil lies in one region only";
        log.error(placed.shape_at, &placed.path, Problem::new(message, label).help(help));
    }
}

/// The area common to two shapes, if it is more than round-off (1e-9 of the smaller one).
fn overlap(a: &RegionShape, b: &RegionShape) -> Option<f64> {
    let ([low_a, high_a], [low_b, high_b]) = (a.bounds(), b.bounds());
    if (0..2).any(|k| low_a[k] >= high_b[k] || low_b[k] >= high_a[k]) {
        return None;
    }
    let area = a.overlap_area(b);
    (area > 1e-9 * a.area().min(b.area())).then_some(area)
}

impl Grid {
    /// Cells along x and y, as numbers that may be too large to count.
    pub(super) fn cells(&self) -> [f64; 2] {
        self.size.map(|length| (length / self.cell - 1e-9).ceil().max(1.0))
    }

    /// Lower left and upper right corner, with `size` rounded up to whole cells.
    pub(super) fn bounds(&self) -> [Point; 2] {
        let [nx, ny] = self.cells();
        let [x, y] = self.origin;
        [[x, y], [x + nx * self.cell, y + ny * self.cell]]
    }
}

impl Case {
    /// A rough upper bound on the memory of a run (bytes): 4 per node of the grid and 700 per
    /// point, 64 more for the columns of APIC, the points counted from the area of the regions plus a tenth for cut cells; with the
    /// implicit scheme also its equations, by the cell.
    pub fn memory_estimate_bytes(&self) -> u64 {
        let [nx, ny] = self.grid.cells();
        let area: f64 = self.region.iter().map(|region| region.shape.area()).sum();
        let per_cell = (self.points.per_axis * self.points.per_axis) as f64;
        let full_cells = 1.1 * area / (self.grid.cell * self.grid.cell);
        let soil = full_cells * (self.bytes_per_point() * per_cell + self.equations_bytes_per_cell());
        (4.0 * (nx + 1.0) * (ny + 1.0) + soil) as u64
    }

    fn bytes_per_point(&self) -> f64 {
        if self.solver.transfer == Transfer::Apic { 764.0 } else { 700.0 }
    }

    /// Stencils, tangent and factors, measured at 11,000 cells with room for LU; they grow a little
    /// faster than the cells.
    fn equations_bytes_per_cell(&self) -> f64 {
        match (self.solver.scheme, self.solver.shape) {
            (Scheme::Explicit, _) => 0.0,
            (Scheme::Implicit, ShapeFunctions::Linear) => 20e3,
            (Scheme::Implicit, ShapeFunctions::Gimp | ShapeFunctions::Bspline) => 50e3,
            (Scheme::Implicit, ShapeFunctions::GimpWide) => 100e3,
        }
    }
}

/// Whether grid and points fit a machine; notes an error at the cell size if not.
pub(super) fn size(log: &Log, cell_at: Span, case: &Case) -> bool {
    let [nx, ny] = case.grid.cells();
    let bytes = case.memory_estimate_bytes();
    let gibibytes = rounded(bytes as f64 / (1u64 << 30) as f64);
    let message = if nx * ny > MOST_CELLS {
        format!("the grid has {} x {} cells", rounded(nx), rounded(ny))
    } else if bytes > MOST_MEMORY {
        format!("this case needs about {gibibytes} GiB of memory")
    } else {
        return true;
    };
    let label = format!("at most {} cells and {} GiB", figure(MOST_CELLS), MOST_MEMORY >> 30);
    let help = format!("raise `grid.cell`, or lower `grid.size` or `points.per_axis` (now about {gibibytes} GiB)");
    log.error(cell_at, "grid.cell", Problem::new(message, label).help(help));
    false
}
