//! Doing what a plan says, on several threads.
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex};
use std::time::Duration;

use stochc_runtime::world::SceneError;
use stochc_runtime::{RunError, Settings, run as run_once};

use super::clock::thread_time;
use super::ladder::base;
use super::plan::{Extent, Job, Next, Plan};
use super::progress::{Far, during};
use super::report::{Means, Trade};
use super::sample::{End, Measured};
use crate::ensemble::{Display, Program, now};

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
    /// What to show meanwhile.
    pub display: Display,
    /// Set by somebody else to stop at the next tick.
    pub stop: &'a AtomicBool,
}

/// Measures programs.
///
/// # Errors
/// When a scene cannot be set up at all.
pub fn measure(programs: &[Program], setup: &Setup) -> Result<Trade, (usize, SceneError)> {
    for (i, program) in programs.iter().enumerate() {
        try_out(program, &base()).map_err(|error| (i, error))?;
    }
    let cannot = |settings: &Settings| {
        let refused = |program: &Program| try_out(program, settings).err();
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
    let plan = carry_out(plan, programs, setup);
    let (runs, budget) = match setup.extent {
        Extent::Runs(runs) => (Some(runs), None),
        Extent::Budget(budget) => (None, Some(budget.as_secs_f64())),
    };
    let means = Means {
        seed: setup.seed,
        threads: setup.threads,
        runs,
        budget,
        complete: !setup.stop.load(Ordering::Relaxed),
    };
    Ok(Trade::of(programs, &plan.outcomes(), &plan.limits(), means))
}

/// Sets a scene up, and no more.
fn try_out(program: &Program, settings: &Settings) -> Result<(), SceneError> {
    let mut stop = |_, _| ControlFlow::Break(());
    match run_once(program.tables(), &program.scene, settings, 0, 0, &mut stop) {
        Err(RunError::Scene(error)) => Err(error),
        _ => Ok(()),
    }
}

fn carry_out(plan: Plan, programs: &[Program], setup: &Setup) -> Plan {
    let start = now();
    let plan = Mutex::new(plan);
    let ended = Condvar::new();
    let lock = || plan.lock().expect("nobody panics while it is held");
    let next = || {
        let mut plan = lock();
        loop {
            if setup.stop.load(Ordering::Relaxed) {
                return None;
            }
            match plan.next(start.elapsed()) {
                Next::Do(job) => {
                    let mut settings = plan.settings(job.rung).clone();
                    settings.max_ticks = Some(job.max_ticks);
                    return Some((job, settings));
                }
                Next::End => return None,
                // With a limit, so that an interrupt is seen.
                Next::Wait => {
                    let waited = ended.wait_timeout(plan, Duration::from_millis(100));
                    plan = waited.expect("nobody panics while it is held").0;
                }
            }
        }
    };
    let work = || {
        while let Some((job, settings)) = next() {
            let measured = one(&job, &settings, &programs[job.program], setup);
            if let Some(measured) = measured {
                lock().done(&job, measured);
            }
            ended.notify_all();
        }
    };
    let far = || {
        let (runs, total) = lock().progress();
        let share = match (setup.extent, total) {
            (Extent::Budget(budget), _) => start.elapsed().as_secs_f64() / budget.as_secs_f64(),
            (_, Some(total)) => runs as f64 / total.max(1) as f64,
            _ => 0.0,
        };
        Far {
            runs,
            share: share.min(1.0),
        }
    };
    during(setup.display, far, || {
        std::thread::scope(|scope| {
            for _ in 0..setup.threads.max(1) {
                scope.spawn(work);
            }
        });
    });
    plan.into_inner().expect("every worker has ended well")
}

/// One run; `None`: it was interrupted.
fn one(job: &Job, settings: &Settings, program: &Program, setup: &Setup) -> Option<Measured> {
    let (wall, cpu) = (now(), thread_time());
    let mut last = 0;
    let mut watch = |tick, _| {
        last = tick;
        match setup.stop.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    };
    let (tables, scene) = (program.tables(), &program.scene);
    // What the run was working on is dropped with it, so that nobody sees it half done.
    let result = catch_unwind(AssertUnwindSafe(|| {
        run_once(tables, scene, settings, setup.seed, job.run, &mut watch)
    }));
    let (cpu, wall) = (thread_time().saturating_sub(cpu), wall.elapsed());
    let (cpu, wall) = (cpu.as_secs_f64(), wall.as_secs_f64());
    match result {
        Ok(Ok(record)) => Some(Measured::new(&record, cpu, wall)),
        // The scene has been tried out, so only an interrupted run leaves no record.
        Ok(Err(_)) => None,
        Err(_) => Some(Measured {
            run: job.run,
            end: End::Failed,
            ticks: last,
            cpu,
            wall,
        }),
    }
}
