//! Work beside the thread that answers: each job on a thread of its own, and each can be cancelled.
use std::collections::BTreeMap;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

use stochc_compiler::Cancellation;

/// Jobs that run at once, at most: each may hold a program of the size that [`stochc_compiler::Limits::EDITOR`] allows.
const MAX: usize = 4;

/// Of these, the jobs that nobody has asked for.
const MAX_UNASKED: usize = 2;

/// Bytes of a thread's stack: as deep as expressions and patterns may be nested, twice over.
const STACK: usize = 16 << 20;

/// A job that has been started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct JobId(u64);

/// What a job is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JobTrigger {
    /// A request waits for it.
    Requested,
    /// Nobody waits.
    Background,
}

/// What is done with the outcome of a job; of one that was cancelled or has failed there is none.
type OnEnd<T> = dyn Fn(JobId, Option<T>) + Send + Sync;

/// The jobs under way, each with a `T` as its outcome.
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
    /// None yet; `on_end` is called by the thread of each.
    pub fn new(on_end: impl Fn(JobId, Option<T>) + Send + Sync + 'static) -> Jobs<T> {
        Jobs {
            on_end: Arc::new(on_end),
            running: BTreeMap::new(),
            next: 0,
        }
    }

    /// Whether one more may be started.
    pub fn has_room(&self, wanted: JobTrigger) -> bool {
        self.running.len()
            < match wanted {
                JobTrigger::Requested => MAX,
                JobTrigger::Background => MAX_UNASKED,
            }
    }

    /// Starts a job.
    ///
    /// # Errors
    ///
    /// If the system has no thread for it.
    pub fn start(
        &mut self,
        work: impl FnOnce(Cancellation<'_>) -> Option<T> + Send + 'static,
    ) -> io::Result<JobId> {
        let id = JobId(self.next);
        self.next += 1;
        let is_cancelled = Arc::new(AtomicBool::new(false));
        let (asked, on_end) = (is_cancelled.clone(), self.on_end.clone());
        let thread = thread::Builder::new().stack_size(STACK).spawn(move || {
            let ask = || asked.load(Ordering::Relaxed);
            // A mistake of the server's costs an answer, not the conversation.
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
    /// Lets a job end soon; its end is still reported.
    pub fn cancel(&self, id: JobId) {
        if let Some(running) = self.running.get(&id) {
            running.is_cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// Lets all of them end soon.
    pub fn cancel_all(&self) {
        self.running.keys().for_each(|&id| self.cancel(id));
    }

    /// Takes note that a job has ended.
    pub fn ended(&mut self, id: JobId) {
        if let Some(running) = self.running.remove(&id) {
            let _ = running.thread.join();
        }
    }
}

impl<T> Drop for Jobs<T> {
    /// No thread outlives the conversation.
    fn drop(&mut self) {
        self.cancel_all();
        for (_, running) in std::mem::take(&mut self.running) {
            let _ = running.thread.join();
        }
    }
}
