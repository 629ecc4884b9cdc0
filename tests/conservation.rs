//! Mass, momentum and energy of the paper's slope through its failure.

mod support;

use rmpm::sim::Simulation;
use support::{SLOPE, advance, simulation, yielded};

fn check_balances(sim: &Simulation) -> f64 {
    let e = sim.energies();
    assert!(sim.mass_error() < 1e-12, "mass is off by {:e}", sim.mass_error());
    for (axis, error) in sim.momentum_error().into_iter().enumerate() {
        assert!(error < 1e-10, "momentum {axis} is off by {error:e} at {} s", sim.time);
    }
    let parts = e.kinetic + e.strain + e.dissipated + e.numerical;
    assert!((parts - e.external).abs() <= 1e-12 * e.external.abs().max(1.0), "{e:?}");
    assert!((e.plastic + e.friction + e.damping - e.dissipated).abs() <= 1e-12 * e.dissipated.abs().max(1.0));
    for part in [e.kinetic, e.strain, e.plastic, e.friction, e.damping] {
        assert!(part.is_finite() && part >= -1e-12, "{e:?}");
    }
    e.numerical
}

fn check_finite(sim: &Simulation) {
    let s = sim.snapshot();
    let pairs = s.position.iter().chain(&s.velocity).flatten();
    let stress: Vec<f64> = s.stress.iter().flat_map(|t| t.to_array()).collect();
    let all = pairs.chain(&stress).chain(&s.plastic_strain).chain(&s.jacobian).chain(&s.strain_energy);
    assert!(all.into_iter().all(|v| v.is_finite()));
    assert!(s.jacobian.iter().all(|&j| j > 0.0));
}

/// What the scheme itself lost (or made, negative) as a share of the external work: of all
/// samples after the ramp, the one farthest from 0.
fn numerical_share(keys: &[&str], until: f64) -> f64 {
    let mut sim = simulation(SLOPE, keys);
    let mut share = 0.0f64;
    while sim.time < until {
        advance(&mut sim, 20);
        let now = check_balances(&sim) / sim.energies().external;
        if sim.time > 5.0 && now.abs() > share.abs() {
            share = now;
        }
    }
    check_finite(&sim);
    assert!(yielded(&sim) > 0.3, "the slope has not failed");
    share
}

/// The identity of the energies is exact by definition; what says something is how little the
/// scheme itself takes. With `pic_rate` a PIC takes the kinetic energy of the points' velocity
/// relative to the grid; impacts on the base and the backward Euler return take the rest.
/// Measured: 3.8 % here, 3.8 % at h = 0.25 m. The bound is the share from which the record warns.
#[test]
fn slope_keeps_mass_momentum_and_energy() {
    let share = numerical_share(&["grid.cell=0.5"], 12.0);
    assert!(share.abs() < 0.05, "{share}");
}

/// With domains and splines there are nodes without mass: they take nothing and give nothing, and the balances
/// are those of the bilinear functions.
#[test]
fn wider_shapes_keep_mass_momentum_and_energy() {
    for shape in ["solver.shape=gimp", "solver.shape=gimp_wide", "solver.shape=bspline"] {
        let share = numerical_share(&["grid.cell=0.5", shape], 12.0);
        assert!(share.abs() < 0.05, "{shape}: {share}");
    }
}

/// Other transfers take more out of the points, but they balance their momentum as FLIP does.
#[test]
fn transfers_keep_mass_momentum_and_energy() {
    for keys in [
        &["solver.transfer=apic"][..],
        &["solver.transfer=apic", "solver.shape=bspline"],
        &["solver.transfer=xpic"],
        &["solver.transfer=xpic", "solver.xpic_order=2", "solver.shape=bspline"],
    ] {
        let share = numerical_share(&[&["grid.cell=0.5"], keys].concat(), 9.0);
        println!("{keys:?}: numerical share {share:.4}");
        // the scheme makes no energy beyond what FLIP does, see below
        assert!(share > -0.04, "{keys:?}: {share}");
    }
}

/// Measured: FLIP makes 2.1 %, PIC at ten times the default rate takes 7.9 %.
#[test]
fn flip_makes_a_little_energy_and_pic_takes_it() {
    let flip = numerical_share(&["grid.cell=0.5", "explicit.pic_rate=0"], 9.0);
    let pic = numerical_share(&["grid.cell=0.5", "explicit.pic_rate=5"], 9.0);
    assert!(flip.abs() < 0.04, "FLIP {flip}");
    assert!(pic > flip + 0.03 && pic < 0.15, "FLIP {flip}, PIC {pic}");
}
