//! What the tests of the program share: scenes from the case files, and runs of them.

// Each test file uses its own part.
#![allow(dead_code)]

pub mod program;

use rmpm::{case, scene, scene::Scene, sim::Simulation};

/// The paper's slope.
pub const SLOPE: &str = include_str!("../../cases/clay-slope.toml");
/// The slope with coarse cells and gravity at once: it fails within 2 s.
pub const QUICK: [&str; 2] = ["grid.cell=0.5", "gravity.schedule=at_once"];

/// The scene of a case file with overrides.
pub fn scene(text: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|&s| s.to_owned()).collect();
    let (case, _) = case::read("test", text, &overrides).unwrap_or_else(|e| panic!("{}", e.render(false)));
    scene::build(&case, u64::MAX).unwrap_or_else(|e| panic!("{e}"))
}

/// Its simulation.
pub fn simulation(text: &str, overrides: &[&str]) -> Simulation {
    scene(text, overrides).simulation
}

/// `steps` steps of the simulation's own choosing.
pub fn advance(sim: &mut Simulation, steps: usize) {
    for _ in 0..steps {
        sim.step(f64::INFINITY).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Part of the points that have yielded.
pub fn yielded(sim: &Simulation) -> f64 {
    let history = sim.body.committed.history.first().map_or(&[][..], |c| &c[..]);
    history.iter().filter(|&&e| e > 0.0).count() as f64 / sim.body.len() as f64
}

/// Every number of the state, bit by bit, in the order of the points' identities.
pub fn bits(sim: &Simulation) -> Vec<u64> {
    let s = sim.snapshot();
    let mut out: Vec<u64> = vec![s.time.to_bits(), s.step];
    out.extend(s.position.iter().chain(&s.velocity).flatten().map(|v| v.to_bits()));
    out.extend(s.jacobian.iter().chain(&s.plastic_strain).chain(&s.strain_energy).map(|v| v.to_bits()));
    out.extend(s.stress.iter().flat_map(|t| t.to_array()).map(f64::to_bits));
    out
}

/// FNV-1a of the bits.
pub fn digest(sim: &Simulation) -> u64 {
    let hash = |h: u64, b: u64| (h ^ b).wrapping_mul(0x0100_0000_01b3);
    bits(sim).into_iter().fold(0xcbf2_9ce4_8422_2325, hash)
}
