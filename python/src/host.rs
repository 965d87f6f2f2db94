//! Host for work that Python calls. Stores messages until the work ends, and progress until it is
//! read.
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use stochc::compiler::Checked;
use stochc::diagnostics::{diagnostics_json, drawn};
use stochc::host::Host;
use stochc::progress::WorkProgress;
use stochc::results::now;

/// Width of drawn diagnostics \[columns\].
pub const WIDTH: usize = 80;

/// Host that stores the messages and progress of work.
#[derive(Debug, Default)]
pub struct Caller {
    stop: AtomicBool,
    log: Mutex<HostLog>,
    state: Mutex<WorkProgress>,
}

/// Messages that the work has reported so far.
#[derive(Debug, Default)]
pub struct HostLog {
    /// Notes and warnings.
    pub warnings: Vec<String>,
    /// Rendered diagnostics of files that have only warnings.
    pub rendered: Vec<String>,
    /// Messages about failures of parts of the work.
    pub failures: String,
    /// Diagnostics of files with errors.
    pub diagnostics: Vec<serde_json::Value>,
}

/// Locks a mutex. Data are valid even if another thread has panicked.
fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Caller {
    /// Returns the messages since the last call and removes them.
    pub fn log(&self) -> HostLog {
        std::mem::take(&mut *lock(&self.log))
    }

    /// Returns the current progress of the work.
    pub fn state(&self) -> WorkProgress {
        lock(&self.state).clone()
    }
}

impl Host for Caller {
    fn warn(&self, text: &str) {
        lock(&self.log).warnings.push(text.trim_end().to_owned());
    }

    fn report_failure(&self, message: &str) {
        lock(&self.log).failures += message;
    }

    fn report_diagnostics(&self, checked: &Checked) {
        let drawn = self.draw(checked);
        let mut log = lock(&self.log);
        if checked.has_errors() {
            log.failures += &drawn;
            log.diagnostics.extend(diagnostics_json(checked));
        } else if !drawn.is_empty() {
            log.rendered.push(drawn.trim_end().to_owned());
        }
    }

    fn draw(&self, checked: &Checked) -> String {
        drawn(checked, false, WIDTH)
    }

    fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    fn show(&self, state: &dyn Fn(Duration) -> WorkProgress, ended: &Receiver<()>) {
        let start = now();
        loop {
            let now = state(start.elapsed());
            *lock(&self.state) = now;
            match ended.recv_timeout(Duration::from_millis(100)) {
                Err(RecvTimeoutError::Timeout) => {}
                _ => break,
            }
        }
        let last = state(start.elapsed());
        *lock(&self.state) = WorkProgress {
            more: String::new(),
            ..last
        };
    }
}
