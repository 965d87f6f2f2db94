//! One run, from the first tick to its record.
use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_ir::scene::{Messages, Scene};
use stochc_ir::table::Tables;

use crate::aggregate::gather;
use crate::control::Controller;
use crate::observe::{EventObservation, Observer, StepObserver};
use crate::run_error::RunError;
use crate::settings::{Model, Settings};
use crate::watch::{Watch, resume, tell};
use crate::world::rapier::RapierWorld;
use crate::world::rate::RateWorld;
use crate::world::rigid::RigidWorld;
use crate::world::shuffle::ShuffleWorld;
use crate::world::{Arena, World};

/// Chance of an unplanned bond per tick in a world without physics, where faces always attract.
const STRAYS: f64 = 0.25;

/// Makes run number `run` of the ensemble with this `seed`.
///
/// The record is a pure function of all arguments but `watch`.
///
/// # Errors
/// [`RunError::Scene`] and [`RunError::State`] before the first tick, [`RunError::Cancelled`] when `watch` says so. A
/// physics that breaks down on the way is no error but an [`Outcome::Failed`].
pub fn run(
    tables: &Tables,
    scene: &Scene,
    settings: &Settings,
    seed: u64,
    run: u64,
    watch: &mut dyn Watch,
) -> Result<RunRecord, RunError> {
    let messages = scene.messages.as_ref();
    let limit = settings.max_ticks;
    match settings.model {
        Model::Rapier => {
            let mut world = RapierWorld::new(scene, &tables.plate, settings, seed, run)?;
            drive(tables, messages, &mut world, limit, (seed, run), watch)
        }
        Model::Rigid => {
            let mut world = RigidWorld::new(scene, &tables.plate, settings, seed, run)?;
            drive(tables, messages, &mut world, limit, (seed, run), watch)
        }
        Model::Rate => {
            let mut world = RateWorld::new(tables, scene, &settings.rates, seed, run)?;
            drive(tables, messages, &mut world, limit, (seed, run), watch)
        }
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
            drive(tables, messages, &mut world, limit, (seed, run), watch)
        }
    }
}

/// [`run()`], with an `observer` to look on.
///
/// The record is the same, bit for bit.
///
/// # Errors
/// Those of [`run()`], and [`RunError::Nowhere`].
pub fn observe(
    tables: &Tables,
    scene: &Scene,
    settings: &Settings,
    seed: u64,
    run: u64,
    watch: &mut (impl Watch + ?Sized),
    observer: &mut impl Observer,
) -> Result<RunRecord, RunError> {
    let key = (seed, run);
    match settings.model {
        Model::Rapier => {
            let world = RapierWorld::new(scene, &tables.plate, settings, seed, run)?;
            observed(tables, scene, world, settings, key, watch, observer)
        }
        Model::Rigid => {
            let world = RigidWorld::new(scene, &tables.plate, settings, seed, run)?;
            observed(tables, scene, world, settings, key, watch, observer)
        }
        Model::Rate | Model::Shuffle => Err(RunError::Nowhere(settings.model)),
    }
}

fn observed(
    tables: &Tables,
    scene: &Scene,
    mut world: impl Arena,
    settings: &Settings,
    (seed, run): (u64, u64),
    watch: &mut (impl Watch + ?Sized),
    observer: &mut impl Observer,
) -> Result<RunRecord, RunError> {
    let observation = EventObservation::new(observer);
    let limit = settings.max_ticks;
    if tables.aggregate.is_some() {
        return gather(tables, &mut world, limit, run, watch, observation);
    }
    let mut controller = Controller::new(tables, scene.messages.as_ref(), seed, run);
    controller.keep_log();
    follow(controller, &mut world, limit, run, watch, observation)
}

/// Runs tables in a world of one's own, which has to be at its beginning.
///
/// A world that passes everything on to another one can look into it at every tick: that is how
/// to record what moves where.
///
/// `max_ticks` as in [`Settings::max_ticks`]. `(seed, run)` is the key of the
/// chance by which messages are lost; `run` is also the number to put in the record.
///
/// # Errors
/// [`RunError::Cancelled`] when `watch` says so.
pub fn drive(
    tables: &Tables,
    messages: Option<&Messages>,
    world: &mut impl World,
    max_ticks: Option<u64>,
    (seed, run): (u64, u64),
    watch: &mut (impl Watch + ?Sized),
) -> Result<RunRecord, RunError> {
    if tables.aggregate.is_some() {
        return gather(tables, world, max_ticks, run, watch, ());
    }
    let controller = Controller::new(tables, messages, seed, run);
    follow(controller, world, max_ticks, run, watch, ())
}

/// Drives a world by a controller to the end of the run; `step_observer` is shown every tick.
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
            let reason = reason.to_owned();
            break Outcome::Failed { phase, reason };
        }
        let tick = world.tick();
        if let Some(by) = Limit::reached(controller.timed_out(), tick, max_ticks) {
            break Outcome::TimedOut { phase, by };
        }
        tell(watch, (tick, phase), &[&controller, world, &step_observer])?;
        // The next step makes one of these ticks.
        if let Some(last) = controller.next_due(max_ticks).checked_sub(1) {
            world.skip(last);
        }
        dockings.clear();
        if let Err(fault) = world.step(&mut dockings) {
            let reason = fault.to_string();
            break Outcome::Failed { phase, reason };
        }
        controller.advance(&dockings, world);
        step_observer.observe(world, controller.take_log());
    };
    Ok(controller.into_record(run, outcome, world))
}
