//! When the implicit scheme is quasi-static and when it is not, and what a refusal means.

mod support;

use support::{SLOPE, simulation};

/// A strong slope on a rough base in small strain, at rest from 1 s on: steps without an iteration
/// have no error, so a tolerance never refuses them.
#[test]
fn a_body_at_rest_has_no_error() {
    for regime in ["quasi_static", "auto"] {
        let regime = format!("implicit.regime={regime}");
        let keys = [
            "solver.scheme=implicit",
            "solver.kinematics=small",
            "grid.cell=1",
            "material.clay.cohesion=2000",
            "boundary.base.kind=fixed",
            "gravity.ramp_time=1",
            "implicit.tolerance=1e-5",
            &regime,
        ];
        let mut sim = simulation(SLOPE, &keys);
        while sim.time < 2.0 {
            sim.step(f64::INFINITY).unwrap();
        }
        assert_eq!((sim.work.rejected_steps, sim.events().len()), (0, 0), "{regime}");
    }
}

/// `auto` brings inertia in before steps become too short to be cut.
#[test]
fn auto_moves_on_before_the_shortest_step() {
    let keys = [
        "solver.scheme=implicit",
        "solver.kinematics=small",
        "grid.cell=0.5",
        "implicit.time_step=0.05",
        "implicit.min_time_step=0.01",
    ];
    let mut sim = simulation(SLOPE, &keys);
    while sim.time < 5.5 {
        sim.step(f64::INFINITY).unwrap();
    }
    let kinds: Vec<_> = sim.events().iter().map(|e| e.kind).collect();
    assert_eq!(kinds, ["stability_lost", "inertia_on"]);
}

/// A refusal for accuracy says nothing of stability.
#[test]
fn an_error_above_the_tolerance_is_no_loss_of_stability() {
    let mut sim = simulation(SLOPE, &["solver.scheme=implicit", "grid.cell=1", "implicit.tolerance=1e-9"]);
    let fault = sim.step(f64::INFINITY).unwrap_err();
    assert_eq!(fault.kind, rmpm::fault::FaultKind::Inaccurate);
    assert!(sim.events().is_empty());
}

/// A block in free fall from full gravity on: average acceleration and HHT are exact, backward Euler
/// falls with the velocity of the end of each step.
#[test]
fn free_fall_is_exact() {
    let text = r#"
        [grid]
        cell = 0.5
        size = [3.0, 12.0]
        [gravity]
        schedule = "at_once"
        [solver]
        scheme = "implicit"
        [end]
        time = 1.0
        [material.rock]
        law = "elastic"
        unit_weight = 20.0
        young_modulus = 1e6
        poisson_ratio = 0.3
        [[region]]
        name = "block"
        material = "rock"
        polygon = [[1.0, 10.0], [2.0, 10.0], [2.0, 11.0], [1.0, 11.0]]
    "#;
    for (regime, excess) in [("newmark", 0.0), ("hht", 0.0), ("backward_euler", 0.02)] {
        let mut sim = simulation(text, &[&format!("implicit.regime={regime}"), "implicit.time_step=0.02"]);
        while sim.time < 0.999 {
            sim.step(1.0 - sim.time).unwrap();
        }
        let fall: f64 = sim.snapshot().position.iter().zip(&sim.snapshot().reference).map(|(x, x0)| x0[1] - x[1]).sum();
        let fall = fall / sim.body.len() as f64;
        // 1/2 g t^2, and for backward Euler 1/2 g t dt more
        let exact = 0.5 * 9.81 * (1.0 + excess);
        assert!((fall - exact).abs() < 1e-9, "{regime}: {fall} and {exact}");
    }
}
