//! Progress of running simulations: written once per tick by the threads, read by displays.
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

/// Program index that marks a worker without a run.
const IDLE: usize = usize::MAX;

/// Progress of an ensemble, shared by its threads and displays.
pub struct Progress {
    total: u64,
    /// Start of the first run, and the time limit for starting runs. `None` without a limit.
    limit: Option<(Instant, Duration)>,
    pub(crate) measures_cpu: bool,
    workers: Vec<Worker>,
    totals: Mutex<Totals>,
}

struct Worker {
    program: AtomicUsize,
    phase: AtomicU32,
    tick: AtomicU64,
}

/// Totals of finished runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Totals {
    /// Progress of each program.
    pub programs: Vec<ProgramProgress>,
    /// Number of runs that timed out or reached the tick limit.
    pub stopped: u64,
    /// Number of failed runs.
    pub failed: u64,
    /// Number of ticks that this process simulated, in finished runs.
    pub ticks_here: u64,
}

/// Progress of the runs of one program.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProgramProgress {
    /// Number of finished runs, of this process or an earlier one.
    pub done: u64,
    /// Total ticks of the finished runs.
    pub ticks: u64,
    /// Number of unfinished runs.
    pub left: u64,
    /// Ticks simulated so far in running simulations.
    pub running: u64,
}

/// Progress at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Number of requested runs of all programs.
    pub total: u64,
    /// Number of finished runs.
    pub done: u64,
    /// Totals of finished runs.
    pub totals: Totals,
    /// Number of ticks that this process has simulated.
    pub ticks_here: u64,
    /// Program and phase of each running simulation.
    pub running: Vec<(usize, PhaseId)>,
}

/// Supervisor of a run, called once per tick.
pub struct RunWatch<'a> {
    worker: &'a Worker,
    /// Flags that stop the run: one set by the user, one set by a storage error.
    stops: [&'a AtomicBool; 2],
    /// Checkpoints of the run. `None` if they are disabled.
    checkpoints: Option<RunCheckpoints<'a>>,
    /// Whether the run was resumed from a checkpoint.
    is_continued: Cell<bool>,
}

impl RunWatch<'_> {
    /// Reports the progress of the run. `Break` cancels it.
    pub fn tick(&self, tick: u64, phase: PhaseId) -> ControlFlow<()> {
        // These values are independent, so no ordering is needed.
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

    /// Returns whether the run must be restarted because its checkpoint could not be used.
    pub(crate) fn begins_anew(&self, made: Option<&RunRecord>) -> bool {
        let is_wrong = match made {
            Some(record) => is_panic(record),
            None => !self.stops.iter().any(|stop| stop.load(Ordering::Relaxed)),
        };
        let checkpoints = self.checkpoints.as_ref().filter(|_| is_wrong);
        checkpoints.is_some_and(RunCheckpoints::begins_anew)
    }

    pub(crate) fn is_continued(&self) -> bool {
        self.is_continued.get()
    }

    /// Returns the last reported tick and phase.
    pub(crate) fn last(&self) -> (u64, PhaseId) {
        let phase = PhaseId(self.worker.phase.load(Ordering::Relaxed));
        (self.worker.tick.load(Ordering::Relaxed), phase)
    }
}

impl stochc_runtime::Watch for &RunWatch<'_> {
    fn tick(&mut self, tick: u64, phase: PhaseId) -> ControlFlow<()> {
        RunWatch::tick(self, tick, phase)
    }

    fn saved(&mut self) -> Option<Box<dyn Read>> {
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
    /// Returns the initial progress for a number of threads.
    pub fn new(manifest: &Manifest, threads: NonZeroUsize) -> Progress {
        Progress::from_jobs(manifest, &(0..manifest.total()), threads)
    }

    /// Creates the initial progress for a range of [jobs](crate::execution::job).
    pub(crate) fn from_jobs(
        manifest: &Manifest,
        jobs: &Range<u64>,
        threads: NonZeroUsize,
    ) -> Progress {
        let programs = manifest.programs.len() as u64;
        // Number of jobs before `job` that are runs of a program.
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

    /// Sets a time limit for starting runs. The time starts now.
    #[must_use]
    pub fn within(self, limit: Option<Duration>) -> Progress {
        Progress {
            limit: limit.map(|limit| (now(), limit)),
            ..self
        }
    }

    /// Measures the CPU time of each run, in addition to ensembles that always measure it.
    #[must_use]
    pub fn measuring_cpu(self, is_measured: bool) -> Progress {
        Progress {
            measures_cpu: self.measures_cpu || is_measured,
            ..self
        }
    }

    /// Returns the fraction of the time limit that has passed. Returns 0 without a limit.
    pub fn share_of_time(&self) -> f64 {
        self.limit.map_or(0.0, |(start, limit)| {
            start.elapsed().as_secs_f64() / limit.as_secs_f64().max(f64::MIN_POSITIVE)
        })
    }

    /// Returns whether the time limit has passed, so that no further run is started.
    pub(crate) fn is_over(&self) -> bool {
        self.share_of_time() >= 1.0
    }

    pub(crate) fn threads(&self) -> usize {
        self.workers.len()
    }

    /// Counts `existing`, the runs of earlier processes, as finished.
    ///
    /// # Errors
    ///
    /// If the runs cannot be read.
    pub(crate) fn count_existing(&self, existing: &Records) -> Result<(), JournalError> {
        let mut totals = self.totals.lock().expect("no panic while it is locked");
        existing.each(|done| totals.count(done))
    }

    /// Assigns a run to a thread. The run stops when either of `stops` is set.
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
            checkpoints: checkpoints.map(|all| all.for_run(program, run)),
            is_continued: Cell::new(false),
        }
    }

    /// Ends the run of a thread. `finished` is `None` if it was cancelled.
    pub(crate) fn end(&self, worker: usize, finished: Option<&Finished>) {
        let slot = &self.workers[worker];
        slot.program.store(IDLE, Ordering::Relaxed);
        if let Some(finished) = finished {
            let mut totals = self.totals.lock().expect("no panic while it is locked");
            totals.count(finished);
            totals.ticks_here = (totals.ticks_here).saturating_add(finished.record.ticks);
        }
    }

    /// Returns the current progress.
    pub fn snapshot(&self) -> Snapshot {
        let mut totals = self
            .totals
            .lock()
            .expect("no panic while it is locked")
            .clone();
        let mut ticks_here = totals.ticks_here;
        let mut running = Vec::new();
        for slot in &self.workers {
            let program = slot.program.load(Ordering::Relaxed);
            if let Some(pace) = totals.programs.get_mut(program) {
                let tick = slot.tick.load(Ordering::Relaxed);
                pace.running = pace.running.saturating_add(tick);
                ticks_here = u64::saturating_add(ticks_here, tick);
                running.push((program, PhaseId(slot.phase.load(Ordering::Relaxed))));
            }
        }
        running.sort_unstable();
        Snapshot {
            total: self.total,
            done: totals.programs.iter().map(|pace| pace.done).sum(),
            totals,
            ticks_here,
            running,
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
