//! Ctrl-C, and the signals by which a system asks a process to end.
use std::io::{self, Write as _};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::exit::{Exit, Failure};

static STOP: AtomicBool = AtomicBool::new(false);

/// Whether we listen already.
static LISTENS: Mutex<bool> = Mutex::new(false);

/// Listens for interrupts from now on, and gives what the first one sets.
///
/// The first stops runs at their next tick and keeps what is finished; the second leaves at once
/// with the status of [`Exit::Interrupted`]. Asked again, it gives the same.
///
/// # Errors
/// When somebody else listens already, or the system does not let us.
pub fn stop_on_interrupt() -> Result<&'static AtomicBool, Failure> {
    let mut listens = LISTENS.lock().expect("nobody panics while it is held");
    if *listens {
        return Ok(&STOP);
    }
    ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            // Whatever the threads do, they are not waited for.
            std::process::exit(Exit::Interrupted.status().into());
        }
        let message = "\nstopping; press Ctrl-C again to quit at once";
        let _ = writeln!(io::stderr(), "{message}");
    })
    .map_err(|error| Failure::usage(format!("cannot listen for Ctrl-C: {error}")))?;
    *listens = true;
    Ok(&STOP)
}
