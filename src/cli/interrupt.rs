//! Ctrl-C and TERM: finish what is under way, keep what was done.

use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the first interrupt.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// The flag that interrupts set from now on.
pub fn flag() -> &'static AtomicBool {
    // a second handler is refused; the first one serves as well
    let _ = ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed));
    &INTERRUPTED
}
