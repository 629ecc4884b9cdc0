//! Exit codes, in one place.

use std::{
    io::{self, Write},
    process::ExitCode,
};

use crate::run::Status;

/// Why a command did not do all that it was asked for.
#[derive(Debug)]
pub enum Failure {
    /// The solver gave up; what it had is kept.
    Solver(String),
    /// Bad input; the text is ready to print.
    Input(String),
    /// Reading or writing failed.
    Io(String),
    /// A cap on time or memory was reached.
    Cap(String),
    /// Some runs of a study failed.
    Partly(String),
    /// Interrupted by the user.
    Interrupted(String),
}

impl Failure {
    /// A failure to read or write `what`.
    pub fn io(what: &str, error: &io::Error) -> Self {
        Failure::Io(format!("{what}: {error}"))
    }

    /// The failure that an outcome stands for, if any.
    pub fn of(status: Status, message: &str) -> Option<Self> {
        let text = message.to_owned();
        match status {
            Status::AtRest | Status::EndTime | Status::SlopeFailed => None,
            Status::Failed => Some(Failure::Solver(text)),
            Status::Interrupted => Some(Failure::Interrupted(text)),
            Status::ResourceCap => Some(Failure::Cap(text)),
        }
    }
}

/// 0 done, 1 the solver gave up, 2 bad input, 3 input/output, 4 over a cap, 5 some realisations
/// failed, 130 interrupted. A bug (panic) ends with 101.
pub fn code(done: Result<(), Failure>) -> ExitCode {
    let (code, text) = match done {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Solver(text)) => (1, text),
        Err(Failure::Input(text)) => (2, text),
        Err(Failure::Io(text)) => (3, text),
        Err(Failure::Cap(text)) => (4, text),
        Err(Failure::Partly(text)) => (5, text),
        Err(Failure::Interrupted(text)) => (130, text),
    };
    let text = if text.starts_with("error") { text } else { format!("error: {text}") };
    eprintln!("{}", text.trim_end());
    ExitCode::from(code)
}

/// Prints on standard output. A reader that has closed its end is no failure: it has what it
/// wanted.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(Failure::io("standard output", &e)),
        _ => Ok(()),
    }
}
