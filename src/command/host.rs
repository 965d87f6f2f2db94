//! [`Host`] that writes to the terminal.
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::Receiver;
use std::time::Duration;

use stochc_compiler::Checked;

use super::interrupt::STOP;
use super::progress::Display;
use super::terminal::{
    close, defer, has_colour, is_quiet, message_width, show_deferred, warn, warn_drawn,
};
use crate::diagnostics::{drawn, drawn_errors, warning_lines};
use crate::host::Host;
use crate::progress::WorkProgress;

/// Terminal as the host of operations. Its standard error may also be redirected.
#[derive(Clone, Copy, Debug)]
pub struct Terminal {
    display: Display,
}

impl Default for Terminal {
    /// Creates a terminal whose messages go to standard error.
    fn default() -> Terminal {
        let display = Display::on_standard_error(is_quiet());
        Terminal { display }
    }
}

impl Host for Terminal {
    fn warn(&self, text: &str) {
        warn(text);
    }

    fn note(&self, text: &str) {
        close(text);
    }

    fn report_failure(&self, message: &str) {
        warn_drawn(message);
    }

    /// Draws errors over the source, and prints each warning on one line.
    fn report_diagnostics(&self, checked: &Checked) {
        if checked.has_errors() {
            warn_drawn(&drawn_errors(checked, has_colour(), message_width()));
        }
        defer(&warning_lines(checked));
    }

    fn draw(&self, checked: &Checked) -> String {
        drawn(checked, has_colour(), message_width())
    }

    /// Returns the flag that an interrupt sets.
    /// [`stop_on_interrupt`](super::interrupt::stop_on_interrupt) installs the handler.
    fn stop(&self) -> &AtomicBool {
        &STOP
    }

    fn show(&self, state: &dyn Fn(Duration) -> WorkProgress, ended: &Receiver<()>) {
        show_deferred();
        self.display.show(state, ended);
    }
}
