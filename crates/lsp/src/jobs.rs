//! Background jobs. Each has its own thread and can be cancelled.
use std::collections::BTreeMap;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

use stochc_compiler::Cancellation;

/// Largest number of concurrent jobs. Each may use as much memory as
/// [`stochc_compiler::Limits::EDITOR`] allows.
const MAX: usize = 4;

/// Largest number of background jobs among the running jobs.
const MAX_UNASKED: usize = 2;

/// Stack size of a thread \[bytes\]: twice the need of the deepest nesting of expressions and
/// patterns.
const STACK: usize = 16 << 20;

/// Number of a started job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct JobId(u64);

/// Reason of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JobTrigger {
    /// A request is waiting for the job.
    Requested,
    /// No request is waiting for the job.
    Background,
}

/// Callback for the end of a job. The result is `None` if the job was cancelled or has failed.
type OnEnd<T> = dyn Fn(JobId, Option<T>) + Send + Sync;

/// Running jobs with results of type `T`.
pub struct Jobs<T> {
    on_end: Arc<OnEnd<T>>,
    running: BTreeMap<JobId, Running>,
    next: u64,
}

struct Running {
    is_cancelled: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

impl<T: 'static> Jobs<T> {
    /// Returns an empty set of jobs. `on_end` is called by the thread of each job.
    pub fn new(on_end: impl Fn(JobId, Option<T>) + Send + Sync + 'static) -> Jobs<T> {
        Jobs {
            on_end: Arc::new(on_end),
            running: BTreeMap::new(),
            next: 0,
        }
    }

    /// Returns whether another job may be started.
    pub fn has_room(&self, trigger: JobTrigger) -> bool {
        self.running.len()
            < match trigger {
                JobTrigger::Requested => MAX,
                JobTrigger::Background => MAX_UNASKED,
            }
    }

    /// Starts a job.
    ///
    /// # Errors
    ///
    /// If the system cannot start a thread for the job.
    pub fn start(
        &mut self,
        work: impl FnOnce(Cancellation<'_>) -> Option<T> + Send + 'static,
    ) -> io::Result<JobId> {
        let id = JobId(self.next);
        self.next += 1;
        let is_cancelled = Arc::new(AtomicBool::new(false));
        let (cancelled, on_end) = (is_cancelled.clone(), self.on_end.clone());
        let thread = thread::Builder::new().stack_size(STACK).spawn(move || {
            let ask = || cancelled.load(Ordering::Relaxed);
            // A panic costs one response, not the session.
            let done = catch_unwind(AssertUnwindSafe(|| work(Cancellation::new(&ask))));
            on_end(id, done.ok().flatten());
        })?;
        self.running.insert(
            id,
            Running {
                is_cancelled,
                thread,
            },
        );
        Ok(id)
    }
}

impl<T> Jobs<T> {
    /// Cancels a job. Its end is still reported.
    pub fn cancel(&self, id: JobId) {
        if let Some(running) = self.running.get(&id) {
            running.is_cancelled.store(true, Ordering::Relaxed);
        }
    }

    pub fn cancel_all(&self) {
        self.running.keys().for_each(|&id| self.cancel(id));
    }

    pub fn ended(&mut self, id: JobId) {
        if let Some(running) = self.running.remove(&id) {
            let _ = running.thread.join();
        }
    }
}

impl<T> Drop for Jobs<T> {
    /// Joins all threads, so that none outlives the session.
    fn drop(&mut self) {
        self.cancel_all();
        for (_, running) in std::mem::take(&mut self.running) {
            let _ = running.thread.join();
        }
    }
}
