//! The caller as the host of work: keeps what it hears until the work is over, and what it sees until somebody looks.
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use stochc::compiler::Checked;
use stochc::diagnostics::{drawn, values};
use stochc::ensemble::clock::now;
use stochc::host::Host;
use stochc::progress::WorkProgress;

/// Columns of what is drawn.
pub const WIDTH: usize = 100;

/// What a caller has heard and seen.
#[derive(Debug, Default)]
pub struct Caller {
    stop: AtomicBool,
    log: Mutex<HostLog>,
    state: Mutex<WorkProgress>,
}

/// What it has heard.
#[derive(Debug, Default)]
pub struct HostLog {
    /// Notes and warnings.
    pub warnings: Vec<String>,
    /// Findings of files that have nothing but warnings, drawn.
    pub doubts: Vec<String>,
    /// Why parts of the work have failed.
    pub failures: String,
    /// The findings of files that are wrong.
    pub findings: Vec<serde_json::Value>,
}

/// What a panic of another thread has left is as good as any.
fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Caller {
    /// All that it has heard until now, once.
    pub fn log(&self) -> HostLog {
        std::mem::take(&mut *lock(&self.log))
    }

    /// How far the work is.
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

    fn report_findings(&self, checked: &Checked) {
        let drawn = self.draw(checked);
        let mut log = lock(&self.log);
        if checked.has_errors() {
            log.failures += &drawn;
            log.findings.extend(values(checked));
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
