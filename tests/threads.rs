//! A large body is stepped in parts: the same bits on any number of threads, and but for rounding those of a whole.

mod support;

use rmpm::{
    effect::{Gravity, Schedule},
    sim::Simulation,
    space::{Grid, Linear},
    step::{
        control::Control,
        explicit::{Explicit, Settings, StressUpdate},
    },
    transfer::Transfer,
};
use support::{SLOPE, advance, bits, simulation};

/// 18,400 points, in five parts.
const LARGE: [&str; 3] = ["grid.cell=5/32", "gravity.schedule=at_once", "explicit.time_step=0.002"];
const STEPS: usize = 40;

fn on(threads: usize, keys: &[&str]) -> Simulation {
    let mut sim = simulation(SLOPE, &[&LARGE, keys].concat());
    assert!(sim.body.len() > 16_384);
    assert_eq!(sim.share(threads).unwrap(), threads.min(5), "of {} points", sim.body.len());
    advance(&mut sim, STEPS);
    sim
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let choices: [&[&str]; 5] = [
        &[],
        &["solver.shape=gimp", "explicit.stress_update=usl"],
        &["solver.transfer=apic", "solver.shape=bspline"],
        &[
            "load=[{box=[[0, 4], [9, 5]], force=[0, -1]}]",
            "material.clay.regularisation=nonlocal",
            "material.clay.reference_length=1",
        ],
        // far above the stable step: some steps are refused
        &["explicit.time_step=0.1"],
    ];
    for keys in choices {
        let alone = on(1, keys);
        for threads in [2, 3] {
            let together = on(threads, keys);
            assert!(bits(&alone) == bits(&together), "{threads} threads, {keys:?}");
            assert_eq!(alone.work, together.work);
        }
        assert_eq!(alone.work.rejected_steps > 0, keys == ["explicit.time_step=0.1"], "{keys:?}");
    }
}

#[test]
fn what_cannot_be_shared_says_so() {
    for keys in
        [&["grid.cell=0.5"][..], &["solver.locking=b_bar"], &["solver.transfer=xpic"], &["solver.scheme=implicit"]]
    {
        let large = if keys[0].starts_with("grid") { &LARGE[1..2] } else { &LARGE[..2] };
        let mut sim = simulation(SLOPE, &[large, keys].concat());
        assert_eq!(sim.share(2).unwrap(), 1, "{keys:?}");
    }
}

/// The slope under gravity at once, in parts or whole.
fn falling(in_parts: bool) -> Simulation {
    let body = simulation(SLOPE, &LARGE).body;
    let h = 5.0 / 32.0;
    let grid = Grid { origin: [0.0; 2], h, cells: [384, 45] };
    let settings = Settings {
        stress_update: StressUpdate::Musl,
        transfer: Transfer::Flip { pic_rate: 0.5 },
        courant: 0.25,
        mass_floor: 0.0,
        smooth: false,
    };
    // upwards, so that no side is needed
    let gravity = Gravity::new([0.3, 9.81], Schedule::AtOnce);
    let mut explicit = Explicit::new(Linear, grid, settings, vec![Box::new(gravity)]);
    if in_parts {
        explicit.in_parts(&body);
    }
    Simulation::new(body, Box::new(explicit), Control::new(Some(0.002)), None)
}

/// Sums over nodes that two parts share are taken in another order: they differ by rounding, 1e-16 of some 10 terms, which
/// 40 steps of a slope that is not yet failing carry on.
#[test]
fn parts_are_the_whole_but_for_rounding() {
    let (mut parts, mut whole) = (falling(true), falling(false));
    assert_eq!(parts.share(2).unwrap(), 2);
    assert_eq!(whole.share(2).unwrap(), 1);
    for sim in [&mut parts, &mut whole] {
        advance(sim, STEPS);
    }
    let (a, b) = (parts.snapshot(), whole.snapshot());
    let moved = a.displacement(0)[1].abs();
    let gap = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let worst = a.position.iter().zip(&b.position).map(|(a, b)| gap(*a, *b)).fold(0.0, f64::max);
    assert!(moved > 0.02 && worst > 0.0 && worst < 1e-13 * 45.0, "{moved} {worst:e}");
    assert!((parts.energies().external / whole.energies().external - 1.0).abs() < 1e-13);
}
