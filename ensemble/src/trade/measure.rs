//! Doing what a plan says, on several threads.
use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Condvar, Mutex};
use std::time::Duration;

use stochc_ir::table::PhaseId;
use stochc_runtime::Settings;
use stochc_runtime::world::SceneError;

use super::assessment::Conditions;
use super::candidates::base;
use super::estimate::EstimatedSamples;
use super::measurement_journal::MeasurementJournal;
use super::plan::{Extent, Job, NextJob, Plan};
use super::result::Trade;
use super::sample::Measured;
use crate::clock::now;
use crate::executor::{RunCancelled, attempt, execute};
use crate::manifest::EnsembleProgram;
use crate::program_run::unless;
use crate::thread_time::thread_time;

/// How far a measurement is, for whoever shows it.
#[derive(Debug, Default)]
pub struct MeasurementProgress {
    runs: AtomicU64,
    /// 0: not known.
    total: AtomicU64,
}

impl MeasurementProgress {
    /// Runs that have ended.
    pub fn runs(&self) -> u64 {
        self.runs.load(Ordering::Relaxed)
    }

    /// Runs in all; `None`: as many as there is time for.
    pub fn total(&self) -> Option<u64> {
        Some(self.total.load(Ordering::Relaxed)).filter(|&total| total > 0)
    }

    fn put(&self, (runs, total): (u64, Option<u64>)) {
        self.runs.store(runs, Ordering::Relaxed);
        self.total.store(total.unwrap_or(0), Ordering::Relaxed);
    }
}

/// How to measure.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// How much.
    pub extent: Extent,
    /// The seed of every draw.
    pub seed: u64,
    /// Runs at the same time.
    pub threads: usize,
    /// No refinement beyond so many substeps.
    pub finest: u32,
    /// Ticks after which a run is given up; `None`: 20 times the mean of the first runs.
    pub max_ticks: Option<u64>,
    /// What was measured before, and where what is measured now is kept; `None`: nowhere.
    pub memory: Option<&'a MeasurementJournal>,
    /// Set by somebody else to stop at the next tick.
    pub stop: &'a AtomicBool,
}

/// Measures programs, and holds what is `estimated` of them against that.
///
/// # Errors
/// When a scene cannot be set up at all.
pub fn measure(
    programs: &[EnsembleProgram],
    setup: &Setup,
    estimated: &EstimatedSamples,
    progress: &MeasurementProgress,
) -> Result<Trade, (usize, SceneError)> {
    for (i, program) in programs.iter().enumerate() {
        (program.try_out(&base())).map_err(|error| (i, error))?;
    }
    let cannot = |settings: &Settings| {
        let refused = |program: &EnsembleProgram| program.try_out(settings).err();
        programs
            .iter()
            .find_map(refused)
            .map(|error| error.to_string())
    };
    let plan = Plan::new(
        setup.extent,
        programs.len(),
        setup.threads,
        setup.finest,
        setup.max_ticks,
        cannot,
    );
    let plan = carry_out(plan, programs, setup, progress);
    let (runs, budget) = match setup.extent {
        Extent::Runs(runs) => (Some(runs), None),
        Extent::Budget(budget) => (None, Some(budget.as_secs_f64())),
    };
    let conditions = Conditions {
        seed: setup.seed,
        threads: setup.threads,
        runs,
        budget,
        complete: !setup.stop.load(Ordering::Relaxed),
    };
    Ok(Trade::of(
        programs,
        &plan.outcomes(),
        estimated,
        &plan.limits(),
        conditions,
    ))
}

fn carry_out(
    mut plan: Plan,
    programs: &[EnsembleProgram],
    setup: &Setup,
    progress: &MeasurementProgress,
) -> Plan {
    let start = now();
    let before = setup
        .memory
        .map_or(Duration::ZERO, MeasurementJournal::elapsed);
    let elapsed = || before + start.elapsed();
    if let Some(memory) = setup.memory {
        plan.recall(|job, settings| memory.recall(job, settings));
        progress.put(plan.progress());
    }
    let plan = Mutex::new(plan);
    let ended = Condvar::new();
    let lock = || plan.lock().expect("nobody panics while it is held");
    let next = || {
        let mut plan = lock();
        loop {
            if setup.stop.load(Ordering::Relaxed) {
                return None;
            }
            match plan.next(elapsed()) {
                NextJob::Do(job) => {
                    let settings = plan.settings(job.candidate, job.program);
                    return Some((job, settings));
                }
                NextJob::End => return None,
                // With a limit, so that an interrupt is seen.
                NextJob::Wait => {
                    let waited = ended.wait_timeout(plan, Duration::from_millis(100));
                    plan = waited.expect("nobody panics while it is held").0;
                }
            }
        }
    };
    execute(
        setup.threads.max(1),
        setup.stop,
        next,
        |_, (job, settings)| {
            let known = setup.memory.and_then(|it| it.recall(&job, &settings));
            let measured = known.or_else(|| one(&job, &settings, &programs[job.program], setup));
            let mut is_kept = true;
            if let Some(measured) = measured {
                if let (Some(memory), None) = (setup.memory, known) {
                    is_kept = memory.keep(&job, &settings, measured, elapsed());
                }
                let mut plan = lock();
                plan.done(&job, measured);
                progress.put(plan.progress());
            }
            ended.notify_all();
            match is_kept {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        },
    );
    plan.into_inner().expect("every thread has ended well")
}

/// One run; `None`: it was interrupted.
fn one(
    job: &Job,
    settings: &Settings,
    program: &EnsembleProgram,
    setup: &Setup,
) -> Option<Measured> {
    let (wall, cpu) = (now(), thread_time());
    let last = Cell::new((0, PhaseId(0)));
    let mut watch = |tick, phase| {
        last.set((tick, phase));
        unless(setup.stop)
    };
    let simulate = || {
        let record = program.run(settings, (setup.seed, job.run), &mut watch);
        // The scene has been tried out, so only an interrupted run leaves no record.
        record.map_err(|_| RunCancelled)
    };
    let record = attempt(job.run, simulate, || last.get())?;
    let (cpu, wall) = (thread_time().saturating_sub(cpu), wall.elapsed());
    Some(Measured::new(
        &record,
        cpu.as_secs_f64(),
        wall.as_secs_f64(),
    ))
}
