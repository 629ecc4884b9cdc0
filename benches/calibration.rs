//! The scalar yardstick on its own: million particle-steps per CPU second.
//!
//! `cargo bench --bench calibration` prints the rates; `-- --slide` runs the slope for 15 s and
//! prints r(t); `-- --count LAW STEPS` takes STEPS bare steps on 7240 points for an instruction
//! counter.

mod scalar;

use scalar::{Hencky, Law, Rate, Scalar};
use std::time::Instant;

const FINE: f64 = 5.0 / 105.0;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    match args.first().map(String::as_str) {
        Some("--slide") => slides(),
        Some("--count") => count(&args[1..]),
        _ => rates(),
    }
}

fn rates() {
    println!("million particle-steps per second of {}, best of the repeats", Clock::start().name());
    println!("{:<8} {:>8} {:>8} {:>9} {:>8}", "law", "points", "rate", "yielded", "r (m)");
    rate::<Hencky>("hencky");
    rate::<Rate>("rate");
}

fn rate<L: Law>(name: &str) {
    let mut coarse = Scalar::<L>::paper_slope(0.25, 2);
    run_to(&mut coarse, 5.5, 0.002);
    report(name, &mut coarse, 0.002, 300, 8);
    let mut fine = Scalar::<L>::paper_slope(FINE, 2);
    fine.ramp = 0.0;
    for _ in 0..150 {
        fine.step(0.0004);
    }
    report(name, &mut fine, 0.0004, 50, 4);
}

fn report<L: Law>(name: &str, slope: &mut Scalar<L>, dt: f64, steps: usize, repeats: usize) {
    let mut best = 0f64;
    for _ in 0..repeats {
        let clock = Clock::start();
        for _ in 0..steps {
            slope.step(dt);
        }
        best = best.max(steps as f64 * slope.points() as f64 / clock.seconds());
    }
    let r = slope.sliding_distance(0.25);
    println!("{name:<8} {:>8} {:>8.2} {:>9.3} {r:>8.2}", slope.points(), best * 1e-6, slope.yielded());
}

fn slides() {
    slide::<Hencky<false>>("hencky, Cauchy strength");
    slide::<Hencky<true>>("hencky, Kirchhoff strength");
    slide::<Rate<false>>("rate, Cauchy strength");
    slide::<Rate<true>>("rate, Kirchhoff strength");
}

/// r(t) and its plateaus for 15 s, with and without PIC; then the spread under jittered strengths.
fn slide<L: Law>(name: &str) {
    for pic_rate in [0.0, 0.5] {
        let mut slope = Scalar::<L>::paper_slope(0.25, 2);
        slope.pic_rate = pic_rate;
        print!("{name}, pic_rate {pic_rate}/s: r(t)");
        let mut last = 0.0;
        while slope.time < 15.0 - 1e-9 {
            let next = slope.time + 0.1;
            run_to(&mut slope, next, 0.002);
            let r = slope.sliding_distance(0.25);
            if r != last {
                print!("  {:.1} s {r:.2}", slope.time);
                last = r;
            }
        }
        println!();
        let [low, high] = slope.jacobian_range();
        println!(
            "    moved {:.2} m, mass {:.6} t, kinetic {:.3} kJ, plastic strain {:.2}, J {low:.3} to {high:.3}",
            slope.max_displacement(),
            slope.mass(),
            slope.kinetic(),
            slope.max_plastic_strain()
        );
        let spread: Vec<f64> = (0..6).map(|seed| jittered::<L>(pic_rate, seed)).collect();
        println!("    strengths jittered by 0.05 %: {spread:.2?}");
    }
}

fn jittered<L: Law>(pic_rate: f64, seed: u64) -> f64 {
    let mut slope = Scalar::<L>::paper_slope(0.25, 2);
    slope.pic_rate = pic_rate;
    slope.jitter(0.0005, seed);
    run_to(&mut slope, 15.0, 0.002);
    slope.sliding_distance(0.25)
}

fn count(args: &[String]) {
    let steps = args.get(1).and_then(|s| s.parse().ok()).unwrap_or(1000);
    match args.first().map(String::as_str) {
        Some("rate") => count_law::<Rate>(steps),
        _ => count_law::<Hencky>(steps),
    }
}

fn count_law<L: Law>(steps: usize) {
    let mut slope = Scalar::<L>::paper_slope(0.25, 2);
    slope.ramp = 0.0;
    for _ in 0..steps {
        slope.step(0.002);
    }
    println!("{} particle-steps, yielded {:.3}", steps * slope.points(), slope.yielded());
}

fn run_to<L: Law>(slope: &mut Scalar<L>, time: f64, dt: f64) {
    while slope.time < time - 0.5 * dt {
        slope.step(dt);
    }
}

/// CPU time of this process from the scheduler where there is one to read, else the wall clock.
struct Clock {
    wall: Instant,
    cpu: Option<u64>,
}

impl Clock {
    fn start() -> Self {
        Self { wall: Instant::now(), cpu: scheduled_ns() }
    }

    fn name(&self) -> &'static str {
        if self.cpu.is_some() { "CPU time (/proc/self/schedstat)" } else { "wall time" }
    }

    fn seconds(&self) -> f64 {
        match (self.cpu, scheduled_ns()) {
            (Some(start), Some(end)) => (end - start) as f64 * 1e-9,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }
}

/// Nanoseconds that the main thread has spent on a CPU; giving way brings the account up to date.
fn scheduled_ns() -> Option<u64> {
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok()
}
