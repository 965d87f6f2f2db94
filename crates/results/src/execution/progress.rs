//! What the runs under way are doing: written once a tick by the threads, read by whoever shows it.
use std::cell::Cell;
use std::io::Read;
use std::num::NonZeroUsize;
use std::ops::{ControlFlow, Range};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::table::PhaseId;
use stochc_runtime::Save;

use crate::checkpoint::RunCheckpoints;
use crate::execution::PendingRun;
use crate::execution::is_panic;
use crate::now;
use crate::{Checkpoints, Finished, JournalError, Manifest, Records};

/// In place of a program: the worker has nothing to do.
const IDLE: usize = usize::MAX;

/// The state of an ensemble, shared by its threads and whoever shows it.
pub struct Progress {
    total: u64,
    /// When the first run is started, and how long runs are started from then on.
    limit: Option<(Instant, Duration)>,
    /// Whether the CPU time of each run is measured.
    pub(crate) measures_cpu: bool,
    workers: Vec<Worker>,
    totals: Mutex<Totals>,
}

/// Where one worker is.
struct Worker {
    program: AtomicUsize,
    phase: AtomicU32,
    tick: AtomicU64,
}

/// What has been finished.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Totals {
    /// For each program.
    pub programs: Vec<ProgramProgress>,
    /// Runs that were stopped by a timeout or the limit of ticks.
    pub stopped: u64,
    /// Runs whose physics broke down.
    pub failed: u64,
    /// Ticks simulated by this process in runs that are finished.
    pub ticks_here: u64,
}

/// How long the runs of a program take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProgramProgress {
    /// Finished runs, of this process or an earlier one.
    pub done: u64,
    /// Their ticks together.
    pub ticks: u64,
    /// Runs that are not finished.
    pub left: u64,
    /// Ticks of those of them that are under way.
    pub under_way: u64,
}

/// All of it at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Runs asked for.
    pub total: u64,
    /// Runs finished.
    pub done: u64,
    /// What has been finished, program by program.
    pub totals: Totals,
    /// Ticks simulated by this process.
    pub ticks_here: u64,
    /// The program and phase of each run under way.
    pub under_way: Vec<(usize, PhaseId)>,
}

/// A run's line to the outside, which it calls once a tick.
pub struct RunWatch<'a> {
    worker: &'a Worker,
    /// Set by somebody else, and where runs cannot be kept any more.
    stops: [&'a AtomicBool; 2],
    /// `None`: its state is not kept.
    checkpoints: Option<RunCheckpoints<'a>>,
    /// Whether the run began with a checkpoint.
    is_continued: Cell<bool>,
}

impl RunWatch<'_> {
    /// Says how far the run is; breaks when it should stop at once, and be forgotten.
    pub fn tick(&self, tick: u64, phase: PhaseId) -> ControlFlow<()> {
        // Each of these stands for itself, so that no order among them is needed.
        self.worker.tick.store(tick, Ordering::Relaxed);
        self.worker.phase.store(phase.0, Ordering::Relaxed);
        if let Some(checkpoints) = &self.checkpoints {
            checkpoints.tick(tick, self.stops[0].load(Ordering::Relaxed));
        }
        if self.stops.iter().any(|stop| stop.load(Ordering::Relaxed)) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Whether the run has to be made again from its beginning, because nothing came of what was kept of it.
    pub(crate) fn begins_anew(&self, made: Option<&RunRecord>) -> bool {
        let is_wrong = match made {
            Some(record) => is_panic(record),
            None => !self.stops.iter().any(|stop| stop.load(Ordering::Relaxed)),
        };
        let checkpoints = self.checkpoints.as_ref().filter(|_| is_wrong);
        checkpoints.is_some_and(RunCheckpoints::begins_anew)
    }

    /// Returns whether the run was continued from a checkpoint.
    pub(crate) fn is_continued(&self) -> bool {
        self.is_continued.get()
    }

    /// The tick and phase told last.
    pub(crate) fn last(&self) -> (u64, PhaseId) {
        let phase = PhaseId(self.worker.phase.load(Ordering::Relaxed));
        (self.worker.tick.load(Ordering::Relaxed), phase)
    }
}

impl stochc_runtime::Watch for &RunWatch<'_> {
    fn tick(&mut self, tick: u64, phase: PhaseId) -> ControlFlow<()> {
        RunWatch::tick(self, tick, phase)
    }

    fn kept(&mut self) -> Option<Box<dyn Read>> {
        let state = self.checkpoints.as_ref()?.begin();
        self.is_continued.set(state.is_some());
        state
    }

    fn wants_state(&mut self) -> bool {
        self.checkpoints
            .as_ref()
            .is_some_and(RunCheckpoints::is_due)
    }

    fn keep(&mut self, save: &mut Save<'_>) {
        if let Some(checkpoints) = &self.checkpoints {
            checkpoints.keep(save);
        }
    }
}

impl Progress {
    /// The state before the first run, for so many threads.
    pub fn new(manifest: &Manifest, threads: NonZeroUsize) -> Progress {
        Progress::of_jobs(manifest, &(0..manifest.total()), threads)
    }

    /// The same for a part of the [jobs](crate::execution::job).
    pub(crate) fn of_jobs(
        manifest: &Manifest,
        jobs: &Range<u64>,
        threads: NonZeroUsize,
    ) -> Progress {
        let programs = manifest.programs.len() as u64;
        // How many of the jobs before one are runs of a program.
        let before = |job: u64, program: u64| job / programs + u64::from(job % programs > program);
        let pace = |program: u64| ProgramProgress {
            left: before(jobs.end, program) - before(jobs.start, program),
            ..ProgramProgress::default()
        };
        let totals = Totals {
            programs: (0..programs).map(pace).collect(),
            ..Totals::default()
        };
        let idle = || Worker {
            program: AtomicUsize::new(IDLE),
            phase: AtomicU32::new(0),
            tick: AtomicU64::new(0),
        };
        Progress {
            total: jobs.end - jobs.start,
            limit: None,
            measures_cpu: manifest.varies_settings(),
            workers: std::iter::repeat_with(idle).take(threads.get()).collect(),
            totals: Mutex::new(totals),
        }
    }

    /// Starts no run after a time from now.
    #[must_use]
    pub fn within(self, limit: Option<Duration>) -> Progress {
        Progress {
            limit: limit.map(|limit| (now(), limit)),
            ..self
        }
    }

    /// Returns the share of the time limit that has passed. 0 without one.
    pub fn share_of_time(&self) -> f64 {
        self.limit.map_or(0.0, |(start, limit)| {
            start.elapsed().as_secs_f64() / limit.as_secs_f64().max(f64::MIN_POSITIVE)
        })
    }

    /// Returns whether no further run is started.
    pub(crate) fn is_over(&self) -> bool {
        self.share_of_time() >= 1.0
    }

    /// How many threads there are.
    pub(crate) fn threads(&self) -> usize {
        self.workers.len()
    }

    /// Counts runs of an earlier process.
    ///
    /// # Errors
    /// Where they cannot be read again.
    pub(crate) fn keep(&self, kept: &Records) -> Result<(), JournalError> {
        let mut totals = self.totals.lock().expect("nobody panics while counting");
        kept.each(|done| totals.count(done))
    }

    /// Puts a thread on a run, which stops when either of `stops` is set.
    pub(crate) fn begin<'a>(
        &'a self,
        worker: usize,
        job: PendingRun,
        stops: [&'a AtomicBool; 2],
        checkpoints: Option<&'a Checkpoints>,
    ) -> RunWatch<'a> {
        let PendingRun { program, run } = job;
        let slot = &self.workers[worker];
        slot.tick.store(0, Ordering::Relaxed);
        slot.phase.store(0, Ordering::Relaxed);
        slot.program.store(program, Ordering::Relaxed);
        RunWatch {
            worker: slot,
            stops,
            checkpoints: checkpoints.map(|all| all.of_run(program, run)),
            is_continued: Cell::new(false),
        }
    }

    /// Takes a thread off its run; `finished`: unless the run was stopped.
    pub(crate) fn end(&self, worker: usize, finished: Option<&Finished>) {
        let slot = &self.workers[worker];
        slot.program.store(IDLE, Ordering::Relaxed);
        if let Some(finished) = finished {
            let mut totals = self.totals.lock().expect("nobody panics while counting");
            totals.count(finished);
            totals.ticks_here = (totals.ticks_here).saturating_add(finished.record.ticks);
        }
    }

    /// What can be told now.
    pub fn snapshot(&self) -> Snapshot {
        let mut totals = self
            .totals
            .lock()
            .expect("nobody panics while counting")
            .clone();
        let mut ticks_here = totals.ticks_here;
        let mut under_way = Vec::new();
        for slot in &self.workers {
            let program = slot.program.load(Ordering::Relaxed);
            if let Some(pace) = totals.programs.get_mut(program) {
                let tick = slot.tick.load(Ordering::Relaxed);
                pace.under_way = pace.under_way.saturating_add(tick);
                ticks_here = u64::saturating_add(ticks_here, tick);
                under_way.push((program, PhaseId(slot.phase.load(Ordering::Relaxed))));
            }
        }
        under_way.sort_unstable();
        Snapshot {
            total: self.total,
            done: totals.programs.iter().map(|pace| pace.done).sum(),
            totals,
            ticks_here,
            under_way,
        }
    }
}

impl Totals {
    fn count(&mut self, finished: &Finished) {
        let pace = &mut self.programs[finished.program];
        pace.done += 1;
        pace.ticks = pace.ticks.saturating_add(finished.record.ticks);
        pace.left = pace.left.saturating_sub(1);
        match finished.record.outcome {
            Outcome::Completed => {}
            Outcome::TimedOut { .. } => self.stopped += 1,
            Outcome::Failed { .. } => self.failed += 1,
        }
    }
}
