//! The progress bar, on standard error.

use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use crate::run::Sample;

/// Simulated time, rate and time left.
pub struct Progress {
    bar: ProgressBar,
    started: Instant,
    end: f64,
}

/// Ticks of the bar over the whole run.
const TICKS: u64 = 1000;

impl Progress {
    /// A bar up to the simulated time `end` (s); silent if not wanted or not a terminal.
    pub fn new(end: f64, quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(TICKS) };
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {msg}") {
            bar.set_style(style);
        }
        Progress { bar, started: Instant::now(), end }
    }

    /// Shows where the run is.
    pub fn show(&self, s: &Sample) {
        let wall = self.started.elapsed().as_secs_f64().max(1e-9);
        let done = (s.time / self.end).clamp(0.0, 1.0);
        let left = if done > 0.0 { wall * (1.0 - done) / done } else { 0.0 };
        let rate = s.particle_steps as f64 / wall / 1e6;
        let r = s.sliding_distance.map(|r| format!("  r = {r:.2} m")).unwrap_or_default();
        self.bar.set_message(format!(
            "t = {:.2} of {} s  {rate:.1} M particle-steps/s  at most {left:.0} s left{r}",
            s.time, self.end
        ));
        self.bar.set_position((done * TICKS as f64) as u64);
    }

    /// Takes the bar away.
    pub fn done(&self) {
        self.bar.finish_and_clear();
    }
}

/// A bar over the runs of a study: told how many of how many are done. Silent if not wanted or not a
/// terminal.
pub fn runs_bar(quiet: bool) -> impl Fn(usize, usize) {
    let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(0) };
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos} of {len} runs, {eta} left") {
        bar.set_style(style);
    }
    move |done, all| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
        if done == all {
            bar.finish_and_clear();
        }
    }
}
