//! Handling of Ctrl-C and of the signals that ask a process to end.
use std::io::{self, Write as _};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::exit::{Exit, Failure};

/// Flag that the first interrupt sets.
pub(super) static STOP: AtomicBool = AtomicBool::new(false);

/// Whether the signal handlers are installed.
static LISTENS: Mutex<bool> = Mutex::new(false);

/// Installs the handlers for interrupts, and returns the flag that the first interrupt sets.
/// Further calls return the same flag.
///
/// The first interrupt stops runs at their next tick and stores the finished runs. The second
/// interrupt ends the process at once with the status of [`Exit::Interrupted`].
///
/// # Errors
/// If another handler is installed, or the system rejects the handlers.
pub fn stop_on_interrupt() -> Result<&'static AtomicBool, Failure> {
    let mut listens = LISTENS.lock().expect("no panic while it is locked");
    if *listens {
        return Ok(&STOP);
    }
    listen().map_err(|error| Failure::usage(format!("cannot listen for Ctrl-C: {error}")))?;
    *listens = true;
    Ok(&STOP)
}

/// Counts an interrupt. Sets the flag at the first interrupt, and ends the process at the second.
fn interrupted() {
    if STOP.swap(true, Ordering::Relaxed) {
        // End the process without waiting for its threads.
        std::process::exit(Exit::Interrupted.status().into());
    }
    let message = "\nstopping; press Ctrl-C again to quit at once";
    let _ = writeln!(io::stderr(), "{message}");
}

#[cfg(unix)]
fn listen() -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    // Signals that the caller has set to be ignored, as `nohup` does, stay ignored.
    let heeded = [SIGINT, SIGTERM, SIGHUP]
        .into_iter()
        .filter(|&signal| !is_ignored(signal));
    let mut signals = signal_hook::iterator::Signals::new(heeded)?;
    let thread = std::thread::Builder::new().name("signals".into());
    thread.spawn(move || signals.forever().for_each(|_| interrupted()))?;
    Ok(())
}

#[cfg(not(unix))]
fn listen() -> io::Result<()> {
    ctrlc::set_handler(interrupted).map_err(io::Error::other)
}

/// Returns whether the signal was ignored when the process started. Always `false` on systems
/// except Linux.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let mask = stochc_files::process::status("SigIgn");
    let mask = mask.and_then(|mask| u64::from_str_radix(&mask, 16).ok());
    mask.is_some_and(|mask| mask & (1 << (signal - 1)) != 0)
}

/// Prevents the signal for the file size limit from ending the process. A write beyond the limit
/// returns an error instead.
pub fn outlive_file_limit() {
    #[cfg(unix)]
    {
        let reached = std::sync::Arc::new(AtomicBool::new(false));
        // If the handler cannot be installed, the signal ends the process.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, reached);
    }
}
