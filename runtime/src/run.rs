//! Simulates one run, from the first tick to its record.
use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_ir::scene::{Messages, Scene};
use stochc_ir::table::Tables;

use crate::aggregate::gather;
use crate::control::Controller;
use crate::observe::{EventObservation, Observer, StepObserver};
use crate::run_error::RunError;
use crate::settings::{Model, Settings};
use crate::watch::{Watch, report_tick, resume};
#[cfg(feature = "rapier")]
use crate::world::rapier::RapierWorld;
use crate::world::rate::RateWorld;
use crate::world::rigid::RigidWorld;
use crate::world::shuffle::ShuffleWorld;
use crate::world::{SpatialWorld, World};

/// Probability per tick of an unplanned capture in model `shuffle`, for faces that always attract.
const STRAYS: f64 = 0.25;

/// Computes run number `run` of the ensemble with this `seed`.
///
/// The record is a pure function of all arguments except `watch`.
///
/// # Errors
///
/// [`RunError::Scene`] and [`RunError::State`] before the first tick; [`RunError::Cancelled`] if
/// `watch` cancels the run. Numerical failure during the run is an [`Outcome::Failed`], not an
/// error.
pub fn run(
    tables: &Tables,
    scene: &Scene,
    settings: &Settings,
    seed: u64,
    run: u64,
    watch: &mut dyn Watch,
) -> Result<RunRecord, RunError> {
    let key = RunKey { seed, run };
    match settings.model {
        #[cfg(not(feature = "rapier"))]
        Model::Rapier => Err(RunError::Absent(Model::Rapier)),
        #[cfg(feature = "rapier")]
        Model::Rapier => {
            let mut world = RapierWorld::for_tables(tables, scene, settings, seed, run)?;
            executed(tables, scene, &mut world, settings, key, watch)
        }
        Model::Rigid => {
            let mut world = RigidWorld::for_tables(tables, scene, settings, seed, run)?;
            executed(tables, scene, &mut world, settings, key, watch)
        }
        Model::Rate => {
            let mut world = RateWorld::new(tables, scene, &settings.rates, seed, run)?;
            executed(tables, scene, &mut world, settings, key, watch)
        }
        Model::Measured => Err(RunError::Measured),
        Model::Shuffle => {
            let strays = if tables.bond.is_passive() {
                STRAYS
            } else {
                0.0
            };
            let mut world =
                ShuffleWorld::new(tables, scene.free.count, seed, run).with_strays(strays);
            if tables.aggregate.is_some() {
                world = world.with_groups();
            }
            executed(tables, scene, &mut world, settings, key, watch)
        }
    }
}

/// Runs like [`run()`] and calls an `observer` at every tick.
///
/// The record equals the record of [`run()`], bit for bit.
///
/// # Errors
///
/// The errors of [`run()`], and [`RunError::Nowhere`].
pub fn observe(
    tables: &Tables,
    scene: &Scene,
    settings: &Settings,
    seed: u64,
    run: u64,
    watch: &mut (impl Watch + ?Sized),
    observer: &mut impl Observer,
) -> Result<RunRecord, RunError> {
    let key = RunKey { seed, run };
    match settings.model {
        #[cfg(not(feature = "rapier"))]
        Model::Rapier => Err(RunError::Absent(Model::Rapier)),
        #[cfg(feature = "rapier")]
        Model::Rapier => {
            let world = RapierWorld::for_tables(tables, scene, settings, seed, run)?;
            observed(tables, scene, world, settings, key, watch, observer)
        }
        Model::Rigid => {
            let world = RigidWorld::for_tables(tables, scene, settings, seed, run)?;
            observed(tables, scene, world, settings, key, watch, observer)
        }
        Model::Rate | Model::Shuffle => Err(RunError::Nowhere(settings.model)),
        Model::Measured => Err(RunError::Measured),
    }
}

#[derive(Clone, Copy)]
struct RunKey {
    seed: u64,
    run: u64,
}

/// Runs tables in a world that is in its initial state.
fn executed(
    tables: &Tables,
    scene: &Scene,
    world: &mut impl World,
    settings: &Settings,
    RunKey { seed, run }: RunKey,
    watch: &mut (impl Watch + ?Sized),
) -> Result<RunRecord, RunError> {
    let limit = settings.max_ticks;
    if tables.aggregate.is_some() {
        return gather(tables, world, limit, run, watch, ());
    }
    let controller = Controller::in_scene(tables, scene, seed, run);
    follow(controller, world, limit, run, watch, ())
}

fn observed(
    tables: &Tables,
    scene: &Scene,
    mut world: impl SpatialWorld,
    settings: &Settings,
    RunKey { seed, run }: RunKey,
    watch: &mut (impl Watch + ?Sized),
    observer: &mut impl Observer,
) -> Result<RunRecord, RunError> {
    let observation = EventObservation::new(observer);
    let limit = settings.max_ticks;
    if tables.aggregate.is_some() {
        return gather(tables, &mut world, limit, run, watch, observation);
    }
    let mut controller = Controller::in_scene(tables, scene, seed, run);
    controller.keep_log();
    follow(controller, &mut world, limit, run, watch, observation)
}

/// Runs tables in a custom world, which must be in its initial state.
///
/// A world can wrap another one and inspect it at every tick, for example to record trajectories.
///
/// The hardware has no faults. `max_ticks` is as in [`Settings::max_ticks`]. `seed` and `run` are
/// the key of the random draws for message loss. `run` is also the run number in the record.
///
/// # Errors
///
/// [`RunError::Cancelled`] if `watch` cancels the run.
pub fn drive(
    tables: &Tables,
    messages: Option<&Messages>,
    world: &mut impl World,
    max_ticks: Option<u64>,
    seed: u64,
    run: u64,
    watch: &mut (impl Watch + ?Sized),
) -> Result<RunRecord, RunError> {
    if tables.aggregate.is_some() {
        return gather(tables, world, max_ticks, run, watch, ());
    }
    let controller = Controller::new(tables, messages, seed, run);
    follow(controller, world, max_ticks, run, watch, ())
}

/// Drives a world by a controller to the end of the run, and calls `step_observer` at every tick.
fn follow<W: World>(
    mut controller: Controller<'_>,
    world: &mut W,
    max_ticks: Option<u64>,
    run: u64,
    watch: &mut (impl Watch + ?Sized),
    mut step_observer: impl StepObserver<W>,
) -> Result<RunRecord, RunError> {
    let mut dockings = Vec::new();
    if !resume(watch, &mut [&mut controller, world, &mut step_observer])? {
        controller.start(world);
        step_observer.observe(world, controller.take_log());
    }
    let outcome = loop {
        let Some(phase) = controller.phase() else {
            break Outcome::Completed;
        };
        if let Some(reason) = controller.fault() {
            // The blocks failed, not the computation.
            break Outcome::Failed {
                phase,
                reason: reason.to_owned(),
                is_broken: true,
            };
        }
        let tick = world.tick();
        if let Some(by) = Limit::reached(controller.timed_out(), tick, max_ticks) {
            break Outcome::TimedOut { phase, by };
        }
        report_tick(watch, tick, phase, &[&controller, world, &step_observer])?;
        // Stop one tick early: the next step then ends at the tick that needs the controller.
        if let Some(last) = controller.next_due(max_ticks).checked_sub(1) {
            world.skip(last);
        }
        dockings.clear();
        if let Err(fault) = world.step(&mut dockings) {
            let reason = fault.to_string();
            break Outcome::Failed {
                phase,
                reason,
                is_broken: false,
            };
        }
        controller.advance(&dockings, world);
        step_observer.observe(world, controller.take_log());
    };
    Ok(controller.into_record(run, outcome, world))
}
