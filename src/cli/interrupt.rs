//! Interrupts: Ctrl-C, TERM, HUP and, where there is one, USR1, which batch systems send before they
//! end a job. The first asks to finish what is under way, a second to leave it.

use std::sync::{
    Once,
    atomic::{AtomicBool, Ordering},
};

/// Set by the first interrupt.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Set by the second.
static AGAIN: AtomicBool = AtomicBool::new(false);
static LISTENING: Once = Once::new();

/// The flag that interrupts set from now on.
pub fn flag() -> &'static AtomicBool {
    listen();
    &INTERRUPTED
}

/// The flag that the second interrupt sets, for studies that finish their runs after the first.
pub fn second() -> &'static AtomicBool {
    listen();
    &AGAIN
}

fn listen() {
    LISTENING.call_once(|| {
        // without a handler the signal ends the program at once, as it does everywhere
        let _ = ctrlc::set_handler(note);
        #[cfg(unix)]
        listen_for_usr1();
    });
}

#[cfg(unix)]
fn listen_for_usr1() {
    use signal_hook::{consts::SIGUSR1, iterator::Signals};
    if let Ok(mut signals) = Signals::new([SIGUSR1]) {
        let wait = move || signals.forever().for_each(|_| note());
        let _ = std::thread::Builder::new().name("signals".to_owned()).spawn(wait);
    }
}

fn note() {
    if INTERRUPTED.swap(true, Ordering::Relaxed) {
        AGAIN.store(true, Ordering::Relaxed);
    }
}
