//! How ensembles are run: options that `ensemble`, `study` and `compare rfem` share.

use std::time::Duration;

use super::interrupt;
use crate::study::ensemble::{Conduct, Start};

// flattened beside another group of this name
#[derive(Debug, clap::Args)]
#[group(skip)]
pub struct Options {
    /// Go on with what the folder holds
    #[arg(long, conflicts_with = "fresh")]
    resume: bool,
    /// Start over, whatever the folder holds
    #[arg(long)]
    fresh: bool,
    /// Realisations at a time; all cores without it
    #[arg(long, short = 'j', value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Begin no realisation after this much wall time (s)
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    time_limit: Option<Duration>,
    /// No progress bar
    #[arg(long, short)]
    pub quiet: bool,
    /// Print JSON on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

impl Options {
    /// With at most so much memory for a run (bytes); the interrupts are listened to from now on.
    pub fn conduct(&self, max_memory: u64) -> Conduct {
        Conduct {
            start: match (self.resume, self.fresh) {
                (true, _) => Start::Resume,
                (_, true) => Start::Fresh,
                _ => Start::New,
            },
            threads: self.jobs.map_or(0, usize::from),
            max_memory,
            time_limit: self.time_limit,
            stop: interrupt::flag(),
            abandon: interrupt::second(),
        }
    }
}

/// A length of time (s).
fn seconds(text: &str) -> Result<Duration, String> {
    let wrong = || format!("'{text}' is no time in s");
    Duration::try_from_secs_f64(text.trim().parse().map_err(|_| wrong())?).map_err(|_| wrong())
}
