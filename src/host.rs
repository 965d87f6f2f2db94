//! Interface to the program that requests work: a terminal or another program.
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use stochc_compiler::Checked;

use crate::progress::WorkProgress;

/// Receives messages and progress of the work, and can stop it.
pub trait Host: Sync {
    /// Receives a note or a warning, in complete lines.
    fn warn(&self, text: &str);

    /// Receives warnings about a program. A quiet terminal ignores them.
    fn report_warnings(&self, text: &str) {
        self.warn(text);
    }

    /// Receives the failure of one part of the work, in complete lines. The rest continues.
    fn report_failure(&self, message: &str);

    /// Receives the diagnostics of a file, errors and warnings.
    fn report_diagnostics(&self, checked: &Checked);

    /// Returns diagnostics as text to include in a message.
    fn draw(&self, checked: &Checked) -> String;

    /// Returns the flag that stops the work at the next tick.
    fn stop(&self) -> &AtomicBool;

    /// Shows progress until the channel `ended` closes. `state` returns the progress after a
    /// duration.
    fn show(&self, state: &dyn Fn(Duration) -> WorkProgress, ended: &Receiver<()>);
}

/// Does some work while the host shows its progress. `state` returns the progress after a duration.
pub fn during<R>(
    host: &dyn Host,
    state: impl Fn(Duration) -> WorkProgress + Send,
    work: impl FnOnce() -> R,
) -> R {
    std::thread::scope(|scope| {
        // Dropped when the work ends, also by a panic. This ends the display.
        let (_working, ended) = channel();
        let show = move || host.show(&state, &ended);
        // If the thread cannot be started, the work runs without a display.
        let _ = std::thread::Builder::new().spawn_scoped(scope, show);
        work()
    })
}
