//! The average of the plastic strain that nonlocal softening follows, between two steps.
//!
//! ```text
//! kappa = max(0, (1 - m) eps_p + m <eps_p>),   <eps_p>(x) = int w(|x - y|) eps_p(y) dy / int w(|x - y|) dy
//! w(r) = exp(-r^2 / l^2): variance l^2 / 2 along each axis
//! ```
//! (Vermeer & Brinkgreve 1994, who show that m = 1 does not limit the localisation of linear softening.) What is
//! averaged is always the strain of the points themselves, never an average: nothing diffuses from step to step. No
//! point becomes stronger than its peak, hence max(0, .).
//!
//! Points do not look for each other. Volume and volume times strain go to the nodes with the shape functions, are
//! smoothed there by one discrete kernel along x and y, and their ratio comes back to the points: O(nodes x width).
//! The two maps smear by themselves, with the variance sum N_i (x_i - x)^2 each. The kernel has the variance that is
//! left over of l^2 / 2, exactly (`kernel`). An average stays within the points of one material.

use super::{Scratch, place};
use crate::{
    body::{Body, chunks},
    math::simd::Kernel,
    nodes::Nodes,
    space::{
        Grid, Shape, Stencil,
        stencil::{LANES, Lane},
    },
};

/// History columns of a law that softens nonlocally: what is averaged, and where kappa goes.
const PLASTIC: usize = 0;
const SOFTENING: usize = 1;

/// The average of one group of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Average {
    /// Number of the group in the body.
    pub group: usize,
    /// l (m).
    pub length: f64,
    /// m.
    pub weight: f64,
}

/// The averages of a body, with their arrays over the nodes of the grid.
pub struct Nonlocal {
    averages: Vec<(Average, Vec<f64>)>,
    volume: Vec<f64>,
    strain: Vec<f64>,
    spare: Vec<f64>,
}

impl Nonlocal {
    /// For points with a shape on a grid.
    pub fn new<S: Shape<N>, const N: usize>(grid: &Grid, body: &Body, averages: Vec<Average>) -> Self {
        let with_kernel = |average: Average| {
            let half = body.groups.get(average.group).map_or(0.0, |g| 0.5 * mean_side(body, &g.range));
            let maps = 2.0 * map_variance::<S, N>(half / grid.h);
            let taps = kernel(0.5 * (average.length / grid.h).powi(2) - maps);
            (average, taps)
        };
        let column = || vec![0.0; grid.nodes()];
        Nonlocal {
            averages: averages.into_iter().map(with_kernel).collect(),
            volume: column(),
            strain: column(),
            spare: column(),
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        24 * self.volume.len()
    }
}

/// Mean side of the points' squares (m).
fn mean_side(body: &Body, range: &std::ops::Range<usize>) -> f64 {
    let n = range.len().max(1) as f64;
    range.clone().map(|i| body.volume[i].sqrt()).sum::<f64>() / n
}

/// Variance along an axis, in cells squared, of going from points to nodes: sum N_i (x_i - x)^2, the mean over the
/// places in a cell. For bilinear functions 1/6, which is also its value at the Gauss points 2 x 2.
fn map_variance<S: Shape<N>, const N: usize>(half: f64) -> f64 {
    let grid = Grid { origin: [0.0; 2], h: 1.0, cells: [8, 8] };
    let x: Lane = std::array::from_fn(|i| 3.0 + (i as f64 + 0.5) / LANES as f64);
    let mut s = Box::<Stencil<N>>::default();
    S::fill(&grid, &x, &[3.5; LANES], &[[half; LANES]; 2], &mut s);
    let offsets = S::offsets(grid.row());
    let of_point = |i: usize| -> f64 {
        let square = |k: usize| (grid.node_position(s.base[i] + offsets[k])[0] - x[i]).powi(2);
        (0..N).map(|k| s.weight(k, i) * square(k)).sum()
    };
    (0..LANES).map(of_point).sum::<f64>() / LANES as f64
}

/// Weights at 0, 1, 2 ... cells of a symmetric kernel of sum 1 and of this variance (cells squared): those of a
/// Gaussian whose width makes the variance of the sampled and cut kernel exact. One weight where nothing is left.
fn kernel(variance: f64) -> Vec<f64> {
    if variance <= 0.0 {
        return vec![1.0];
    }
    let reach = (4.0 * variance.sqrt()).ceil() as usize + 1;
    let taps = |width: f64| -> Vec<f64> {
        let raw = |t: usize| (-((t * t) as f64) / (2.0 * width)).exp();
        let sum = 1.0 + 2.0 * (1..=reach).map(raw).sum::<f64>();
        (0..=reach).map(|t| raw(t) / sum).collect()
    };
    let (mut low, mut high) = (1e-3, 4.0 * variance + 4.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if spread(&taps(middle)) < variance { low = middle } else { high = middle }
    }
    taps(0.5 * (low + high))
}

/// Variance of a symmetric kernel (cells squared).
fn spread(taps: &[f64]) -> f64 {
    2.0 * taps.iter().enumerate().map(|(t, w)| (t * t) as f64 * w).sum::<f64>()
}

/// Writes kappa of the committed body.
pub struct Soften<'a, S, const N: usize> {
    pub scratch: &'a mut Scratch<N>,
    pub body: &'a mut Body,
    pub nodes: &'a Nodes,
    /// The stencils of all blocks where they are kept; they are filled anew without.
    pub kept: Option<&'a [Stencil<N>]>,
    pub nonlocal: &'a mut Nonlocal,
    pub shape: S,
}

impl<S: Shape<N>, const N: usize> Kernel for Soften<'_, S, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Soften { scratch, body, nodes, kept, nonlocal, .. } = self;
        let Nonlocal { averages, volume, strain, spare } = nonlocal;
        for (average, taps) in averages.iter() {
            let window = Window::around::<S, N>(&nodes.grid, body, average.group);
            window.clear(volume);
            window.clear(strain);
            gather::<S, N>(scratch, body, nodes, kept, average.group, volume, strain);
            window.smooth(taps, volume, spare);
            window.smooth(taps, strain, spare);
            window.divide(strain, volume);
            give::<S, N>(scratch, body, nodes, kept, average, strain);
        }
    }
}

/// Block number of the first block of a group.
fn first_block(body: &Body, group: usize) -> usize {
    body.groups[..group].iter().map(|g| chunks(g.range.clone()).count()).sum()
}

/// Sums of N V and of N V eps_p on the nodes, V being the present volume.
#[inline(always)]
fn gather<S: Shape<N>, const N: usize>(
    s: &mut Scratch<N>,
    body: &Body,
    nodes: &Nodes,
    kept: Option<&[Stencil<N>]>,
    group: usize,
    volume: &mut [f64],
    strain: &mut [f64],
) {
    let offsets = S::offsets(nodes.grid.row());
    let first = first_block(body, group);
    for (block, range) in chunks(body.groups[group].range.clone()).enumerate() {
        let stencil = stencil_of::<S, N>(s, body, nodes, kept, first + block, &range);
        for (lane, i) in range.enumerate() {
            let v = body.volume[i] * body.committed.jacobian[i];
            let ve = v * body.committed.history[PLASTIC][i];
            for k in 0..N {
                let node = (stencil.base[lane] + offsets[k]) as usize;
                volume[node] += stencil.weight(k, lane) * v;
                strain[node] += stencil.weight(k, lane) * ve;
            }
        }
    }
}

/// kappa of the points from the average on the nodes.
#[inline(always)]
fn give<S: Shape<N>, const N: usize>(
    s: &mut Scratch<N>,
    body: &mut Body,
    nodes: &Nodes,
    kept: Option<&[Stencil<N>]>,
    average: &Average,
    mean: &[f64],
) {
    let offsets = S::offsets(nodes.grid.row());
    let first = first_block(body, average.group);
    let m = average.weight;
    for (block, range) in chunks(body.groups[average.group].range.clone()).enumerate() {
        let stencil = stencil_of::<S, N>(s, body, nodes, kept, first + block, &range);
        for (lane, i) in range.enumerate() {
            let around: f64 =
                (0..N).map(|k| stencil.weight(k, lane) * mean[(stencil.base[lane] + offsets[k]) as usize]).sum();
            let own = body.committed.history[PLASTIC][i];
            body.committed.history[SOFTENING][i] = ((1.0 - m) * own + m * around).max(0.0);
        }
    }
}

/// The stencil of a block of the committed body.
#[inline(always)]
fn stencil_of<'s, S: Shape<N>, const N: usize>(
    s: &'s mut Scratch<N>,
    body: &Body,
    nodes: &Nodes,
    kept: Option<&'s [Stencil<N>]>,
    block: usize,
    range: &std::ops::Range<usize>,
) -> &'s Stencil<N> {
    match kept {
        Some(kept) => &kept[block],
        None => {
            place::<S, N>(s, body, nodes, range);
            &s.stencil
        }
    }
}

/// The nodes that a group may reach, as a rectangle of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Window {
    /// Nodes in a row of the grid.
    row: usize,
    low: [usize; 2],
    /// One past the last.
    high: [usize; 2],
}

impl Window {
    /// Around the points of a group, and a cell wider than their patches: a kept stencil is one step old.
    fn around<S: Shape<N>, const N: usize>(grid: &Grid, body: &Body, group: usize) -> Self {
        let range = body.groups[group].range.clone();
        let margin = f64::from(S::SPAN) + 1.0;
        let bound = |axis: usize| {
            let x = &body.committed.x[axis][range.clone()];
            let (low, high) = x.iter().fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
            let cells = |x: f64| (x - grid.origin[axis]) / grid.h;
            let last = f64::from(grid.cells[axis]) + 1.0;
            [(cells(low) - margin).clamp(0.0, last) as usize, (cells(high) + margin + 1.0).clamp(0.0, last) as usize]
        };
        let [x, y] = [bound(0), bound(1)];
        Window { row: grid.row() as usize, low: [x[0], y[0]], high: [x[1], y[1]] }
    }

    fn rows(&self) -> impl Iterator<Item = std::ops::Range<usize>> + use<> {
        let Window { row, low, high } = *self;
        (low[1]..high[1]).map(move |y| y * row + low[0]..y * row + high[0])
    }

    fn clear(&self, column: &mut [f64]) {
        self.rows().for_each(|r| column[r].fill(0.0));
    }

    /// top / bottom, 0 where there is nothing.
    fn divide(&self, top: &mut [f64], bottom: &[f64]) {
        for r in self.rows() {
            top[r.clone()].iter_mut().zip(&bottom[r]).for_each(|(t, b)| *t = if *b > 0.0 { *t / b } else { 0.0 });
        }
    }

    /// The kernel along x, then along y.
    #[inline(always)]
    fn smooth(&self, taps: &[f64], column: &mut [f64], spare: &mut [f64]) {
        for r in self.rows() {
            sum_shifted(taps, 1, [r.start, r.end], &r, column, spare);
        }
        let span = [self.low[1], self.high[1]].map(|y| y * self.row);
        for r in self.rows() {
            sum_shifted(taps, self.row, [span[0], span[1]], &r, spare, column);
        }
    }
}

/// out_i = sum over t of taps_|t| in_(i + t stride), for the nodes of a stretch of a row; what lies outside `span` is 0.
#[inline(always)]
fn sum_shifted(
    taps: &[f64],
    stride: usize,
    span: [usize; 2],
    stretch: &std::ops::Range<usize>,
    from: &[f64],
    out: &mut [f64],
) {
    let out = &mut out[stretch.clone()];
    out.iter_mut().zip(&from[stretch.clone()]).for_each(|(o, v)| *o = taps[0] * v);
    for (t, w) in taps.iter().enumerate().skip(1) {
        let shift = t * stride;
        // in_(i - shift) for i - shift >= span start, and in_(i + shift) for i + shift < span end
        let first = stretch.start.max(span[0] + shift);
        if first < stretch.end {
            let source = &from[first - shift..stretch.end - shift];
            out[first - stretch.start..].iter_mut().zip(source).for_each(|(o, v)| *o += w * v);
        }
        let last = stretch.end.min(span[1].saturating_sub(shift));
        if stretch.start < last {
            let source = &from[stretch.start + shift..last + shift];
            out.iter_mut().zip(source).for_each(|(o, v)| *o += w * v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        block::PointLaw,
        body::{Column, GroupSeed, Seedling},
        kinematics::{Small, StrengthMeasure},
        material::NonlocalVonMises,
        math::simd::FpPath,
        space::{Gimp, Linear, gauss},
    };

    const CELLS: u32 = 36;
    const H: f64 = 0.5;
    /// l, in m: four cells.
    const LENGTH: f64 = 2.0;

    fn grid() -> Grid {
        Grid { origin: [-1.0, 2.0], h: H, cells: [CELLS, CELLS] }
    }

    /// A square of soil over the grid, 2 x 2 points a cell at these places.
    fn soil(places: &[f64]) -> Body {
        let side: Vec<f64> = (0..CELLS).flat_map(|c| places.iter().map(move |p| H * (f64::from(c) + p))).collect();
        let point =
            |x: f64, y: f64| Seedling { x: [x - 1.0, y + 2.0], mass: 1.0, volume: 0.25 * H * H, ..Default::default() };
        let points = side.iter().flat_map(|y| side.iter().map(move |x| point(*x, *y))).collect();
        let law = Box::new(PointLaw::<NonlocalVonMises, Small>::new(NonlocalVonMises, StrengthMeasure::Cauchy));
        let params = [100.0, 200.0, 20.0, 4.0, -50.0, 1.7].map(Column::Uniform).to_vec();
        let mut body = Body::new(vec![GroupSeed { material: 0, law, params, points }]);
        body.track_domains();
        body
    }

    /// kappa of a body whose plastic strain is a function of the place.
    fn soften<S: Shape<N>, const N: usize>(shape: S, weight: f64, body: &mut Body, eps: impl Fn([f64; 2]) -> f64) {
        for i in 0..body.len() {
            body.committed.history[PLASTIC][i] = eps([body.committed.x[0][i], body.committed.x[1][i]]);
        }
        let mut nonlocal = Nonlocal::new::<S, N>(&grid(), body, vec![Average { group: 0, length: LENGTH, weight }]);
        let (mut scratch, nodes) = (Box::<Scratch<N>>::default(), Nodes::new(grid()));
        let (scratch, nonlocal) = (scratch.as_mut(), &mut nonlocal);
        FpPath::best().run(Soften { scratch, body, nodes: &nodes, kept: None, nonlocal, shape });
    }

    fn is_linear_inside_and_constant_everywhere<S: Shape<N>, const N: usize>(shape: S, places: &[f64]) {
        let mut body = soil(places);
        soften(shape, 2.0, &mut body, |_| 0.3);
        assert!(body.committed.history[SOFTENING].iter().all(|k| (k - 0.3).abs() < 1e-14));
        let field = |[x, y]: [f64; 2]| 10.0 + 0.2 * x - 0.1 * y;
        soften(shape, 2.0, &mut body, field);
        let mut seen = 0;
        for i in 0..body.len() {
            let x = [body.committed.x[0][i], body.committed.x[1][i]];
            // the sides are 8.7 m away, the kernel reaches 6.5 m and the two maps 0.75 m each
            if (0..2).all(|a| (x[a] - grid().origin[a] - 9.0).abs() < 0.3) {
                assert!((body.committed.history[SOFTENING][i] - field(x)).abs() < 1e-9, "{x:?}");
                seen += 1;
            }
        }
        assert!(seen > 0);
    }

    #[test]
    fn a_linear_field_is_its_own_average() {
        is_linear_inside_and_constant_everywhere(Linear, &gauss::gauss(2));
        is_linear_inside_and_constant_everywhere(Gimp, &gauss::even(2));
    }

    /// Variance along x of the average of a column of strained points, in the middle.
    fn variance<S: Shape<N>, const N: usize>(shape: S, places: &[f64]) -> f64 {
        let mut body = soil(places);
        let column = H * (0.5 * f64::from(CELLS) + places[0]) - 1.0;
        soften(shape, 1.0, &mut body, |[x, _]| if (x - column).abs() < 1e-9 { 1.0 } else { 0.0 });
        let moment = |power: i32| -> f64 {
            let x = body.committed.x[0].iter().zip(body.committed.history[SOFTENING].iter());
            x.map(|(x, k)| k * (x - column).powi(power)).sum()
        };
        moment(2) / moment(0)
    }

    /// l^2 / 2, of map, kernel and map back together. The map's own variance is a mean over 32 places in a cell: off by
    /// 1e-4 cells squared, of 8.
    #[test]
    fn the_variance_is_that_of_the_gaussian() {
        for found in [variance(Linear, &gauss::gauss(2)), variance(Gimp, &gauss::even(2))] {
            assert!((found / (0.5 * LENGTH * LENGTH) - 1.0).abs() < 1e-4, "{found}");
        }
    }

    #[test]
    fn a_kernel_has_the_variance_asked_for_and_no_point_gains_strength() {
        for asked in [0.05, 0.4, 3.0] {
            let taps = kernel(asked);
            assert!(
                (spread(&taps) - asked).abs() < 1e-9 && (2.0 * taps.iter().sum::<f64>() - taps[0] - 1.0).abs() < 1e-12
            );
        }
        assert_eq!(kernel(-0.1), [1.0]);
        let mut body = soil(&gauss::gauss(2));
        let first = [body.committed.x[0][0], body.committed.x[1][0]];
        soften(Linear, 2.0, &mut body, |x| if x == first { 1.0 } else { 0.0 });
        assert_eq!(body.committed.history[SOFTENING][0], 0.0);
        assert!(body.committed.history[SOFTENING][1] > 0.0);
    }
}
