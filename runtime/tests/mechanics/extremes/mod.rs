//! Tests the outcomes of scenes at the extremes, in both worlds of rigid blocks.
//!
//! This command rewrites `outcomes.md`: `STOCHC_WRITE_DOCS=1 cargo test -p stochc-runtime
//! --test mechanics extremes`.
mod digits;
mod tanks;

use std::fmt::Write as _;

use crate::scenes::{PLATE, contact, hemisphere, paper};
use nalgebra::Vector3;
use stochc_ir::scene::dimensionless::BlockUnits;
use stochc_ir::scene::{Agitation, Bond, Contact, ContactLaw, Enclosure, Scene};
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld, World};
use stochc_runtime::{Model, Settings};

const PAGE: &str = "tests/mechanics/extremes/outcomes.md";

const HEAD: &str = "\
# Outcomes of extreme scenes

`STOCHC_WRITE_DOCS=1 cargo test --workspace --test mechanics extremes` writes this file. docs/validation/stability.md summarizes it.

Each row is the scene `hemisphere_2005` with one change. The scene has 60 free blocks at the original density, and one face of the plate is
open. A run has 600 ticks (100,000 blocks: 3 ticks) with one step per tick. The outcomes are:

- *a number*: the run is stable. The number is the root mean square speed in block lengths per tick. Quaternions have the length 1 within
  1e-5, and blocks stay in the enclosure, except for the compression of floor and wall.
- *refused*: stochc rejects the scene before the first tick.
- *failed*: the run stops with an error.
- *same*: `rapier` has the same outcome as `rigid`.

Messages are shortened. \"x 10\" means ten times the value. In the rows \"to match\", all values in block units are unchanged.

";

/// Outcome of a scene.
#[derive(Clone, Debug, PartialEq)]
enum Fate {
    Refused(String),
    Failed {
        tick: u64,
        what: String,
    },
    Stable {
        rms: f64,
    },
    /// The run continued although its state was invalid.
    Invalid(String),
}

impl std::fmt::Display for Fate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Fate::Refused(why) => write!(f, "refused: {}", first_clause(why)),
            Fate::Failed { tick, what } => {
                write!(f, "failed in tick {tick}: {}", first_clause(what))
            }
            Fate::Stable { rms } => write!(f, "{rms:.3}"),
            Fate::Invalid(what) => write!(f, "**unsound**: {what}"),
        }
    }
}

/// Returns the start of a message, up to its first comma or semicolon.
fn first_clause(message: &str) -> &str {
    message.split([';', ',']).next().unwrap_or(message)
}

/// Returns the outcome with the second model, or "same" if it is that of the first model.
fn second_outcome(first: &Fate, second: &Fate) -> String {
    let outcome = second.to_string();
    if outcome == first.to_string() {
        return "same".to_owned();
    }
    outcome
}

/// Returns the paper's scene, smaller at the same density.
fn base() -> Scene {
    let mut scene = paper();
    scene.free.count = 60;
    scene.enclosure = hemisphere(2.9, 25.0);
    scene
}

fn fate<W: SpatialWorld>(
    scene: &Scene,
    plate: &Plate,
    substeps: u32,
    ticks: u64,
    setup: impl Fn(&mut W),
) -> Fate {
    let settings = Settings::new(Model::Rapier, substeps);
    let mut world = match W::new(scene, plate, &settings, 1, 0) {
        Ok(world) => world,
        Err(error) => return Fate::Refused(error.to_string()),
    };
    setup(&mut world);
    let Some(enclosure) = &scene.enclosure else {
        panic!("an enclosure");
    };
    let interior = enclosure.interior(plate, BlockUnits::from_scene(scene));
    let swing = (enclosure.wall() * scene.tick * scene.tick / scene.block.mass).sqrt();
    let mut dockings = Vec::new();
    let (mut fastest, mut sum, mut samples) = (0.0f64, 0.0, 0.0);
    for tick in 0..ticks {
        if let Err(fault) = world.step(&mut dockings) {
            let what = fault.to_string();
            return Fate::Failed { tick, what };
        }
        for id in (0..world.count()).filter(|&id| world.anchored(id).is_none()) {
            let state = world.state(id);
            let speed = state.velocity.norm();
            fastest = fastest.max(speed);
            if tick >= ticks / 2 {
                sum += speed * speed;
                samples += 1.0;
            }
            let lowest = state.position.z;
            let distance = interior.distance(state.position.into());
            let out = distance - 1.0 - fastest * (1.0 + 1.0 / swing);
            let unit = (state.orientation.coords.norm() - 1.0).abs();
            let deepest = match scene.contact.as_ref().map(|contact| &contact.law) {
                None => f64::INFINITY,
                Some(ContactLaw::Rigid { .. }) => 1.0,
                // Greatest depth of the fastest block in a spring of this stiffness.
                Some(ContactLaw::Compliant { stiffness, .. }) => {
                    let frequency = (stiffness / scene.block.mass).sqrt() * scene.tick;
                    1.0 + fastest / frequency
                }
            };
            let unsound = if !(speed + state.position.norm() + state.spin.norm()).is_finite() {
                format!("block {id} is nowhere in tick {tick}")
            } else if lowest < -deepest {
                format!("block {id} is at z = {lowest:.2} in tick {tick}")
            } else if out > 0.0 {
                format!("block {id} is {out:.2} sides too far in tick {tick}")
            } else if unit > 1e-5 {
                format!("the quaternion of block {id} is off by {unit:e} in tick {tick}")
            } else {
                continue;
            };
            return Fate::Invalid(unsound);
        }
    }
    let rms = if samples > 0.0 {
        f64::sqrt(sum / samples)
    } else {
        0.0
    };
    Fate::Stable { rms }
}

/// Returns the scene at another scale, with the same speeds and forces in block units.
fn scaled(length: f64, mass: f64, time: f64) -> Scene {
    let mut scene = base();
    let (speed, force) = (length / time, mass * length / (time * time));
    scene.tick *= time;
    scene.block.side *= length;
    scene.block.mass *= mass;
    scene.enclosure = hemisphere(2.9 * length, 25.0 * force / length);
    if let Some(Agitation::Kicks { speed: (_, high) }) = &mut scene.agitation {
        *high *= speed;
    }
    if let Some(Bond::Attract {
        pull,
        align: Some(align),
        anchor,
        ..
    }) = &mut scene.bond
    {
        pull.force *= force;
        pull.within *= length;
        align.force *= force;
        align.within *= length;
        anchor.within *= length;
    }
    scene
}

fn with(change: impl FnOnce(&mut Scene)) -> Scene {
    let mut scene = base();
    change(&mut scene);
    scene
}

fn tick(factor: f64) -> Scene {
    with(|scene| scene.tick *= factor)
}

fn kicks(factor: f64) -> Scene {
    with(|scene| {
        if let Some(Agitation::Kicks { speed: (_, high) }) = &mut scene.agitation {
            *high *= factor;
        }
    })
}

fn magnets(factor: f64) -> Scene {
    with(|scene| {
        if let Some(Bond::Attract {
            pull,
            align: Some(align),
            ..
        }) = &mut scene.bond
        {
            pull.force *= factor;
            align.force *= factor;
        }
    })
}

fn rough(restitution: f64, friction: f64) -> Scene {
    with(|scene| scene.contact = contact(restitution, friction))
}

fn soft(stiffness: f64, damping: f64) -> Scene {
    with(|scene| {
        scene.contact = Some(Contact {
            law: ContactLaw::Compliant { stiffness, damping },
            friction: 0.2,
        });
    })
}

/// Returns a scene whose `count` blocks fill this share of the hemisphere.
fn packed(count: u32, share: f64) -> Scene {
    with(|scene| {
        scene.free.count = count;
        let volume = f64::from(count) / share;
        let radius = (volume / (2.0 / 3.0 * std::f64::consts::PI)).cbrt();
        scene.enclosure = hemisphere(radius * scene.block.side, 25.0);
    })
}

fn boxed([length, width, height]: [f64; 3], count: u32) -> Scene {
    with(|scene| {
        scene.free.count = count;
        scene.enclosure = Some(Enclosure::Box {
            length,
            width,
            height,
            wall: 25.0,
        });
    })
}

fn cylinder(radius: f64, height: f64) -> Scene {
    with(|scene| {
        scene.enclosure = Some(Enclosure::Cylinder {
            radius,
            height,
            wall: 25.0,
        });
    })
}

/// Returns all extreme scenes with a description and a number of ticks.
fn cases() -> Vec<(&'static str, Scene, u64)> {
    let t = 600;
    vec![
        ("nothing", base(), t),
        ("tick x 0.01", tick(0.01), t),
        ("tick x 0.1", tick(0.1), t),
        ("tick x 10", tick(10.0), t),
        ("tick x 100", tick(100.0), t),
        ("kicks x 1000", kicks(1000.0), t),
        ("mass 1e-15 kg, forces to match", scaled(1.0, 1e-15, 1.0), t),
        ("mass 1e6 kg, forces to match", scaled(1.0, 1e6, 1.0), t),
        (
            "mass 1e-15 kg, the same forces",
            with(|s| s.block.mass = 1e-15),
            t,
        ),
        (
            "mass 1e6 kg, the same forces",
            with(|s| s.block.mass = 1e6),
            t,
        ),
        (
            "side 10 um, everything to match",
            scaled(5e-5, 1e-13, 1e-3),
            t,
        ),
        ("side 10 m, everything to match", scaled(50.0, 1e5, 7.0), t),
        ("1 block", with(|s| s.free.count = 1), t),
        ("2 blocks", with(|s| s.free.count = 2), t),
        ("no block", with(|s| s.free.count = 0), t),
        ("1000 blocks, 0.01 % of the volume", packed(1000, 1e-4), t),
        ("1000 blocks, 10 % of the volume", packed(1000, 0.1), t),
        ("1000 blocks, 40 % of the volume", packed(1000, 0.4), t),
        ("1000 blocks, 80 % of the volume", packed(1000, 0.8), t),
        (
            "100,000 blocks, 1 % of the volume",
            packed(100_000, 0.01),
            3,
        ),
        ("magnets x 1000", magnets(1000.0), t),
        ("magnets x 0", magnets(0.0), t),
        ("restitution 1, friction 0", rough(1.0, 0.0), t),
        ("restitution 1, friction 10", rough(1.0, 10.0), t),
        ("restitution 0, friction 0", rough(0.0, 0.0), t),
        ("restitution 0, friction 10", rough(0.0, 10.0), t),
        ("contact of 1 N/m", soft(1.0, 0.0), t),
        ("contact of 1e9 N/m, undamped", soft(1e9, 0.0), t),
        ("contact of 1e9 N/m, damping 1e9 N s/m", soft(1e9, 1e9), t),
        ("no contact", with(|s| s.contact = None), t),
        (
            "wall of 1e5 N/m",
            with(|s| s.enclosure = hemisphere(2.9, 1e5)),
            t,
        ),
        (
            "wall of 1e36 N/m",
            with(|s| s.enclosure = hemisphere(2.9, 1e36)),
            t,
        ),
        (
            "wall of 0 N/m",
            with(|s| s.enclosure = hemisphere(2.9, 0.0)),
            t,
        ),
        (
            "radius of 60 cm, 10 blocks",
            with(|s| {
                s.enclosure = hemisphere(0.6, 25.0);
                s.free.count = 10;
            }),
            t,
        ),
        ("box of 1 m, 10 blocks", boxed([1.0, 1.0, 1.0], 10), t),
        (
            "box of 60 x 60 x 30 cm, 1 block",
            boxed([0.6, 0.6, 0.3], 1),
            t,
        ),
        ("box of 1 km, 60 blocks", boxed([1e3, 1e3, 1e3], 60), t),
        ("box of 1e30 m, 60 blocks", boxed([1e30, 1e30, 1e30], 60), t),
        (
            "box of 100 m x 1 m x 41 cm, 60 blocks",
            boxed([100.0, 1.0, 0.41], 60),
            t,
        ),
        ("box as wide as a block", boxed([2.0, 0.2, 2.0], 1), t),
        ("cylinder of 2.4 m, 60 blocks", cylinder(2.4, 2.4), t),
        ("disc of 5 m, 41 cm high, 60 blocks", cylinder(5.0, 0.41), t),
        ("cylinder of 1 km, 60 blocks", cylinder(1e3, 1e3), t),
        ("cylinder of 30 cm, 60 blocks", cylinder(0.3, 2.0), t),
        (
            "kicks of 1e-40 m/s",
            with(|s| {
                s.agitation = Some(Agitation::Kicks {
                    speed: (0.0, 1e-40),
                })
            }),
            t,
        ),
    ]
}

fn middle() -> BlockFace {
    let (body, face) = (Body::Seed(Cell::new(1, 1, 0)), Face::Up);
    BlockFace { body, face }
}

#[test]
fn every_extreme_has_the_documented_outcome() {
    let mut page = HEAD.to_owned();
    page.push_str("| changed | `rigid` | `rapier` |\n|---|---|---|\n");
    let mut unsound = Vec::new();
    for (name, scene, ticks) in cases() {
        let rigid = fate::<RigidWorld>(&scene, &PLATE, 1, ticks, |world| world.magnetize(middle()));
        let rapier =
            fate::<RapierWorld>(&scene, &PLATE, 1, ticks, |world| world.magnetize(middle()));
        let rapier = second_outcome(&rigid, &rapier);
        writeln!(page, "| {name} | {rigid} | {rapier} |").unwrap();
        if let Fate::Invalid(what) = &rigid {
            unsound.push(format!("{name}: {what}"));
        }
    }
    unsound.extend(tanks::table(&mut page));
    unsound.extend(digits::tables(&mut page));
    assert_eq!(unsound, Vec::<String>::new());
    crate::pages::assert_page(PAGE, &page);
}

/// Docks blocks on the given faces, one after the other. Each block starts at the given position.
fn build<W: SpatialWorld>(world: &mut W, block_faces: &[(BlockFace, Vector3<f64>)]) {
    let mut dockings = Vec::new();
    for (id, &(block_face, centre)) in block_faces.iter().enumerate() {
        world.magnetize(block_face);
        world.set_state(id as u32, &BodyState::at_rest(centre));
        for _ in 0..50 {
            world.step(&mut dockings).expect("the physics is stable");
        }
        assert_eq!(dockings.len(), id + 1, "block {id} docks");
    }
}

fn quiet(count: u32) -> Scene {
    with(|scene| {
        scene.free.count = count;
        scene.agitation = None;
    })
}

fn a_block_released_under_another<W: SpatialWorld>() {
    let mut world =
        W::new(&quiet(5), &PLATE, &Settings::new(Model::Rapier, 1), 1, 0).expect("it fits");
    let up = |body| BlockFace {
        body,
        face: Face::Up,
    };
    let seed = |x| Body::Seed(Cell::new(x, 1, 0));
    // There are two towers, one and two blocks high. A fourth block hangs on the upper block of the
    // second tower, above the first tower.
    let block_faces = [
        (up(seed(0)), Vector3::new(-1.0, 0.0, 0.51)),
        (up(seed(1)), Vector3::new(0.0, 0.0, 0.51)),
        (up(Body::Free(1)), Vector3::new(0.0, 0.0, 1.51)),
        (
            BlockFace {
                body: Body::Free(2),
                face: Face::West,
            },
            Vector3::new(-1.01, 0.0, 1.5),
        ),
    ];
    build(&mut world, &block_faces);
    // A block far from all others makes the grid look up all blocks again while those are anchored.
    world.set_state(4, &BodyState::at_rest(Vector3::new(3.0, 3.0, 5.0)));
    world.step(&mut Vec::new()).expect("the physics is stable");
    world.switch_off(block_faces[0].0);
    assert_eq!(world.anchored(0), None);
    for _ in 0..200 {
        world.step(&mut Vec::new()).expect("the physics is stable");
    }
    // The released block fits exactly, so nothing pushes it away.
    let state = world.state(0);
    assert!(state.velocity.norm() < 0.01, "{state:?}");
    assert!(
        (state.position - Vector3::new(-1.0, 0.0, 0.5)).norm() < 0.1,
        "{state:?}"
    );
    // It cannot leave through the block above, although the two did not touch while anchored.
    let velocity = Vector3::z() * 0.1;
    world.set_state(0, &BodyState { velocity, ..state });
    for _ in 0..5 {
        world.step(&mut Vec::new()).expect("the physics is stable");
        let height = world.state(0).position.z;
        assert!((0.4..0.65).contains(&height), "{height}");
    }
}

fn two_magnets_fight_for_one_block<W: SpatialWorld>() {
    let mut world =
        W::new(&quiet(3), &PLATE, &Settings::new(Model::Rapier, 1), 1, 0).expect("it fits");
    let up = |x| BlockFace {
        body: Body::Seed(Cell::new(x, 1, 0)),
        face: Face::Up,
    };
    let towers = [
        (up(0), Vector3::new(-1.0, 0.0, 0.51)),
        (up(2), Vector3::new(1.0, 0.0, 0.51)),
    ];
    build(&mut world, &towers);
    // The block is at the same distance from both faces.
    world.set_state(2, &BodyState::at_rest(Vector3::new(0.0, 0.0, 1.2)));
    world.magnetize(BlockFace {
        body: Body::Free(0),
        face: Face::East,
    });
    world.magnetize(BlockFace {
        body: Body::Free(1),
        face: Face::West,
    });
    let mut dockings = Vec::new();
    for _ in 0..2000 {
        world.step(&mut dockings).expect("the physics is stable");
        let state = world.state(2);
        assert!(
            state.velocity.norm() < 1.0 && state.position.norm() < 3.0,
            "{state:?}"
        );
    }
    // At most one of the faces wins.
    assert!(dockings.len() <= 1);
}

in_every_world!(
    a_block_released_under_another,
    two_magnets_fight_for_one_block
);

/// Simulates a hundred elastic blocks without agitation for a hundred million block-steps. Returns
/// the ratio of the final to the initial energy.
fn left_of_the_energy(substeps: u32) -> f64 {
    let (radius, count) = (17.0, 100);
    let scene = with(|scene| {
        scene.free.count = count;
        scene.enclosure = hemisphere(radius * scene.block.side, 25.0);
        scene.agitation = None;
        scene.bond = None;
        scene.contact = contact(1.0, 0.0);
    });
    let wall = 25.0 * scene.tick * scene.tick / scene.block.mass;
    let settings = Settings {
        substeps,
        ..Settings::new(Model::Rapier, 1)
    };
    let mut world = RigidWorld::new(&scene, &PLATE, &settings, 1, 0).expect("it fits");
    let mut dice = crate::scenes::Dice::new(5);
    for id in 0..count {
        let state = world.state(id);
        let velocity = 0.1 * dice.direction();
        world.set_state(id, &BodyState { velocity, ..state });
    }
    let energy = |world: &RigidWorld| -> f64 {
        let of = |state: BodyState| {
            let depth = (state.position.norm() - radius).max(0.0);
            state.velocity.norm_squared() / 2.0
                + state.spin.norm_squared() / 12.0
                + wall * depth * depth / 2.0
        };
        (0..count).map(|id| of(world.state(id))).sum()
    };
    let first = energy(&world);
    for _ in 0..1000 / u64::from(substeps) {
        crate::scenes::pass(&mut world, 1000);
        for id in 0..count {
            let state = world.state(id);
            assert!(state.position.z > -0.5, "{state:?}");
            assert!(state.position.norm() < radius + 10.0, "{state:?}");
            let length = state.orientation.coords.norm();
            assert!((length - 1.0).abs() < 1e-5, "{state:?}");
        }
    }
    energy(&world) / first
}

/// `cargo test --release -p stochc-runtime --test mechanics extremes -- --ignored --nocapture`.
///
/// Collisions conserve the energy to the last digits (`conservation.rs`). The spring of the shell
/// is integrated in steps and adds a little energy if blocks collide within it.
#[test]
#[ignore = "takes a minute without optimization"]
fn no_block_escapes_in_a_hundred_million_block_steps() {
    for (substeps, most) in [(1, 1.5), (4, 1.05)] {
        let left = left_of_the_energy(substeps);
        println!("{substeps} substeps: the energy is {left:.4} of its initial value");
        assert!((0.9..most).contains(&left), "{substeps}: {left}");
    }
}
