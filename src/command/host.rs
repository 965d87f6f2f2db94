//! What commands say while they work, on a terminal or whatever stands in its place.
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::Receiver;
use std::time::Duration;

use stochc_compiler::Checked;

use super::interrupt::STOP;
use super::progress::Display;
use super::terminal::{has_colour, message_width, warn, warn_drawn};
use crate::diagnostics::drawn;
use crate::host::Host;
use crate::progress::WorkProgress;

/// The terminal of a command, or whatever stands in its place.
#[derive(Clone, Copy, Debug)]
pub struct Terminal {
    display: Display,
}

impl Terminal {
    /// Standard error, which is shown no progress if it is to be `quiet`.
    pub fn new(quiet: bool) -> Terminal {
        let display = Display::on_standard_error(quiet);
        Terminal { display }
    }
}

impl Host for Terminal {
    fn warn(&self, text: &str) {
        warn(text);
    }

    fn report_failure(&self, message: &str) {
        warn_drawn(message);
    }

    fn report_findings(&self, checked: &Checked) {
        warn_drawn(&self.draw(checked));
    }

    fn draw(&self, checked: &Checked) -> String {
        drawn(checked, has_colour(), message_width())
    }

    /// Set by an interrupt, once somebody [listens](super::interrupt::stop_on_interrupt).
    fn stop(&self) -> &AtomicBool {
        &STOP
    }

    fn show(&self, state: &dyn Fn(Duration) -> WorkProgress, ended: &Receiver<()>) {
        self.display.show(state, ended);
    }
}
