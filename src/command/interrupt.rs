//! Ctrl-C, and the signals by which a system asks a process to end.
use std::io::{self, Write as _};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::exit::{Exit, Failure};

/// What the first interrupt sets.
pub(super) static STOP: AtomicBool = AtomicBool::new(false);

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
    let mut listens = LISTENS.lock().expect("no panic while it is locked");
    if *listens {
        return Ok(&STOP);
    }
    listen().map_err(|error| Failure::usage(format!("cannot listen for Ctrl-C: {error}")))?;
    *listens = true;
    Ok(&STOP)
}

/// What an interrupt does.
fn interrupted() {
    if STOP.swap(true, Ordering::Relaxed) {
        // Whatever the threads do, they are not waited for.
        std::process::exit(Exit::Interrupted.status().into());
    }
    let message = "\nstopping; press Ctrl-C again to quit at once";
    let _ = writeln!(io::stderr(), "{message}");
}

#[cfg(unix)]
fn listen() -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    // Whoever starts us with `nohup`, or in the background, has decided what does not end us.
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

/// Returns whether a signal was ignored when the process began; only Linux says so without unsafe
/// code.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let mask = stochc_files::process::status("SigIgn");
    let mask = mask.and_then(|mask| u64::from_str_radix(&mask, 16).ok());
    mask.is_some_and(|mask| mask & (1 << (signal - 1)) != 0)
}

/// Makes a limit on the size of files an error of those who write, instead of the end of the process.
pub fn outlive_file_limit() {
    #[cfg(unix)]
    {
        let reached = std::sync::Arc::new(AtomicBool::new(false));
        // Where it cannot be had, the process ends as it always has.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, reached);
    }
}
