//! What the length of steps does to a scene: collisions and dockings with its own constants, prepared one by one, in the steps that
//! are taken and in much shorter ones.
use nalgebra::Vector3;
use stochc_ir::scene::groups::{BlockUnits, speed};
use stochc_ir::scene::{Block, Bond, ContactLaw, Fluid, Scene, Substeps};
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};

use crate::settings::{Model, Settings};
use crate::world::rigid::RigidWorld;
use crate::world::{Arena, BlockFace, Body, BodyState, World};

/// Short enough to be called exact beside the steps that are taken: so many to each of those.
const FINER: u32 = 64;

/// Experiments of a kind, which begin at different moments of a step.
const CASES: u32 = 32;

/// Steps after which an experiment is given up.
const PATIENCE: u32 = 100_000;

/// What comes out of an experiment, as the mean of 32 that begin at different moments of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepError {
    /// What is measured.
    pub figure: &'static str,
    /// Its unit; empty: it has none.
    pub unit: &'static str,
    /// Steps of a tick that such blocks take.
    pub steps: u32,
    /// What it is with those steps.
    pub taken: f64,
    /// What it is with steps 64 times as short.
    pub resolved: f64,
}

impl StepError {
    /// The error over what it should be.
    pub fn relative(&self) -> f64 {
        self.taken / self.resolved - 1.0
    }
}

/// What is lost by the steps in a scene; nothing is said of what it does not have, or what takes
/// more than 100,000 of the short ones.
pub fn step_errors(scene: &Scene, steps: Substeps) -> Vec<StepError> {
    let kinds = [
        (
            "e, two blocks at the speed v",
            "",
            steps.longest(),
            restitution as Experiment,
        ),
        (
            "docking, pulled from rest within the reach",
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

/// By scene, steps a tick, and a number in (0, 1) that differs between cases.
type Experiment = fn(&Scene, u32, f64) -> Option<f64>;

/// How fast two blocks part that meet face to face, each at the expected speed, over how fast they met.
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
        ..surroundings_of_none(scene)
    };
    let block = |side: f64| BodyState {
        velocity: Vector3::z() * (-side * speed),
        // Between a quarter of a side apart and that and the way of one more step.
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

/// Ticks until a block is anchored that is at rest, straight before a magnetized face, within its reach.
fn docking(scene: &Scene, steps: u32, phase: f64) -> Option<f64> {
    let Some(Bond::Attract { pull, .. }) = &scene.bond else {
        return None;
    };
    let reach = BlockUnits::from_scene(scene).length(pull.within);
    let start = 0.5 + reach * (0.25 + 0.7 * phase);
    // Of which each step is a tick, in which dockings are told.
    let alone = Scene {
        tick: scene.tick / f64::from(steps),
        ..surroundings_of_none(scene)
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

/// Far from the plate \[side\].
const FAR: f64 = 30.0;

/// The same blocks with nothing around them that moves them.
fn surroundings_of_none(scene: &Scene) -> Scene {
    let still = scene.fluid.as_ref().and_then(|fluid| fluid.viscosity);
    Scene {
        enclosure: None,
        agitation: None,
        gravity: None,
        flow: None,
        block: Block {
            mass: scene.inertial_mass(),
            ..scene.block.clone()
        },
        fluid: still.map(|viscosity| Fluid {
            density: None,
            viscosity: Some(viscosity),
            added_mass: None,
        }),
        ..scene.clone()
    }
}

fn world(scene: &Scene, steps: u32, blocks: &[BodyState]) -> Option<RigidWorld> {
    let plate = Plate { width: 1, depth: 1 };
    let settings = Settings::new(Model::Rigid, steps);
    RigidWorld::with_blocks(scene, &plate, &settings, 0, 0, blocks).ok()
}
