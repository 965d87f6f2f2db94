//! Views of runs under way: asked for by whoever shows them, given by the thread of the run at its next tick.
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use stochc_runtime::view::RunView;

use super::clock::now;

/// Nobody has to give a view.
const NOBODY: usize = usize::MAX;

/// A run under way, as it stood when it was asked.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewedRun {
    /// The index of its program.
    pub program: usize,
    /// Its number.
    pub run: u64,
    /// How it stood.
    pub view: RunView,
    /// What it has cost the run.
    pub took: Duration,
}

/// The latest view, and who is to give the next one.
pub(super) struct Views {
    asked: AtomicUsize,
    given: Mutex<Option<ViewedRun>>,
}

impl Views {
    pub fn new() -> Views {
        Views {
            asked: AtomicUsize::new(NOBODY),
            given: Mutex::new(None),
        }
    }

    /// Asks a thread for a view.
    pub fn ask(&self, worker: usize) {
        self.asked.store(worker, Ordering::Relaxed);
    }

    /// Whether a thread has been asked: once a tick, so that it has to cost nothing.
    pub fn is_asked(&self, worker: usize) -> bool {
        self.asked.load(Ordering::Relaxed) == worker
    }

    /// Gives what was asked for.
    pub fn give(&self, (program, run): (usize, u64), make: &dyn Fn() -> RunView) {
        self.asked.store(NOBODY, Ordering::Relaxed);
        let begun = now();
        let view = make();
        let viewed = ViewedRun {
            program,
            run,
            view,
            took: begun.elapsed(),
        };
        // It is held for a moment only.
        *self.given.lock().expect("nobody panics while it is held") = Some(viewed);
    }

    /// Takes what was given.
    pub fn take(&self) -> Option<ViewedRun> {
        (self.given.lock().expect("nobody panics while it is held")).take()
    }
}
