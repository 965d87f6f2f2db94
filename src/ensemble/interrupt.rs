//! Ctrl-C, and the signals by which a system asks a process to end.
use std::io::{self, Write as _};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

/// Whether we listen already.
static LISTENS: Mutex<bool> = Mutex::new(false);

/// The exit status of a command that was interrupted: 128 and the number of SIGINT.
pub const INTERRUPTED: i32 = 130;

/// Listens for interrupts from now on, and gives what the first one sets.
///
/// The first stops runs at their next tick and keeps what is finished; the second leaves at once
/// with [`INTERRUPTED`]. Asked again, it gives the same.
///
/// # Errors
/// When somebody else listens already, or the system does not let us.
pub fn stop_on_interrupt() -> io::Result<&'static AtomicBool> {
    let mut listens = LISTENS.lock().expect("nobody panics while it is held");
    if *listens {
        return Ok(&STOP);
    }
    ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED);
        }
        let message = "\nstopping; press Ctrl-C again to quit at once";
        let _ = writeln!(io::stderr(), "{message}");
    })
    .map_err(io::Error::other)?;
    *listens = true;
    Ok(&STOP)
}
