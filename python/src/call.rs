//! Execution of work in a separate thread, without the interpreter's lock. Ctrl-C stops the work,
//! and panics become exceptions.
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use stochc::exit::Failure;
use stochc::host::Host as _;

use super::exceptions::{defect, exception, warn};
use super::host::Caller;

/// Interval between two checks for signals and reports of progress.
const PERIOD: Duration = Duration::from_millis(50);

/// Runs `work`, reports its progress and returns its result.
///
/// # Errors
///
/// Converts the failure of the work to an exception of `stochc`. An exception from a signal or from
/// `progress` stops the work at its next tick.
pub fn call<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Caller) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    let caller = Arc::new(Caller::default());
    let (sender, receiver) = channel::<()>();
    let theirs = caller.clone();
    // The stack is as large as the stack of a main thread.
    let thread = (std::thread::Builder::new().name("stochc".into())).stack_size(8 << 20);
    let thread = thread.spawn(move || {
        // The sender is dropped at the end of the work, even by a panic.
        let _sender = sender;
        catch_unwind(AssertUnwindSafe(|| work(&theirs)))
    });
    let thread = thread
        .map_err(|error| PyRuntimeError::new_err(format!("cannot start a thread: {error}")))?;
    let receiver = Mutex::new(receiver);
    let mut interrupt = None;
    let mut shown = None;
    let mut show = |state: stochc::progress::WorkProgress| -> PyResult<()> {
        let (Some(progress), false) = (progress, shown.as_ref() == Some(&state)) else {
            return Ok(());
        };
        if state != stochc::progress::WorkProgress::default() {
            progress.call1((state.share, state.done.clone() + &state.more))?;
        }
        shown = Some(state);
        Ok(())
    };
    let is_over = || {
        let receiver = receiver.lock().expect("it is locked once");
        receiver.recv_timeout(PERIOD) != Err(RecvTimeoutError::Timeout)
    };
    while !py.detach(is_over) {
        if interrupt.is_none()
            && let Err(raised) = py.check_signals().and_then(|()| show(caller.state()))
        {
            caller.stop().store(true, Ordering::Relaxed);
            interrupt = Some(raised);
        }
    }
    let done = py.detach(|| thread.join());
    if let Some(raised) = interrupt {
        return Err(raised);
    }
    let log = caller.log();
    match done {
        Err(panic) | Ok(Err(panic)) => Err(defect(py, &*panic)),
        Ok(Ok(Err(failure))) => {
            warn(py, &log)?;
            Err(exception(py, &failure, &log))
        }
        Ok(Ok(Ok(value))) => {
            show(caller.state())?;
            warn(py, &log)?;
            Ok(value)
        }
    }
}
