//! The step over full blocks against the same stages taken point by point, and against itself on
//! every instruction path.
//!
//! Point by point means a body whose points are groups of their own: a block then holds one point and
//! each run is one point long, so that nothing is summed but on the nodes.

use rmpm::{
    assembly::{Scatter, Scratch, Strain},
    block::PointLaw,
    body::{Body, Column, GroupSeed, Seedling, State},
    kinematics::{Hencky, Kinematics, Rate, StrengthMeasure},
    material::{Elasticity, VonMises},
    math::simd::FpPath,
    nodes::Nodes,
    space::{BSpline, Gimp, GimpWide, Grid, Linear, Shape},
    transfer::{Carrier, Push, Transfer},
};

const GRID: Grid = Grid { origin: [-1.0, 0.5], h: 0.5, cells: [9, 7] };

/// Numbers in [0, 1) that look random (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// Points with their cohesion.
type Points = Vec<(Seedling, f64)>;

/// A body of one group, or of one group a point.
fn body<K: Kinematics>(points: &Points, path: FpPath, alone: bool) -> Body {
    let e = Elasticity::from_young(1000.0, 0.33);
    let group = |points: &[(Seedling, f64)]| GroupSeed {
        material: 0,
        law: Box::new(PointLaw::<VonMises, K>::new(VonMises, StrengthMeasure::Cauchy).on(path)),
        params: [e.shear_modulus, e.bulk_modulus, 0.0, 4.0, -50.0, 3f64.sqrt()]
            .into_iter()
            .enumerate()
            .map(
                |(k, v)| {
                    if k == 2 { Column::Varying(points.iter().map(|p| p.1).collect()) } else { Column::Uniform(v) }
                },
            )
            .collect(),
        points: points.iter().map(|p| p.0.clone()).collect(),
    };
    let mut body = Body::new(points.chunks(if alone { 1 } else { points.len() }).map(group).collect());
    body.track_domains();
    body
}

/// Points anywhere two cells and more from the sides, ordered by cells so that runs are of all lengths.
fn anywhere(r: &mut Random, n: usize) -> Points {
    let mut points: Points = (0..n)
        .map(|_| {
            let x = [r.within(0.0, 2.5), r.within(1.5, 3.0)];
            let v = [r.within(-1.0, 1.0), r.within(-1.0, 1.0)];
            let seed = Seedling { x, v, mass: r.within(0.05, 0.2), volume: r.within(0.03, 0.1), ..Seedling::default() };
            (seed, r.within(5.0, 20.0))
        })
        .collect();
    points.sort_by_key(|(p, _)| [(p.x[1] / GRID.h) as u32, (p.x[0] / GRID.h) as u32]);
    points
}

/// Any strain, J, history and domain: elastic, softening and residual points.
fn strained(body: &mut Body, seed: u64) {
    let (r, s) = (&mut Random(seed), &mut body.committed);
    for i in 0..s.jacobian.len() {
        s.strain.iter_mut().for_each(|c| c[i] = r.within(-0.01, 0.01));
        s.jacobian[i] = r.within(0.95, 1.05);
        s.history[0][i] = r.within(-0.1, 0.4).max(0.0);
        for (column, at) in s.deformation.iter_mut().zip([1.0, 0.0, 0.0, 1.0]) {
            column[i] = at + r.within(-0.05, 0.05);
        }
    }
}

/// One MUSL step without supports; the plastic work.
fn step<S: Shape<N>, const N: usize>(shape: S, body: &mut Body, gravity: f64, dt: f64, path: FpPath) -> f64 {
    let (mut nodes, mut scratch) = (Nodes::new(GRID), Box::<Scratch<N>>::default());
    let s = scratch.as_mut();
    path.run(Scatter { scratch: s, body, nodes: &mut nodes, cells: None, stretch: 0..body.len(), shape });
    let inverse: Vec<f64> = nodes.mass[..nodes.count].iter().map(|m| if *m > 0.0 { 1.0 / m } else { 0.0 }).collect();
    for (axis, g) in [0.0, gravity].into_iter().enumerate() {
        for (i, inverse) in inverse.iter().enumerate() {
            let old = nodes.momentum[axis][i] * inverse;
            nodes.old_velocity[axis][i] = old;
            nodes.velocity[axis][i] = old + dt * (nodes.force[axis][i] * inverse + g);
            nodes.momentum[axis][i] = 0.0;
        }
    }
    body.apart(|body, part| {
        let push = Push { scratch: s, body, part, nodes: &mut nodes, dt, remap: true, shape };
        Carrier::new(Transfer::Flip { pic_rate: 0.5 }).push(push, path).unwrap();
    });
    for axis in 0..2 {
        for (i, inverse) in inverse.iter().enumerate() {
            nodes.strain_velocity[axis][i] = nodes.momentum[axis][i] * inverse;
        }
    }
    let nodes = &nodes;
    let work =
        body.apart(|body, part| path.run(Strain { scratch: s, body, part, nodes, cells: None, dt, shape })).unwrap();
    body.commit();
    work
}

fn columns(s: &State) -> Vec<&[f64]> {
    let parts = [&s.x[..], &s.v, &s.strain, std::slice::from_ref(&s.jacobian), &s.history, &s.deformation];
    parts.into_iter().flatten().map(|c| &c[..]).collect()
}

/// Largest difference of two states, each column by its own largest number.
fn gap(a: &Body, b: &Body) -> f64 {
    let size = |c: &[f64]| c.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let pairs = columns(&a.committed).into_iter().zip(columns(&b.committed));
    let gaps = pairs.map(|(a, b)| {
        assert!(a.iter().chain(b).all(|v| v.is_finite()));
        let apart = a.iter().zip(b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        apart / size(b).max(f64::MIN_POSITIVE)
    });
    gaps.fold(0.0, f64::max)
}

fn bits(body: &Body) -> Vec<u64> {
    columns(&body.committed).into_iter().flatten().map(|v| v.to_bits()).collect()
}

/// One step from 250 random states: (largest difference from point by point, whether something flowed).
fn from_random_states<S: Shape<N>, K: Kinematics, const N: usize>(shape: S) -> (f64, bool) {
    let (mut worst, mut flowed) = (0.0f64, false);
    for state in 0..250 {
        let points = anywhere(&mut Random(state), 33 + (state as usize * 7) % 60);
        let run = |path: FpPath, alone: bool| {
            let mut body = body::<K>(&points, path, alone);
            strained(&mut body, state);
            let work = step(shape, &mut body, -9.81, 0.002, path);
            (body, work)
        };
        let (alone, work) = run(FpPath::BASELINE, true);
        let (full, full_work) = run(FpPath::BASELINE, false);
        worst = worst.max(gap(&full, &alone)).max((full_work - work).abs() / work.max(1e-3));
        flowed |= work > 0.0;
        for path in FpPath::all() {
            let (wide, wide_work) = run(path, false);
            assert!(bits(&wide) == bits(&full) && wide_work.to_bits() == full_work.to_bits(), "{path}");
        }
    }
    (worst, flowed)
}

/// Over 1,000 states in all. The sums of a run are rounded in another order than those of its points
/// on the nodes: some hundred roundings of 1e-16.
#[test]
fn a_step_over_blocks_is_the_step_point_by_point() {
    let found = [
        from_random_states::<_, Hencky, 4>(Linear),
        from_random_states::<_, Rate, 4>(Linear),
        from_random_states::<_, Hencky, 9>(Gimp),
        from_random_states::<_, Hencky, 16>(GimpWide),
        from_random_states::<_, Hencky, 9>(BSpline),
    ];
    assert!(found.iter().all(|(worst, flowed)| *worst < 1e-13 && *flowed), "{found:?}");
}

/// A block of elastic soil that swings freely, over some ten periods: no point changes its cell, and
/// nothing makes the differences grow.
#[test]
fn a_smooth_run_over_blocks_is_the_run_point_by_point() {
    let at = |i: usize| 0.5 * (i / 2) as f64 + 0.5 * [0.211_324_865, 0.788_675_135][i % 2];
    let mut points = Points::new();
    for (j, i) in (0..6).flat_map(|j| (0..8).map(move |i| (j, i))) {
        let x = [at(i), 1.5 + at(j)];
        let v = [0.05 * (std::f64::consts::PI * x[0] / 2.0).cos(), 0.0];
        points.push((Seedling { x, v, mass: 0.125, volume: 0.0625, ..Seedling::default() }, 1e6));
    }
    let [mut full, mut alone] = [false, true].map(|alone| body::<Hencky>(&points, FpPath::best(), alone));
    let start = full.committed.v[0].to_vec();
    for _ in 0..2000 {
        for body in [&mut full, &mut alone] {
            step(Linear, body, 0.0, 0.001, FpPath::best());
        }
    }
    assert!(full.committed.v[0].iter().zip(&start).any(|(v, s)| (v - s).abs() > 0.01));
    assert!(gap(&full, &alone) < 1e-9, "{:e}", gap(&full, &alone));
}
