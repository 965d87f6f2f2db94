//! The Python caller as host of the work: collects messages until the work ends, and progress until
//! it is read.
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use stochc::compiler::Checked;
use stochc::diagnostics::{diagnostics_json, drawn};
use stochc::host::Host;
use stochc::progress::WorkProgress;
use stochc::results::now;

/// Width of drawings \[columns\].
pub const WIDTH: usize = 80;

/// Messages and progress for a caller.
#[derive(Debug, Default)]
pub struct Caller {
    stop: AtomicBool,
    log: Mutex<HostLog>,
    state: Mutex<WorkProgress>,
}

/// Messages so far.
#[derive(Debug, Default)]
pub struct HostLog {
    /// Notes and warnings.
    pub warnings: Vec<String>,
    /// Rendered diagnostics of files with warnings only.
    pub doubts: Vec<String>,
    /// Reasons of partial failures.
    pub failures: String,
    /// Diagnostics of files with errors.
    pub diagnostics: Vec<serde_json::Value>,
}

/// Locks a mutex. Data left by a panic of another thread are still valid.
fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Caller {
    /// Returns and removes all messages so far.
    pub fn log(&self) -> HostLog {
        std::mem::take(&mut *lock(&self.log))
    }

    /// Returns the progress of the work.
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
            log.doubts.push(drawn.trim_end().to_owned());
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
