//! Whoever has work done: a terminal, or another program.
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use stochc_compiler::Checked;

use crate::progress::WorkProgress;

/// Hears what is no reason to stop, sees how far the work is, and may stop it.
pub trait Host: Sync {
    /// Hears a note or a warning, in whole lines.
    fn warn(&self, text: &str);

    /// Prints the diagnostics of a program, if they are warnings. A quiet terminal leaves them out.
    fn report_warnings(&self, text: &str) {
        self.warn(text);
    }

    /// Hears why a part of the work has failed while the rest of it goes on, in whole lines.
    fn report_failure(&self, message: &str);

    /// Hears the diagnostics of a file, errors or not.
    fn report_diagnostics(&self, checked: &Checked);

    /// Draws diagnostics as it shows them, to stand within a message.
    fn draw(&self, checked: &Checked) -> String;

    /// Is set to have the work stop at the next tick.
    fn stop(&self) -> &AtomicBool;

    /// Shows how far some work is, which `state` says after so much time, until it has `ended`: the channel closes.
    fn show(&self, state: &dyn Fn(Duration) -> WorkProgress, ended: &Receiver<()>);
}

/// Does some work, and has the host show how far it is, which `state` says after so much time.
pub fn during<R>(
    host: &dyn Host,
    state: impl Fn(Duration) -> WorkProgress + Send,
    work: impl FnOnce() -> R,
) -> R {
    std::thread::scope(|scope| {
        // Dropped at the end of the work, also by a panic; that is what ends the display.
        let (_working, ended) = channel();
        let show = move || host.show(&state, &ended);
        // The work goes on where the system has no thread to show it.
        let _ = std::thread::Builder::new().spawn_scoped(scope, show);
        work()
    })
}
