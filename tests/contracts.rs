//! What every integrator and every effect must satisfy. Materials and shape functions have their
//! contracts beside them (`material::contract`, `space::shape::contract`).

mod support;

use rmpm::{
    body::Body,
    effect::{Clock, Effect, Friction, Gravity, LocalDamping, Schedule, Support, ViscousDamping},
    space::{BSpline, Gimp, GimpWide, Grid, Linear, Shape, grid::Side},
    step::{
        Integrator,
        explicit::{Explicit, Settings, StressUpdate},
    },
    transfer::Transfer,
    work::Work,
};
use support::SLOPE;

fn body(kinematics: &str, shape: &str) -> (Body, Grid) {
    let keys = ["grid.cell=0.5", &format!("solver.kinematics={kinematics}"), &format!("solver.shape={shape}")];
    let scene = support::scene(SLOPE, &keys);
    (scene.simulation.body, scene.grid)
}

/// Every effect there is, as a slope would have them.
fn effects() -> Vec<Box<dyn Effect>> {
    vec![
        Box::new(Gravity::new([0.5, -9.81], Schedule::AtOnce)),
        Box::new(LocalDamping::new(0.05, None)),
        Box::new(ViscousDamping::new(0.2)),
        Box::new(Support::roller(Side::Left)),
        Box::new(Support::fixed(Side::Right)),
        Box::new(Friction::new(Side::Base, 0.3, true)),
    ]
}

fn integrator(grid: Grid, stress_update: StressUpdate, shape: &str) -> Box<dyn Integrator> {
    match shape {
        "gimp" => explicit(Gimp, grid, stress_update),
        "gimp_wide" => explicit(GimpWide, grid, stress_update),
        "bspline" => explicit(BSpline, grid, stress_update),
        _ => explicit(Linear, grid, stress_update),
    }
}

fn explicit<S: Shape<N>, const N: usize>(shape: S, grid: Grid, stress_update: StressUpdate) -> Box<dyn Integrator> {
    let settings = Settings {
        stress_update,
        transfer: Transfer::Flip { pic_rate: 0.5 },
        courant: 0.25,
        mass_floor: 1e-3,
        smooth: false,
    };
    Box::new(Explicit::new(shape, grid, settings, effects()))
}

/// Pairs of kinematics and shape functions.
const CHOICES: [(&str, &str); 5] =
    [("hencky", "linear"), ("rate", "linear"), ("hencky", "gimp"), ("rate", "gimp_wide"), ("hencky", "bspline")];

fn advance(integrator: &mut dyn Integrator, body: &mut Body, from: usize, steps: usize, work: &mut Work) {
    for k in from..from + steps {
        let clock = Clock { time: 1e-3 * k as f64, dt: 1e-3 };
        integrator.step(body, clock, work).expect("a small step");
    }
}

fn bits(body: &Body) -> Vec<u64> {
    let s = body.snapshot(0.0, 0);
    let pairs = s.position.iter().chain(&s.velocity).flatten();
    let strains = s.stress.iter().flat_map(|t| t.to_array());
    pairs.chain(&s.jacobian).chain(&s.plastic_strain).copied().chain(strains).map(f64::to_bits).collect()
}

/// A step that fails changes neither body nor books nor what comes after it.
#[test]
fn a_refused_step_leaves_no_trace() {
    for (kinematics, shape) in CHOICES {
        for update in [StressUpdate::Musl, StressUpdate::Usl] {
            let (mut a, grid) = body(kinematics, shape);
            let (mut b, _) = body(kinematics, shape);
            let (mut refused, mut plain) = (integrator(grid, update, shape), integrator(grid, update, shape));
            let (mut work_a, mut work_b) = (Work::default(), Work::default());
            advance(refused.as_mut(), &mut a, 0, 40, &mut work_a);
            advance(plain.as_mut(), &mut b, 0, 40, &mut work_b);
            let (before, books) = (bits(&a), refused.books());
            let far_too_long = Clock { time: 0.04, dt: 50.0 };
            assert!(refused.step(&mut a, far_too_long, &mut work_a).is_err());
            assert!(bits(&a) == before, "the body has changed");
            assert_eq!(refused.books(), books);
            assert_eq!(work_a.steps, work_b.steps);
            advance(refused.as_mut(), &mut a, 40, 40, &mut work_a);
            advance(plain.as_mut(), &mut b, 40, 40, &mut work_b);
            assert!(bits(&a) == bits(&b), "the refused step is felt later");
            assert_eq!(refused.books(), plain.books());
        }
    }
}

/// The impulses that the effects book are what changed the momentum, to rounding of the sums.
#[test]
fn booked_impulses_are_the_change_of_momentum() {
    for shape in ["linear", "gimp", "gimp_wide", "bspline"] {
        for update in [StressUpdate::Musl, StressUpdate::Usl] {
            let (mut body, grid) = body("hencky", shape);
            let mut integrator = integrator(grid, update, shape);
            advance(integrator.as_mut(), &mut body, 0, 300, &mut Work::default());
            let (momentum, booked) = (body.momentum(), integrator.books().effects.impulse);
            let scale = body.total_mass() * 9.81 * 0.3;
            for axis in 0..2 {
                let gap = (momentum[axis] - booked[axis]).abs() / scale;
                assert!(gap < 1e-12, "{shape}, {update:?}, axis {axis}: {gap:e}");
            }
        }
    }
}

/// Every effect that dissipates says under which head: the parts add up to the whole.
#[test]
fn dissipation_is_reported_under_a_head() {
    let (mut body, grid) = body("hencky", "linear");
    let mut integrator = integrator(grid, StressUpdate::Musl, "linear");
    advance(integrator.as_mut(), &mut body, 0, 300, &mut Work::default());
    let books = integrator.books();
    let (parts, whole) = (books.friction + books.damping, books.effects.dissipated);
    assert!(books.friction > 0.0 && books.damping > 0.0, "{books:?}");
    assert!((parts - whole).abs() <= 1e-12 * whole, "{books:?}");
}

/// The stable step shrinks with the cells and is positive for a body at rest.
#[test]
fn the_stable_step_follows_the_cells() {
    let dt = |cell: &str| support::simulation(SLOPE, &[&format!("grid.cell={cell}")]).stable_dt().expect("a limit");
    let (coarse, fine) = (dt("0.5"), dt("0.25"));
    assert!((coarse / fine - 2.0).abs() < 1e-6, "{coarse} {fine}");
}

/// An effect takes part only in the stages that it names: in the others it does nothing, so that
/// leaving it out of the list changes nothing.
#[test]
fn effects_do_nothing_outside_their_stages() {
    use rmpm::{effect::Pass, nodes::Nodes};
    let grid = Grid { origin: [0.0, 0.0], h: 1.0, cells: [2, 2] };
    for mut effect in effects() {
        let mut nodes = Nodes::new(grid);
        nodes.begin();
        for base in [0, 1, 3, 4] {
            let slots = nodes.patch(base, &[0, 1, 3, 4]);
            for s in slots {
                nodes.mass[s] = 2.0;
                (nodes.velocity[0][s], nodes.velocity[1][s]) = (0.3, -0.2);
                (nodes.old_velocity[0][s], nodes.old_velocity[1][s]) = (0.3, -0.2);
                (nodes.strain_velocity[0][s], nodes.strain_velocity[1][s]) = (0.3, -0.2);
            }
        }
        let state = |n: &Nodes| (n.force.clone(), n.velocity.clone(), n.strain_velocity.clone());
        let (before, clock, stages) = (state(&nodes), Clock { time: 1.0, dt: 0.01 }, effect.stages());
        if !stages.force {
            effect.force(&mut nodes, clock);
        }
        if !stages.constrain {
            effect.constrain(&mut nodes, Pass::Update, clock);
            effect.constrain(&mut nodes, Pass::Remap, clock);
        }
        if !stages.account {
            effect.account(&nodes, clock);
        }
        assert_eq!(state(&nodes), before, "{}", effect.name());
        assert_eq!(effect.ledger().step, Default::default(), "{}", effect.name());
        assert!(stages.force || stages.constrain, "{} does nothing at all", effect.name());
    }
}
