//! The command line: arguments in, exit code out.

mod check;
mod compare;
mod conduct;
mod converge;
mod cost;
mod ensemble;
mod exit;
mod explain;
mod field;
mod input;
mod interrupt;
mod merge;
mod multilevel;
mod new;
mod plot;
mod progress;
mod solve;
mod study;
mod summary;
mod validate;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

pub use exit::Failure;

/// Slope failure with the random material point method.
#[derive(Debug, Parser)]
#[command(name = "rmpm", version, about, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Write a commented case file to start from
    New(new::Args),
    /// Check a case file without running it
    Check(check::Args),
    /// List the effects of a case: on or off, why, and what each costs
    Explain(explain::Args),
    /// Draw the random fields of a case: how accurate their generators are, and their values
    Field(field::Args),
    /// Run a case and leave record, history, frames and pictures in a folder
    Solve(solve::Args),
    /// Run many realisations of a random case, each safe as soon as it is done, and sum them up
    Ensemble(ensemble::Args),
    /// Put the shards of an ensemble together
    Merge(merge::Args),
    /// How an answer depends on mesh, points or any key: median and spread of jittered runs
    Converge(converge::Args),
    /// What accuracy costs in time: error and CPU time of many settings, and the cheapest ones
    Cost(cost::Args),
    /// What the mean over realisations costs: bias against standard error, and multilevel Monte Carlo
    Multilevel(multilevel::Args),
    /// Compare the explicit with the implicit scheme on one case
    Compare(compare::Args),
    /// Run several ensembles side by side, with tables, pictures and a report
    Study(study::Args),
    /// Run the problems with known answers and compare
    Validate(validate::Args),
    /// Redraw the pictures of a run from its frames
    Plot(plot::Args),
    /// Print the completion script of a shell
    Completions {
        /// Which shell
        shell: clap_complete::Shell,
    },
}

/// Runs the program.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let done = match cli.verb {
        Verb::New(args) => new::run(&args),
        Verb::Check(args) => check::run(&args),
        Verb::Explain(args) => explain::run(&args),
        Verb::Field(args) => field::run(&args),
        Verb::Solve(args) => solve::run(&args),
        Verb::Ensemble(args) => ensemble::run(&args),
        Verb::Merge(args) => merge::run(&args),
        Verb::Converge(args) => converge::run(&args),
        Verb::Cost(args) => cost::run(&args),
        Verb::Multilevel(args) => multilevel::run(&args),
        Verb::Compare(args) => compare::run(&args),
        Verb::Study(args) => study::run(&args),
        Verb::Validate(args) => validate::run(&args),
        Verb::Plot(args) => plot::run(&args),
        Verb::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "rmpm", &mut script);
            exit::print(&String::from_utf8_lossy(&script))
        }
    };
    exit::code(done)
}
