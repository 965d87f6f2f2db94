//! Error of the time step in a scene: collisions and captures, each at the chosen step and at much
//! shorter ones.
use nalgebra::Vector3;
use stochc_ir::scene::dimensionless::{BlockUnits, speed};
use stochc_ir::scene::{Bond, ContactLaw, Scene, Substeps};
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};

use crate::settings::{Model, Settings};
use crate::world::rigid::RigidWorld;
use crate::world::{BlockFace, Body, BodyState, SpatialWorld, World};

/// Number of substeps of the reference per chosen step. The reference counts as exact.
const FINER: u32 = 64;

/// Number of experiments of each kind, starting at different moments of a step.
const CASES: u32 = 32;

/// Number of steps after which an experiment is abandoned.
const PATIENCE: u32 = 100_000;

/// Result of an experiment, averaged over 32 starting moments within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepError {
    /// Name of the measured quantity.
    pub figure: &'static str,
    /// Unit of the quantity. Empty if it is dimensionless.
    pub unit: &'static str,
    /// Number of steps per tick of the blocks in this experiment.
    pub steps: u32,
    /// Measured value with the chosen steps.
    pub taken: f64,
    /// Measured value with steps that are 64 times shorter.
    pub resolved: f64,
}

impl StepError {
    /// Returns the relative error.
    pub fn relative(&self) -> f64 {
        self.taken / self.resolved - 1.0
    }
}

/// Returns the errors of the time step in a scene.
///
/// Omits effects that the scene does not have and experiments of more than 100,000 short steps.
pub fn step_errors(scene: &Scene, steps: Substeps) -> Vec<StepError> {
    let kinds = [
        (
            "e, two blocks at the speed v",
            "",
            steps.longest(),
            restitution as Experiment,
        ),
        (
            "docking from rest within the reach",
            "τ",
            steps.near,
            docking,
        ),
    ];
    let errors = kinds
        .into_iter()
        .filter_map(|(figure, unit, steps, experiment)| {
            let mean = |steps: u32| {
                let cases = (0..CASES).map(|case| (f64::from(case) + 0.5) / f64::from(CASES));
                let results: Option<Vec<f64>> =
                    cases.map(|phase| experiment(scene, steps, phase)).collect();
                results.map(|results| results.iter().sum::<f64>() / f64::from(CASES))
            };
            Some(StepError {
                figure,
                unit,
                steps,
                taken: mean(steps)?,
                resolved: mean(steps * FINER)?,
            })
        });
    errors.collect()
}

/// Function that runs an experiment and returns the measured value. The arguments are the scene,
/// the steps per tick, and the starting moment within a step, in (0, 1).
type Experiment = fn(&Scene, u32, f64) -> Option<f64>;

/// Returns the coefficient of restitution of two blocks that meet face to face at the expected
/// speed.
fn restitution(scene: &Scene, steps: u32, phase: f64) -> Option<f64> {
    let contact = scene.contact.as_ref()?;
    let is_free = scene
        .fluid
        .as_ref()
        .and_then(|fluid| fluid.viscosity)
        .is_none();
    let speed = BlockUnits::from_scene(scene).speed(speed(scene).rms?);
    let compliant = matches!(contact.law, ContactLaw::Compliant { .. });
    if !compliant || !is_free || speed.is_nan() || speed <= 0.0 {
        return None;
    }
    let alone = Scene {
        bond: None,
        drag: None,
        ..scene.in_still_medium()
    };
    let block = |side: f64| BodyState {
        velocity: Vector3::z() * (-side * speed),
        // Start a quarter of a block length apart, plus up to one step of motion.
        ..BodyState::at_rest(Vector3::z() * (FAR + side * (0.625 + speed * phase)))
    };
    let mut world = world(&alone, steps, &[block(1.0), block(-1.0)])?;
    let apart = |world: &RigidWorld| {
        let [above, below] = [0, 1].map(|id| world.state(id));
        (
            above.position.z - below.position.z,
            above.velocity.z - below.velocity.z,
        )
    };
    for _ in 0..PATIENCE / steps {
        world.step(&mut Vec::new()).ok()?;
        let (distance, parting) = apart(&world);
        if distance > 1.0 && parting > 0.0 {
            return Some(parting / (2.0 * speed));
        }
    }
    None
}

/// Returns the number of ticks until an open face captures a block. The block starts at rest,
/// directly in front of the face and within its reach.
fn docking(scene: &Scene, steps: u32, phase: f64) -> Option<f64> {
    let Some(Bond::Attract { pull, .. }) = &scene.bond else {
        return None;
    };
    let reach = BlockUnits::from_scene(scene).length(pull.within);
    let start = 0.5 + reach * (0.25 + 0.7 * phase);
    // Each step is a tick, because captures are reported per tick.
    let alone = Scene {
        tick: scene.tick / f64::from(steps),
        ..scene.in_still_medium()
    };
    let mut world = world(&alone, 1, &[BodyState::at_rest(Vector3::z() * start)])?;
    world.magnetize(BlockFace {
        body: Body::Seed(Cell::new(0, 0, 0)),
        face: Face::Up,
    });
    let mut dockings = Vec::new();
    for step in 1..=PATIENCE {
        world.step(&mut dockings).ok()?;
        if !dockings.is_empty() {
            return Some(f64::from(step) / f64::from(steps));
        }
    }
    None
}

/// Distance from the plate, large enough to be out of its reach \[block lengths\].
const FAR: f64 = 30.0;

fn world(scene: &Scene, steps: u32, blocks: &[BodyState]) -> Option<RigidWorld> {
    let plate = Plate { width: 1, depth: 1 };
    let settings = Settings::new(Model::Rigid, steps);
    RigidWorld::with_blocks(scene, &plate, &settings, 0, 0, blocks).ok()
}
