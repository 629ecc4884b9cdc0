//! CPU time of one thread: runs go on beside one another, so that wall time says little.

use std::fs::read_to_string;

/// CPU time of the calling thread so far (s), where the system tells (Linux).
pub fn thread_seconds() -> Option<f64> {
    nanoseconds().or_else(ticks)
}

/// The first field of `schedstat` is the time on a processor (ns).
fn nanoseconds() -> Option<f64> {
    let text = read_to_string("/proc/thread-self/schedstat").ok()?;
    let spent: f64 = text.split_whitespace().next()?.parse().ok()?;
    (spent > 0.0).then_some(1e-9 * spent)
}

/// User and system time in clock ticks are fields 14 and 15 of `stat`, after the name in brackets.
fn ticks() -> Option<f64> {
    let text = read_to_string("/proc/thread-self/stat").ok()?;
    let mut fields = text.rsplit(')').next()?.split_whitespace().skip(11);
    let ticks = fields.next()?.parse::<f64>().ok()? + fields.next()?.parse::<f64>().ok()?;
    Some(ticks / 100.0)
}
