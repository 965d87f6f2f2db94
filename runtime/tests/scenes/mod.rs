//! Scenes for tests, one term at a time, in block units: block length 1 m, mass 1 kg, tick 1 s.
#![allow(
    dead_code,
    unused_macros,
    reason = "each test program sets other scenes"
)]
use nalgebra::{UnitQuaternion, Vector3};
use stochc_ir::scene::schema::unspecified;
use stochc_ir::scene::{
    Agitation, Anchor, Arrangement, Block, Bond, Contact, ContactLaw, Enclosure, Fluid, Free,
    Magnets, Measure, Reach, Scene,
};
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};
use stochc_runtime::counter_rng::{Draws, Stream, direction, unit};
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{BlockFace, Body, BodyState, Docking, SpatialWorld, World};
use stochc_runtime::{Model, Precision, Settings};

/// Returns a scene without forces and contacts.
pub fn empty() -> Scene {
    Scene {
        name: "test".to_owned(),
        tick: 1.0,
        block: Block {
            side: 1.0,
            mass: 1.0,
            faces: 1,
        },
        free: Free {
            count: 0,
            arrangement: Arrangement::Uniform,
        },
        ..unspecified()
    }
}

pub fn kicks(rms: f64) -> Option<Agitation> {
    let speed = (0.0, 3f64.sqrt() * rms);
    Some(Agitation::Kicks { speed })
}

pub fn contact(restitution: f64, friction: f64) -> Option<Contact> {
    Some(Contact {
        law: ContactLaw::Rigid { restitution },
        friction,
    })
}

pub fn compliant(stiffness: f64, damping: f64, friction: f64) -> Option<Contact> {
    Some(Contact {
        law: ContactLaw::Compliant { stiffness, damping },
        friction,
    })
}

pub fn hemisphere(radius: f64, wall: f64) -> Option<Enclosure> {
    Some(Enclosure::Hemisphere { radius, wall })
}

pub fn attract(pull: f64, anchor: f64) -> Option<Bond> {
    let reach = |force, within| Reach { force, within };
    Some(Bond::Attract {
        pull: reach(pull, 1.0),
        align: Some(reach(pull / 20.0, 0.5)),
        anchor: Anchor {
            measure: Measure::Centres,
            within: anchor,
            tilt: 26f64.to_radians(),
            sampled: false,
        },
        strength: None,
    })
}

pub const ANCHOR: Anchor = Anchor {
    measure: Measure::Centres,
    within: 0.05,
    tilt: 0.25,
    sampled: false,
};

/// Returns a scene whose faces always attract.
pub fn reject(hold: f64, impulse: f64) -> Scene {
    Scene {
        bond: Some(Bond::Reject {
            magnets: Magnets {
                hold,
                depth: 0.2,
                within: 1.5,
            },
            anchor: ANCHOR,
            impulse,
        }),
        ..empty()
    }
}

/// Returns the viscosity that makes a velocity decay at this rate.
pub fn viscosity(rate: f64) -> f64 {
    rate / Fluid::friction(1.0, 1.0)
}

/// Returns a fluid that makes a velocity decay at this rate.
pub fn viscous(rate: f64) -> Option<Fluid> {
    Some(Fluid {
        density: None,
        viscosity: Some(viscosity(rate)),
        added_mass: None,
    })
}

/// Returns the paper's hemisphere in SI units. Contact and kicks, which the paper leaves open, are
/// chosen here.
pub fn paper() -> Scene {
    Scene {
        tick: 0.02,
        block: Block {
            side: 0.2,
            mass: 1.0,
            faces: 1,
        },
        free: Free {
            count: 300,
            arrangement: Arrangement::Uniform,
        },
        enclosure: hemisphere(5.0, 25.0),
        gravity: None,
        fluid: None,
        flow: None,
        agitation: Some(Agitation::Kicks { speed: (0.0, 0.4) }),
        contact: contact(0.0, 0.2),
        bond: Some(Bond::Attract {
            pull: Reach {
                force: 15.0,
                within: 0.2,
            },
            align: Some(Reach {
                force: 0.75,
                within: 0.1,
            }),
            anchor: Anchor {
                measure: Measure::Centres,
                within: 0.001,
                tilt: 26f64.to_radians(),
                sampled: false,
            },
            strength: None,
        }),
        ..empty()
    }
}

pub const PLATE: Plate = Plate { width: 3, depth: 3 };

pub fn world<W: SpatialWorld>(scene: &Scene, settings: &Settings, blocks: &[BodyState]) -> W {
    W::with_blocks(scene, &PLATE, settings, 1, 0, blocks).expect("a valid scene")
}

/// Generates a test for each world from every function that is generic over worlds.
macro_rules! in_every_world {
    ($($test:ident),* $(,)?) => {
        mod rapier {
            $(#[test] fn $test() { super::$test::<stochc_runtime::world::rapier::RapierWorld>(); })*
        }
        mod rigid {
            $(#[test] fn $test() { super::$test::<stochc_runtime::world::rigid::RigidWorld>(); })*
        }
    };
}

/// A world with its default settings.
pub trait Kind {
    type World: SpatialWorld;
    /// Half the distance from 1 to the next number.
    const ROUNDING: f64;
    const REFERENCE: bool = false;
    fn settings() -> Settings;

    fn with_substeps(substeps: u32) -> Settings {
        Settings {
            substeps,
            ..Self::settings()
        }
    }

    fn world(scene: &Scene, blocks: &[BodyState]) -> Self::World {
        world(scene, &Self::settings(), blocks)
    }
}

/// The engine Rapier.
pub struct Reference;
/// The kernel in single precision.
pub struct Single;
/// The kernel in double precision.
pub struct Double;

const SINGLE: f64 = 1.0 / 16_777_216.0;

impl Kind for Reference {
    type World = RapierWorld;
    const ROUNDING: f64 = SINGLE;
    const REFERENCE: bool = true;
    fn settings() -> Settings {
        Settings::new(Model::Rapier, 1)
    }
}

impl Kind for Single {
    type World = RigidWorld;
    const ROUNDING: f64 = SINGLE;
    fn settings() -> Settings {
        Settings {
            model: Model::Rigid,
            ..Settings::new(Model::Rapier, 1)
        }
    }
}

impl Kind for Double {
    type World = RigidWorld;
    const ROUNDING: f64 = SINGLE * SINGLE / 32.0;
    fn settings() -> Settings {
        Settings {
            precision: Precision::Double,
            ..Single::settings()
        }
    }
}

/// Generates tests of the reference and of the kernel in both precisions, from every function that
/// is generic over [`Kind`].
macro_rules! in_every_kind {
    ($($test:ident),* $(,)?) => {
        mod rapier {
            $(#[test] fn $test() { super::$test::<$crate::scenes::Reference>(); })*
        }
        in_either_precision!($($test),*);
    };
}

/// Generates the same tests without the reference, for terms that it does not compute.
macro_rules! in_either_precision {
    ($($test:ident),* $(,)?) => {
        mod single {
            $(#[test] fn $test() { super::$test::<$crate::scenes::Single>(); })*
        }
        mod double {
            $(#[test] fn $test() { super::$test::<$crate::scenes::Double>(); })*
        }
    };
}

/// Returns a world with four steps per tick.
pub fn in_steps<W: SpatialWorld>(scene: &Scene, blocks: &[BodyState]) -> W {
    world(scene, &Settings::new(Model::Rapier, 4), blocks)
}

/// The upper face of the middle of the plate.
pub const SEED: BlockFace = BlockFace {
    body: Body::Seed(Cell { x: 1, y: 1, z: 0 }),
    face: Face::Up,
};

pub fn moving(position: Vector3<f64>, velocity: Vector3<f64>) -> BodyState {
    BodyState {
        velocity,
        ..BodyState::at_rest(position)
    }
}

pub fn states(world: &impl SpatialWorld) -> Vec<BodyState> {
    (0..world.count()).map(|id| world.state(id)).collect()
}

pub fn at(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

/// Returns the kinetic energy of a block.
pub fn energy(block: &BodyState) -> f64 {
    0.5 * block.velocity.norm_squared() + block.spin.norm_squared() / 12.0
}

/// Makes ticks and checks that nothing docks.
pub fn pass(world: &mut impl World, ticks: u64) {
    let mut dockings = Vec::new();
    for _ in 0..ticks {
        world.step(&mut dockings).expect("the physics is stable");
    }
    assert_eq!(dockings, []);
}

/// Makes ticks and returns the dockings.
pub fn dockings(world: &mut impl World, ticks: u64) -> Vec<Docking> {
    let mut dockings = Vec::new();
    for _ in 0..ticks {
        world.step(&mut dockings).expect("the physics is stable");
    }
    dockings
}

/// Returns `count` blocks in a ball, given by its middle and radius, with random directions and
/// this speed. No two centres are nearer than `apart`.
pub fn gas(
    count: usize,
    seed: u64,
    (middle, radius): (Vector3<f64>, f64),
    apart: f64,
    speed: f64,
) -> Vec<BodyState> {
    let mut dice = Dice::new(seed);
    let mut blocks: Vec<BodyState> = Vec::new();
    while blocks.len() < count {
        let position = middle + radius * dice.unit().cbrt() * dice.direction();
        let is_apart = |b: &BodyState| (b.position - position).norm() > apart;
        if blocks.iter().all(is_apart) {
            blocks.push(BodyState {
                position,
                orientation: dice.rotation(),
                velocity: speed * dice.direction(),
                spin: speed * dice.direction(),
            });
        }
    }
    blocks
}

/// Random numbers in (0, 1) and directions for setting up tests, from a stream that no world uses.
pub struct Dice(Draws, u64);

impl Dice {
    pub fn new(seed: u64) -> Dice {
        Dice(Draws::new(seed, u64::MAX, Stream::Shuffle), 0)
    }

    fn words(&mut self) -> [u32; 4] {
        self.1 += 1;
        self.0.step(self.1).block(0)
    }

    pub fn unit(&mut self) -> f64 {
        unit(self.words()[0])
    }

    pub fn direction(&mut self) -> Vector3<f64> {
        let [height, azimuth, ..] = self.words();
        Vector3::from(direction(height, azimuth)).cast().normalize()
    }

    /// Returns a rotation, uniformly distributed (Shoemake 1992).
    pub fn rotation(&mut self) -> UnitQuaternion<f64> {
        let (u, a, b) = (self.unit(), self.unit(), self.unit());
        let tau = std::f64::consts::TAU;
        let (s, t) = ((1.0 - u).sqrt(), u.sqrt());
        let (a, b) = ((tau * a).sin_cos(), (tau * b).sin_cos());
        UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(
            s * a.0,
            s * a.1,
            t * b.0,
            t * b.1,
        ))
    }
}
