//! What the benches share: the clock, the paper's slope through the library, and printing.

// Each bench uses its own part.
#![allow(dead_code)]

pub mod count;

use std::time::Instant;

use rmpm::{case, scene, sim::Simulation};

/// The paper's slope as its case file has it.
pub const SLOPE: &str = include_str!("../../cases/clay-slope.toml");
/// Cell size (m) with 198,660 points.
pub const FINE: f64 = 5.0 / 105.0;

/// A simulation of a case file with overrides.
pub fn simulation(text: &str, overrides: &[&str]) -> Simulation {
    let overrides: Vec<String> = overrides.iter().map(|&s| s.to_owned()).collect();
    let (case, _) = case::read("bench", text, &overrides).unwrap_or_else(|e| panic!("{}", e.render(false)));
    scene::build(&case, u64::MAX).unwrap_or_else(|e| panic!("{e}")).simulation
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

/// CPU time of the main thread from the scheduler where there is one to read, else the wall clock.
pub struct Clock {
    wall: Instant,
    cpu: Option<u64>,
}

impl Clock {
    pub fn start() -> Self {
        Clock { wall: Instant::now(), cpu: scheduled_ns() }
    }

    pub fn name(&self) -> &'static str {
        if self.cpu.is_some() { "CPU time" } else { "wall time" }
    }

    pub fn seconds(&self) -> f64 {
        match (self.cpu, scheduled_ns()) {
            (Some(start), Some(end)) => (end - start) as f64 * 1e-9,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }
}

/// Nanoseconds that this thread has spent on a CPU; giving way brings the account up to date.
fn scheduled_ns() -> Option<u64> {
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok().filter(|&ns| ns > 0)
}

/// Middle value of a sample.
pub fn median(sample: &[f64]) -> f64 {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}
