//! Dead loads and drives: closed-form answers and balances.

mod support;

use rmpm::{case, scene, sim::Simulation};
use support::{advance, bits, simulation};

/// A weightless bar, 10 m long and one cell wide, held on the left; E = 100 kPa, density 1 t/m3.
const BAR: &str = r#"
[grid]
cell = 0.5
size = [12.0, 0.5]

[points]
layout = "even"

[explicit]
pic_rate = 0.0

[gravity]
schedule = "none"

[end]
time = 100.0

[boundary]
left = "roller"
base = "roller"
top = "roller"

[material.bar]
law = "elastic"
density = 1.0
young_modulus = 100.0
poisson_ratio = 0.0

[[region]]
name = "bar"
material = "bar"
polygon = [[0.0, 0.0], [10.0, 0.0], [10.0, 0.5], [0.0, 0.5]]
"#;

/// The load on the last two columns of points, at x = 9.625 and 9.875 m.
const LOAD: &str = "[[load]]\nname = \"tip\"\nbox = [[9.5, 0.0], [10.0, 0.5]]\nforce = [0.05, 0.0]\n";

fn run_to(sim: &mut Simulation, time: f64) {
    while sim.time < time * (1.0 - 1e-12) {
        let left = time - sim.time;
        sim.step(left).unwrap_or_else(|e| panic!("{e}"));
    }
}

fn is_balanced(sim: &Simulation) {
    assert!(sim.momentum_error().iter().all(|e| *e < 1e-12), "{:?}", sim.momentum_error());
    assert!(sim.mass_error() < 1e-15);
}

/// Largest x and its displacement (m).
fn tip(sim: &Simulation) -> (f64, f64) {
    let s = sim.snapshot();
    (0..s.len())
        .map(|i| (s.reference[i][0], s.displacement(i)[0]))
        .fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a })
}

fn refused(text: &str) -> scene::SceneError {
    let (case, _) = case::read("case", text, &[]).unwrap_or_else(|e| panic!("{e}"));
    match scene::build(&case, u64::MAX) {
        Ok(_) => panic!("the scene is built"),
        Err(error) => error,
    }
}

/// Stress F / A = 0.1 kPa, Hencky strain 0.1 / 100 (to 1e-3 of itself: J = 1.001). The force is shared
/// by two columns of points of 0.25 m: from 9.5 to 10 m the stress falls linearly to 0. The nodes see
/// full stress up to 9.5 m and half of it in the last cell, so the column at 9.875 m moves by
/// 1e-3 (9.5 + 0.5 * 0.375) = 9.6875e-3 m. The tolerance is 1 %: J, the damped remainder
/// (exp(-0.2 * 60) = 6e-6), and the stress of the tip, which is read at points and not at the node.
#[test]
fn a_loaded_bar_settles_to_its_exact_length() {
    let damped = ["damping.viscous=0.4"];
    let mut sim = simulation(&format!("{BAR}{LOAD}"), &damped);
    run_to(&mut sim, 60.0);
    let (_, found) = tip(&sim);
    assert!((found / 9.6875e-3 - 1.0).abs() < 0.01, "{found}");
    is_balanced(&sim);
    let e = sim.energies();
    // force x way of the points that it acts on
    let s = sim.snapshot();
    let loaded: Vec<f64> = (0..s.len()).filter(|&i| s.reference[i][0] > 9.5).map(|i| s.displacement(i)[0]).collect();
    let mean = loaded.iter().sum::<f64>() / loaded.len() as f64;
    assert_eq!(loaded.len(), 4);
    assert!((e.external / (0.05 * mean) - 1.0).abs() < 1e-9, "{} of {}", e.external, 0.05 * mean);
    // half of the work of a load put on at once is stored, half is damped
    assert!((e.strain / e.external - 0.5).abs() < 0.01 && (e.damping / e.external - 0.5).abs() < 0.01, "{e:?}");
    assert!(e.numerical.abs() < 0.01 * e.external, "{e:?}");
}

/// A free body of 5 t under 0.05 kN: v = F t / m, and with a ramp of 2 s half the impulse of that time.
#[test]
fn a_free_body_takes_the_impulse_of_its_load() {
    for (ramp, impulse) in [(0.0, 0.05 * 4.0), (2.0, 0.05 * 3.0)] {
        let text = format!("{BAR}{LOAD}ramp_time = {ramp:?}\n");
        let mut sim = simulation(&text, &["boundary.left=free"]);
        run_to(&mut sim, 4.0);
        // the middle of each step is exact for a ramp, but for the step in which it ends
        let error = (sim.body.momentum()[0] / impulse - 1.0).abs();
        assert!(error < if ramp > 0.0 { 1e-4 } else { 1e-12 }, "{error}");
        is_balanced(&sim);
    }
}

/// The load stays with its points through sorts and in sheared cells, and light nodes (USL with its mass
/// floor) take it in full.
#[test]
fn loads_keep_the_momentum_of_a_sliding_slope() {
    let load = "\n[[load]]\nbox = [[0, 4], [20, 5]]\nforce = [3, -400]\nramp_time = 1\n";
    let text = format!("{}{load}", support::SLOPE);
    for update in ["explicit.stress_update=musl", "explicit.stress_update=usl"] {
        let mut sim = simulation(&text, &["grid.cell=0.5", "gravity.schedule=at_once", update]);
        run_to(&mut sim, 3.0);
        assert!(support::yielded(&sim) > 0.3 && sim.work.sorts > 0);
        assert!(sim.momentum_error().iter().all(|e| *e < 1e-10), "{:?}", sim.momentum_error());
    }
}

/// The right end is pulled at 1 mm/s for 10 s, slowly against the 2 s in which a wave runs there and
/// back, damped, and then held for 50 s: 1e-2 m over the 10 m from the left to the driven nodes. So the
/// strain is 1e-3, the stress 0.1 kPa and the reaction 0.05 kN; to 1 %, of which J takes 0.1 %.
#[test]
fn a_driven_bar_has_its_reaction_and_its_energy() {
    let drive = "[[drive]]\nname = \"grip\"\nbox = [[9.75, 0], [11, 0.5]]\nvelocity_x = 1e-3\nuntil = 10\n";
    let mut sim = simulation(&format!("{BAR}{drive}"), &["damping.viscous=0.4"]);
    run_to(&mut sim, 60.0);
    is_balanced(&sim);
    let s = sim.snapshot();
    let middle: Vec<f64> =
        (0..s.len()).filter(|&i| (2.0..8.0).contains(&s.reference[i][0])).map(|i| s.stress[i].xx).collect();
    for stress in middle {
        assert!((stress / 0.1 - 1.0).abs() < 0.01, "{stress}");
    }
    let e = sim.energies();
    // 1/2 E A e^2 L
    assert!((e.strain / (0.5 * 100.0 * 0.5 * 1e-6 * 10.0) - 1.0).abs() < 0.02, "{e:?}");
    assert!((e.external - e.strain - e.damping).abs() < 0.01 * e.external, "{e:?}");
}

/// Driven everywhere, a body moves as a whole: no strain, and the work is the kinetic energy that
/// backward Euler asks for, force x way = m v . v in the first step, of which half is kept.
#[test]
fn a_body_driven_everywhere_moves_as_a_whole() {
    let drive = "[[drive]]\nbox = [[-1, -1], [13, 1]]\nvelocity_x = 0.25\nvelocity_y = 0\nuntil = 4\n";
    let text = format!("{BAR}{drive}");
    let mut sim = simulation(&text, &["boundary.left=free"]);
    run_to(&mut sim, 2.0);
    let s = sim.snapshot();
    for i in 0..s.len() {
        assert!((s.displacement(i)[0] - 0.5).abs() < 1e-12 && s.displacement(i)[1] == 0.0);
        assert!(s.stress[i].xx.abs() < 1e-12);
    }
    let e = sim.energies();
    let momentum_work = 5.0 * 0.25 * 0.25;
    assert!((e.external - momentum_work).abs() < 1e-12 && (e.kinetic - 0.5 * momentum_work).abs() < 1e-12, "{e:?}");
    is_balanced(&sim);
    // and stands where the motion ends
    run_to(&mut sim, 6.0);
    assert!((tip(&sim).1 - 1.0).abs() < 1e-12, "{:?}", tip(&sim));
}

#[test]
fn loads_and_drives_that_hold_nothing_are_refused() {
    let load = refused(&format!("{BAR}{}", LOAD.replace("9.5", "9.9")));
    assert_eq!(load.key, "load.tip.box");
    assert!(load.message.contains("no material point starts in the box of load \"tip\""), "{load}");
    let drive = refused(&format!("{BAR}[[drive]]\nbox = [[9.6, 0], [9.9, 1]]\nvelocity_x = 1\n"));
    assert_eq!(drive.key, "drive.drive 1.box");
    assert!(drive.message.contains("no node of the grid lies in the box"), "{drive}");
}

/// A load of nothing is no load, to the bit; it costs its calls.
#[test]
fn a_load_of_nothing_changes_nothing() {
    let load = "\n[[load]]\nbox = [[0, 4], [20, 5]]\nforce = [0, 0]\n";
    let keys = ["grid.cell=0.5", "gravity.schedule=at_once"];
    let (mut with, mut without) =
        (simulation(&format!("{}{load}", support::SLOPE), &keys), simulation(support::SLOPE, &keys));
    advance(&mut with, 500);
    advance(&mut without, 500);
    assert!(bits(&with) == bits(&without));
    assert_eq!(with.work.effect_calls - without.work.effect_calls, 500 * 2);
}
