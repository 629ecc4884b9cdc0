//! The tangent against finite differences of the residual.

use super::*;
use crate::{
    block::{Law, PointLaw},
    body::{Column, GroupSeed, Seedling},
    effect::{Friction, Ghost, Support},
    kinematics::{Hencky, Kinematics, Small, StrengthMeasure},
    material::{Columns, Elasticity, Strength, VonMises},
    math::tensor::Voigt,
    space::{BSpline, Gimp, Linear, grid::Side},
};

/// A number in (-1, 1) that looks random.
fn noise(k: usize) -> f64 {
    2.0 * ((k as f64 * 12.9898 + 4.1).sin() * 43758.5453).fract().abs() - 1.0
}

fn clay(cohesion: f64) -> Strength {
    Strength {
        elasticity: Elasticity::from_young(1000.0, 0.3),
        cohesion,
        residual_cohesion: 0.2 * cohesion,
        softening_modulus: -50.0,
        yield_constant: 3f64.sqrt(),
    }
}

/// 3 x 2 cells of 4 points each, moved about a little, under stress and at velocity.
fn body(law: Box<dyn Law>, p: Strength) -> Body {
    let mut points = Vec::new();
    for k in 0..24 {
        let (cell, q) = (k / 4, k % 4);
        let local = |a: usize| 0.25 + 0.5 * ((q >> a) & 1) as f64 + 0.1 * noise(7 * k + a);
        let x = [0.5 * ((cell % 3) as f64 + local(0)), 0.5 * ((cell / 3) as f64 + local(1))];
        let stress = Voigt::new(noise(k) * 5.0, noise(k + 50) * 5.0, noise(k + 99) * 5.0, noise(k + 200) * 5.0);
        let v = [0.3 * noise(k + 300), 0.3 * noise(k + 400)];
        points.push(Seedling { x, v, mass: 0.1 * (1.2 + noise(k + 500)), volume: 0.0625, stress });
    }
    let mut params = vec![Column::Uniform(0.0); Strength::NAMES.len()];
    p.write(|k, v| params[k] = Column::Uniform(v));
    Body::new(vec![GroupSeed { material: 0, law, params, points }])
}

struct Setting {
    regime: Regime,
    smooth: bool,
    effects: Vec<Box<dyn Effect>>,
}

fn integrator<S: Shape<N>, const N: usize>(shape: S, setting: Setting) -> Implicit<S, N> {
    let grid = Grid { origin: [0.0, 0.0], h: 0.5, cells: [5, 4] };
    let settings = Settings {
        regime: setting.regime,
        tolerances: Tolerances { relative: 1e-12, absolute: 0.0, max_iterations: 30 },
        line_search: true,
        min_time_step: 0.0,
        smooth: setting.smooth,
        tolerance: None,
        transfer: Transfer::Flip { pic_rate: 0.0 },
        solver: Options::default(),
    };
    Implicit::new(shape, grid, settings, setting.effects)
}

const CLOCK: Clock = Clock { time: 0.0, dt: 0.05 };

/// Largest gap between the tangent and central differences of the residual, over the largest entry.
///
/// The error of a difference is h^2 r''' + rounding / h: at h = 1e-6 of a strain of order 1 both
/// are below 1e-8 of the stiffness.
fn tangent_error<S: Shape<N>, const N: usize>(shape: S, mut body: Body, setting: Setting, amplitude: f64) -> f64 {
    if S::DOMAIN {
        body.track_domains();
    }
    let mut i = integrator(shape, setting);
    let mut work = Work::default();
    let weights = i.inertia.as_ref().map(|n| n.scheme.weights(CLOCK.dt));
    i.place(&body, &mut work);
    i.start(&mut body, CLOCK, weights).expect("a start");
    let n = i.nodes.count;
    for axis in 0..2 {
        for slot in 0..n {
            i.system.du[axis][slot] = amplitude * noise(13 * slot + 5 * axis + 1);
        }
    }
    // contacts take their states from the second evaluation on
    for k in 0..2 {
        i.evaluate(&mut body, CLOCK, weights, k).expect("a response");
    }
    let (rows, tangent) = equations(&mut i);
    let (mut worst, mut largest): (f64, f64) = (0.0, 0.0);
    let h = 1e-6;
    for axis in 0..2 {
        for slot in 0..n {
            let at = i.system.du[axis][slot];
            let mut side = |to: f64| {
                i.system.du[axis][slot] = to;
                i.evaluate(&mut body, CLOCK, weights, 0).expect("a response");
                equations(&mut i).0
            };
            let (plus, minus) = (side(at + h), side(at - h));
            i.system.du[axis][slot] = at;
            let column = 2 * i.system.pattern.rank(slot) + axis;
            for row in (0..rows.len()).filter(|r| rows[*r].is_finite()) {
                let difference = (plus[row] - minus[row]) / (2.0 * h);
                worst = worst.max((difference - tangent[row][column]).abs());
                largest = largest.max(tangent[row][column].abs());
            }
        }
    }
    worst / largest
}

/// Residual of each free row as it will be solved (others are not a number), and the dense tangent.
fn equations<S: Shape<N>, const N: usize>(i: &mut Implicit<S, N>) -> (Vec<f64>, Vec<Vec<f64>>) {
    let (rhs, dense) = i.system.free_equations();
    (rhs.iter().map(|r| -r).collect(), dense)
}

fn law<K: Kinematics>(measure: StrengthMeasure) -> Box<dyn Law> {
    Box::new(PointLaw::<VonMises, K>::new(VonMises, measure))
}

fn plain(regime: Regime) -> Setting {
    Setting { regime, smooth: false, effects: Vec::new() }
}

/// The error of the differences (see [`tangent_error`]), as a share of the largest entry.
const TOLERANCE: f64 = 1e-8;

#[test]
fn the_tangent_is_the_derivative_of_the_residual() {
    let quasi = Regime::QuasiStatic;
    for measure in [StrengthMeasure::Cauchy, StrengthMeasure::Kirchhoff] {
        // elastic; sloping line; residual strength
        for (cohesion, amplitude) in [(1e4, 0.05), (20.0, 0.01), (0.05, 0.05)] {
            let body = || body(law::<Hencky>(measure), clay(cohesion));
            let linear = tangent_error(Linear, body(), plain(quasi), amplitude);
            let gimp = tangent_error(Gimp, body(), plain(quasi), amplitude);
            let spline = tangent_error(BSpline, body(), plain(quasi), amplitude);
            let worst = linear.max(gimp).max(spline);
            assert!(worst < TOLERANCE, "{measure:?} c = {cohesion}: {linear:e} {gimp:e} {spline:e}");
        }
    }
    let small = tangent_error(Linear, body(law::<Small>(StrengthMeasure::Cauchy), clay(5.0)), plain(quasi), 0.01);
    assert!(small < TOLERANCE, "{small:e}");
}

#[test]
fn the_tangent_holds_with_smoothed_dilatation() {
    let smooth = || Setting { smooth: true, ..plain(Regime::QuasiStatic) };
    for (cohesion, amplitude) in [(1e4, 0.05), (20.0, 0.01)] {
        let body = |k: Box<dyn Law>| body(k, clay(cohesion));
        let hencky = tangent_error(Linear, body(law::<Hencky>(StrengthMeasure::Cauchy)), smooth(), amplitude);
        let gimp = tangent_error(Gimp, body(law::<Hencky>(StrengthMeasure::Kirchhoff)), smooth(), amplitude);
        let spline = tangent_error(BSpline, body(law::<Hencky>(StrengthMeasure::Cauchy)), smooth(), amplitude);
        let small = tangent_error(Linear, body(law::<Small>(StrengthMeasure::Cauchy)), smooth(), amplitude);
        let worst = hencky.max(gimp).max(spline).max(small);
        assert!(worst < TOLERANCE, "c = {cohesion}: {hencky:e} {gimp:e} {spline:e} {small:e}");
    }
}

#[test]
fn the_tangent_holds_with_inertia_and_damping() {
    for scheme in [TimeScheme::BackwardEuler, TimeScheme::Newmark, TimeScheme::Hht { alpha: 0.1 }] {
        let mut setting = plain(Regime::Dynamic(scheme));
        setting.effects.push(Box::new(crate::effect::ViscousDamping::new(3.0)));
        let error = tangent_error(Linear, body(law::<Hencky>(StrengthMeasure::Cauchy), clay(20.0)), setting, 0.01);
        assert!(error < TOLERANCE, "{scheme:?}: {error:e}");
    }
}

#[test]
fn the_tangent_holds_with_friction_and_supports() {
    for regime in [Regime::QuasiStatic, Regime::Dynamic(TimeScheme::Newmark)] {
        for separation in [true, false] {
            let mut setting = plain(regime);
            setting.effects.push(Box::new(Support::roller(Side::Left)));
            setting.effects.push(Box::new(Friction::new(Side::Base, 0.3, separation)));
            let body = body(law::<Hencky>(StrengthMeasure::Cauchy), clay(20.0));
            let error = tangent_error(Linear, body, setting, 0.01);
            assert!(error < TOLERANCE, "{regime:?} {separation}: {error:e}");
        }
    }
}

#[test]
fn the_tangent_holds_with_a_ghost_penalty() {
    let regimes = [
        Regime::QuasiStatic,
        Regime::Dynamic(TimeScheme::BackwardEuler),
        Regime::Dynamic(TimeScheme::Newmark),
        Regime::Dynamic(TimeScheme::Hht { alpha: 0.1 }),
    ];
    for regime in regimes {
        let ghosted = |smooth: bool| Setting { smooth, effects: vec![Box::new(Ghost::new(0.5, 0.5))], ..plain(regime) };
        let body = || body(law::<Hencky>(StrengthMeasure::Cauchy), clay(20.0));
        let linear = tangent_error(Linear, body(), ghosted(false), 0.01);
        let smooth = tangent_error(Linear, body(), ghosted(true), 0.01);
        let gimp = tangent_error(Gimp, body(), ghosted(false), 0.01);
        assert!(linear.max(smooth).max(gimp) < TOLERANCE, "{regime:?}: {linear:e} {smooth:e} {gimp:e}");
    }
}

#[test]
fn the_tangent_of_a_symmetric_problem_is_symmetric() {
    let mut i = integrator(Linear, plain(Regime::QuasiStatic));
    let mut b = body(law::<Hencky>(StrengthMeasure::Kirchhoff), clay(20.0));
    i.place(&b, &mut Work::default());
    i.start(&mut b, CLOCK, None).expect("a start");
    for slot in 0..i.nodes.count {
        i.system.du[0][slot] = 0.01 * noise(slot);
    }
    i.evaluate(&mut b, CLOCK, None, 0).expect("a response");
    assert!(i.system.symmetric);
    let (_, k) = i.system.free_equations();
    let largest = k.iter().flatten().fold(0.0, |a: f64, v| a.max(v.abs()));
    for r in 0..k.len() {
        for c in 0..r {
            assert!((k[r][c] - k[c][r]).abs() < 1e-13 * largest);
        }
    }
}

/// 3 x 2 cells with points at the Gauss positions, under one stress.
fn gauss_body(law: Box<dyn Law>, p: Strength, stress: Voigt) -> Body {
    let at = crate::space::gauss::gauss(2);
    let place = |k: usize| {
        let (cell, q) = (k / 4, k % 4);
        [0.5 * ((cell % 3) as f64 + at[q & 1]), 0.5 * ((cell / 3) as f64 + at[q >> 1])]
    };
    let points = (0..24).map(|k| Seedling { x: place(k), v: [0.0; 2], mass: 0.1, volume: 0.0625, stress }).collect();
    let mut params = vec![Column::Uniform(0.0); Strength::NAMES.len()];
    p.write(|k, v| params[k] = Column::Uniform(v));
    Body::new(vec![GroupSeed { material: 0, law, params, points }])
}

/// Residual and stiffness where the nodes have moved by up to `amplitude` (m), in finite strain (RMPM) or small (RFEM).
fn equations_at<K: Kinematics>(smooth: bool, stress: Voigt, amplitude: f64) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut i = integrator(Linear, Setting { smooth, ..plain(Regime::QuasiStatic) });
    let mut b = gauss_body(law::<K>(StrengthMeasure::Cauchy), clay(20.0), stress);
    i.place(&b, &mut Work::default());
    i.start(&mut b, CLOCK, None).expect("a start");
    for axis in 0..2 {
        for slot in 0..i.nodes.count {
            i.system.du[axis][slot] = amplitude * noise(13 * slot + 5 * axis + 1);
        }
    }
    i.evaluate(&mut b, CLOCK, None, 0).expect("a response");
    equations(&mut i)
}

fn gap(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Before anything moves RMPM with its points at the Gauss positions is RFEM: the same forces of the same stress and
/// the same stiffness, up to the rounding of log and exp. (Under stress the tangent of finite strain has the geometric
/// term too, so stiffness is compared without.)
#[test]
fn before_any_movement_rmpm_is_rfem() {
    let stress = Voigt::new(1.0, -2.0, -0.5, 0.7);
    for smooth in [false, true] {
        let (finite, small) =
            (equations_at::<Hencky>(smooth, stress, 0.0).0, equations_at::<Small>(smooth, stress, 0.0).0);
        let largest = small.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        assert!(largest > 0.1 && gap(&finite, &small) < 1e-13 * largest, "{smooth}: {:e}", gap(&finite, &small));
        let at_rest = (
            equations_at::<Hencky>(smooth, Voigt::default(), 0.0).1,
            equations_at::<Small>(smooth, Voigt::default(), 0.0).1,
        );
        for (finite, small) in at_rest.0.iter().zip(&at_rest.1) {
            assert!(gap(finite, small) < 1e-13 * 1000.0, "{smooth}: {:e}", gap(finite, small));
        }
    }
}

/// With movement they part as the square of the strain: halving it leaves a quarter, up to a share of the strain.
#[test]
fn rmpm_leaves_rfem_with_the_square_of_the_strain() {
    for smooth in [false, true] {
        let apart = |by: f64| {
            let finite = equations_at::<Hencky>(smooth, Voigt::default(), by).0;
            gap(&finite, &equations_at::<Small>(smooth, Voigt::default(), by).0)
        };
        let (whole, half) = (apart(1e-4), apart(5e-5));
        assert!(whole > 0.0 && (whole / half - 4.0).abs() < 0.02, "{smooth}: {whole:e} {half:e}");
    }
}

/// The explicit pass has the internal forces of the implicit residual before anything moves, and strains the body as the
/// implicit response does, up to rounding: one B-bar for both schemes.
#[test]
fn both_schemes_smooth_alike() {
    use crate::assembly::{Strain, cells::CellMeans};
    let whole = |law: &dyn Fn() -> Box<dyn Law>| {
        let mut i = integrator(Gimp, Setting { smooth: true, ..plain(Regime::QuasiStatic) });
        let mut b = body(law(), clay(20.0));
        b.track_domains();
        i.place(&b, &mut Work::default());
        i.start(&mut b, CLOCK, None).expect("a start");
        i.respond(&mut b, false).expect("a response");
        let (mut nodes, mut cells) = (Nodes::new(i.nodes.grid), CellMeans::new(&i.nodes.grid));
        nodes.begin();
        let mut scratch = Box::default();
        let path = FpPath::best();
        path.run(crate::assembly::Scatter {
            scratch: &mut scratch,
            body: &b,
            nodes: &mut nodes,
            cells: Some(&mut cells),
            stretch: 0..b.len(),
            shape: Gimp,
        });
        for axis in 0..2 {
            let minus: Vec<f64> = nodes.force[axis][..nodes.count].iter().map(|f| -f).collect();
            let largest = minus.iter().fold(0.0, |a: f64, f| a.max(f.abs()));
            assert!(gap(&minus, &i.system.residual[axis]) < 1e-13 * largest);
            for slot in 0..nodes.count {
                i.system.du[axis][slot] = 0.005 * noise(13 * slot + 5 * axis + 1);
                nodes.strain_velocity[axis][slot] = i.system.du[axis][slot] / CLOCK.dt;
            }
        }
        i.respond(&mut b, false).expect("a response");
        let implicit = b.trial.clone();
        let (scratch, nodes, cells) = (&mut *scratch, &nodes, Some(&mut cells));
        let dt = CLOCK.dt;
        b.apart(|body, part| path.run(Strain { scratch, body, part, nodes, cells, dt, shape: Gimp }))
            .expect("a strain");
        for (ours, theirs) in b.trial.strain.iter().zip(&implicit.strain) {
            // strains of 1e-2, through log and exp
            assert!(gap(ours, theirs) < 1e-15, "{:e}", gap(ours, theirs));
        }
    };
    whole(&|| law::<Hencky>(StrengthMeasure::Cauchy));
    whole(&|| law::<Hencky>(StrengthMeasure::Kirchhoff));
}
