//! Interface of operations to their caller: a terminal or another application.
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use stochc_compiler::Checked;

use crate::progress::WorkProgress;

/// Caller of an operation. Receives messages and progress, and can stop the work.
pub trait Host: Sync {
    /// Receives a warning, in complete lines.
    fn warn(&self, text: &str);

    /// Receives a note, in complete lines. A quiet terminal does not print it.
    fn note(&self, text: &str) {
        self.warn(text);
    }

    /// Receives the failure of one part of the work, in complete lines. The other parts continue.
    fn report_failure(&self, message: &str);

    /// Receives all diagnostics of a file.
    fn report_diagnostics(&self, checked: &Checked);

    /// Returns the diagnostics of a file as text for a message.
    fn draw(&self, checked: &Checked) -> String;

    /// Returns a flag. Setting this flag stops the work at the next tick.
    fn stop(&self) -> &AtomicBool;

    /// Shows progress until the channel `ended` closes. `state` takes the time since the start and
    /// returns the progress.
    fn show(&self, state: &dyn Fn(Duration) -> WorkProgress, ended: &Receiver<()>);
}

/// Runs `work` while the host shows its progress. `state` takes the time since the start and
/// returns the progress.
pub fn during<R>(
    host: &dyn Host,
    state: impl Fn(Duration) -> WorkProgress + Send,
    work: impl FnOnce() -> R,
) -> R {
    std::thread::scope(|scope| {
        // The sender is dropped when the work ends, even by a panic. This ends the display.
        let (_working, ended) = channel();
        let show = move || host.show(&state, &ended);
        // If the thread cannot be started, the work runs without a progress display.
        let _ = std::thread::Builder::new().spawn_scoped(scope, show);
        work()
    })
}
