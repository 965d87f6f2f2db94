//! Work beside the thread that answers: each job on a thread of its own, and each can be cancelled.
use std::collections::BTreeMap;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;
use std::thread::{self, JoinHandle};

use stochc_compiler::Cancellation;

use super::server::{Done, ServerEvent};

/// Jobs that run at once, at most: each may hold a program of the size that [`stochc_compiler::Limits::EDITOR`] allows.
const MOST: usize = 4;

/// Of these, the jobs that nobody has asked for.
const MOST_UNASKED: usize = 2;

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

/// The jobs under way.
pub struct Jobs {
    events: SyncSender<ServerEvent>,
    running: BTreeMap<JobId, Running>,
    next: u64,
}

struct Running {
    is_cancelled: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

impl Jobs {
    /// None yet; their ends will be told as [`ServerEvent::Done`].
    pub fn new(events: SyncSender<ServerEvent>) -> Jobs {
        Jobs {
            events,
            running: BTreeMap::new(),
            next: 0,
        }
    }

    /// Whether one more may be started.
    pub fn has_room(&self, wanted: JobTrigger) -> bool {
        self.running.len()
            < match wanted {
                JobTrigger::Requested => MOST,
                JobTrigger::Background => MOST_UNASKED,
            }
    }

    /// Starts a job.
    ///
    /// # Errors
    ///
    /// If the system has no thread for it.
    pub fn start(
        &mut self,
        work: impl FnOnce(Cancellation<'_>) -> Option<Done> + Send + 'static,
    ) -> io::Result<JobId> {
        let id = JobId(self.next);
        self.next += 1;
        let is_cancelled = Arc::new(AtomicBool::new(false));
        let (asked, events) = (is_cancelled.clone(), self.events.clone());
        let thread = thread::Builder::new().stack_size(STACK).spawn(move || {
            let ask = || asked.load(Ordering::Relaxed);
            // A mistake of the server's costs an answer, not the conversation.
            let done = catch_unwind(AssertUnwindSafe(|| work(Cancellation::new(&ask))));
            // Nobody listens after the end.
            let _ = events.send(ServerEvent::Done(id, done.ok().flatten()));
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

    /// Lets a job end soon; its end is still told.
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

impl Drop for Jobs {
    /// No thread outlives the conversation.
    fn drop(&mut self) {
        self.cancel_all();
        for (_, running) in std::mem::take(&mut self.running) {
            let _ = running.thread.join();
        }
    }
}
