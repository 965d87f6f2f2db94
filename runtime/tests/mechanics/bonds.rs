//! Tests bonds of faces that always attract, and suction, in every world of rigid blocks.

use crate::scenes::{
    ANCHOR, SEED, at, contact, dockings, empty, hemisphere, in_steps as world, moving, reject,
    states, viscosity,
};
use nalgebra::{UnitQuaternion, Vector3};
use stochc_ir::scene::{Agitation, BOLTZMANN, Bond, Flow, Fluid, Jets, Pump, Scene, Stir, Suction};
use stochc_ir::{Cell, Face};
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld};
use stochc_runtime::{Model, Settings};

in_every_world!(
    two_blocks_find_each_other_and_bond,
    a_bonded_pair_moves_as_one_body,
    blocks_that_are_too_fast_do_not_bond,
    a_pair_is_torn_by_a_flow_that_pulls_harder_than_it_holds,
    a_pair_turns_in_a_viscous_vortex_as_its_friction_says_at_every_step,
    heat_tears_no_bond_however_short_the_steps,
    every_face_of_a_planted_block_attracts,
    a_rejected_block_leaves_with_the_impulse_and_may_come_back_later,
    a_block_that_is_rejected_from_a_corner_is_not_taken_by_the_other_side,
    a_docked_block_rejects_what_hangs_on_it,
    an_open_face_draws_a_block_and_holds_it,
    suction_from_few_numbers_runs_as_with_all_numbers,
    a_second_open_face_halves_what_the_first_draws,
    planting_needs_a_free_block,
);

fn suction() -> Scene {
    Scene {
        fluid: Some(Fluid {
            density: None,
            viscosity: Some(0.05),
            added_mass: None,
        }),
        bond: Some(Bond::Suction {
            pump: Pump {
                head: 0.02,
                opening: None,
                supply: Some(0.01),
                valve: Some(0.05),
                passage: Some(0.0),
            },
            seal: Some(0.2),
            anchor: Some(ANCHOR),
            strength: None,
        }),
        ..empty()
    }
}

fn momenta(world: &impl SpatialWorld) -> (Vector3<f64>, Vector3<f64>) {
    let blocks = states(world);
    let turning = |b: &BodyState| b.position.cross(&b.velocity) + b.spin / 6.0;
    let momentum = blocks.iter().map(|b| b.velocity).sum();
    (momentum, blocks.iter().map(turning).sum())
}

fn two_blocks_find_each_other_and_bond<W: SpatialWorld>() {
    let turned = UnitQuaternion::from_scaled_axis(at(0.1, 0.05, 1.65));
    let blocks = [
        BodyState::at_rest(at(0.0, 0.0, 10.0)),
        BodyState {
            orientation: turned,
            ..BodyState::at_rest(at(1.25, 0.1, 10.05))
        },
    ];
    // Weak magnets, whose total work leaves the blocks slow enough to bond.
    let mut scene = reject(0.002, 0.0);
    scene.fluid = Some(Fluid {
        density: None,
        viscosity: Some(0.01),
        added_mass: None,
    });
    let mut world: W = world(&scene, &blocks);
    assert!(world.groups().is_empty());
    assert!(dockings(&mut world, 600).is_empty());
    assert_eq!(world.groups(), [[0, 1]]);
    let (a, b) = (world.state(0), world.state(1));
    assert!(((b.position - a.position).norm() - 1.0).abs() < 1e-3);
    let east = a.orientation * Vector3::x();
    assert!((b.position - a.position - east).norm() < 2e-3);
}

/// Returns a world with two blocks that have just bonded and then get these velocities.
fn pair<W: SpatialWorld>(scene: &Scene, first: Vector3<f64>, second: Vector3<f64>) -> W {
    let positions = [at(0.0, 0.0, 10.0), at(1.01, 0.0, 10.0)];
    let mut world: W = world(scene, &positions.map(BodyState::at_rest));
    dockings(&mut world, 2);
    assert_eq!(world.groups(), [[0, 1]]);
    for (id, velocity) in [(0, first), (1, second)] {
        let state = moving(world.state(id).position, velocity);
        world.set_state(id, &state);
    }
    world
}

fn a_bonded_pair_moves_as_one_body<W: SpatialWorld>() {
    let mut world: W = pair(&reject(0.5, 0.0), at(0.0, 0.02, 0.01), at(0.03, -0.01, 0.0));
    let before = momenta(&world);
    dockings(&mut world, 200);
    let after = momenta(&world);
    assert!((before.0 - after.0).norm() < 1e-4, "{before:?} {after:?}");
    assert!(
        (before.1 - after.1).norm() < 0.02 * before.1.norm(),
        "{before:?} {after:?}"
    );
    let (a, b) = (world.state(0), world.state(1));
    assert!(((b.position - a.position).norm() - 1.0).abs() < 1e-3);
    assert!(a.orientation.angle_to(&b.orientation) < 1e-2);
    assert!((a.spin - b.spin).norm() < 1e-3);
    assert!(a.spin.norm() > 1e-3);
}

fn blocks_that_are_too_fast_do_not_bond<W: SpatialWorld>() {
    // Two blocks that stop each other lose m v^2 / 4. A bond absorbs hold * depth / 3.
    let hold = 0.3;
    let fast = (4.0 * hold * 0.2 / 3.0_f64).sqrt();
    for (speed, bonds) in [(0.5 * fast, true), (1.5 * fast, false)] {
        // The gap is too short for the magnets to change the speed.
        let blocks = [
            BodyState::at_rest(at(0.0, 0.0, 10.0)),
            moving(at(1.02, 0.0, 10.0), at(-speed, 0.0, 0.0)),
        ];
        let settings = Settings::new(Model::Rapier, 40);
        let mut world: W = crate::scenes::world(&reject(hold, 0.0), &settings, &blocks);
        dockings(&mut world, 1);
        assert_eq!(world.groups().is_empty(), !bonds, "{speed}");
    }
}

fn a_pair_is_torn_by_a_flow_that_pulls_harder_than_it_holds<W: SpatialWorld>() {
    // A wide jet from the east, which drags one block more than the other. The shear of the jet
    // also turns one of the blocks.
    let (rate, speed, nozzle) = (0.5, 2.0, 0.2);
    for (hold, holds) in [(0.1, true), (0.004, false)] {
        let mut scene = reject(hold, 0.0);
        scene.enclosure = hemisphere(20.0, 0.01);
        scene.fluid = Some(Fluid {
            density: None,
            viscosity: Some(rate / Fluid::friction(1.0, 1.0)),
            added_mass: None,
        });
        let touching = [at(0.0, 0.9, 10.0), at(0.0, -0.1, 10.0)].map(BodyState::at_rest);
        let mut still: W = world(&scene, &touching);
        dockings(&mut still, 20);
        assert_eq!(still.groups(), [[0, 1]]);
        scene.flow = Some(Flow::Jets(Jets {
            count: 1,
            flow: speed * std::f64::consts::FRAC_PI_4 * nozzle * nozzle,
            nozzle,
        }));
        let mut pulled: W = world(&scene, &touching);
        dockings(&mut pulled, 20);
        assert_eq!(!pulled.groups().is_empty(), holds, "{hold}");
    }
}

fn a_pair_turns_in_a_viscous_vortex_as_its_friction_says_at_every_step<W: SpatialWorld>() {
    // Beyond the core the fluid has no vorticity. The torque of the flow on both blocks balances
    // the torque of their drag.
    let (core, turning, rate) = (0.1, 0.2, 10.0);
    let viscosity = viscosity(rate);
    let still = Scene {
        fluid: Some(Fluid {
            density: None,
            viscosity: Some(viscosity),
            added_mass: None,
        }),
        ..reject(0.5, 0.0)
    };
    let scene = Scene {
        flow: Some(Flow::Stir(Stir {
            radius: core,
            rate: turning,
            force: None,
            follow: 1.0,
        })),
        ..still
    };
    let (arm, speed) = (0.5, turning * core * core / 0.5);
    let (along, about) = (
        Fluid::friction(viscosity, 1.0),
        Fluid::turning_friction(viscosity, 1.0),
    );
    let exact = along * arm * speed / (along * arm * arm + about);
    for substeps in [1, 4, 16] {
        let blocks = [at(-0.5, 0.0, 10.0), at(0.5, 0.0, 10.0)].map(BodyState::at_rest);
        let settings = Settings::new(Model::Rapier, substeps);
        let mut world: W = crate::scenes::world(&scene, &settings, &blocks);
        dockings(&mut world, 20);
        assert_eq!(world.groups(), [[0, 1]]);
        let spin = world.state(0).spin.z;
        assert!(
            (spin / exact - 1.0).abs() < 0.03,
            "{substeps}: {spin} {exact}"
        );
    }
}

/// The fluctuating force within one step grows without limit as steps get shorter.
fn heat_tears_no_bond_however_short_the_steps<W: SpatialWorld>() {
    let (hold, depth) = (0.1, 0.2);
    // A bond can absorb 2,000 times this energy.
    let energy = hold * depth / 3.0 / 2000.0;
    let mut scene = reject(hold, 0.0);
    scene.fluid = Some(Fluid {
        density: None,
        viscosity: Some(viscosity(10.0)),
        added_mass: None,
    });
    scene.agitation = Some(Agitation::Brownian {
        temperature: energy / BOLTZMANN,
    });
    for substeps in [4, 256] {
        let blocks = [at(-0.5, 0.0, 10.0), at(0.5, 0.0, 10.0)].map(BodyState::at_rest);
        let settings = Settings::new(Model::Rapier, substeps);
        let mut world: W = crate::scenes::world(&scene, &settings, &blocks);
        dockings(&mut world, 1);
        for tick in 0..20 {
            assert_eq!(world.groups(), [[0, 1]], "{substeps} steps, tick {tick}");
            dockings(&mut world, 1);
        }
    }
}

fn every_face_of_a_planted_block_attracts<W: SpatialWorld>() {
    let blocks = [
        BodyState::at_rest(at(6.0, 0.0, 3.0)),
        BodyState::at_rest(at(3.0, 0.0, 3.0)),
    ];
    let mut world: W = world(&reject(0.1, 0.0), &blocks);
    let docking = world.plant(SEED).expect("a free block");
    assert_eq!((docking.child, docking.block_face), (1, SEED));
    assert!((world.state(1).position - at(0.0, 0.0, 0.5)).norm() < 1e-6);
    let body = Body::Free(1);
    let mut on: Vec<Face> = world
        .active()
        .into_iter()
        .map(|(block_face, _)| block_face.face)
        .collect();
    on.sort();
    // The lower face of the planted block is attached to the plate.
    let mut faces: Vec<Face> = Face::ALL
        .into_iter()
        .filter(|&face| face != Face::Down)
        .collect();
    faces.sort();
    assert_eq!(on, faces);
    assert!(
        world
            .active()
            .iter()
            .all(|(block_face, _)| block_face.body == body)
    );
}

/// Returns a world with a planted block, number 1, and another block before its east face.
fn with_pair<W: SpatialWorld>(scene: &Scene, gap: f64) -> W {
    let blocks = [
        BodyState::at_rest(at(1.0 + gap, 0.0, 0.5)),
        BodyState::at_rest(at(0.0, 5.0, 5.0)),
    ];
    let mut world: W = world(scene, &blocks);
    world.plant(SEED).expect("a free block");
    world
}

fn a_rejected_block_leaves_with_the_impulse_and_may_come_back_later<W: SpatialWorld>() {
    let east = BlockFace {
        body: Body::Free(1),
        face: Face::East,
    };
    let mut world: W = with_pair(&reject(0.01, 0.028), 0.03);
    let docked = dockings(&mut world, 1);
    assert_eq!(docked.len(), 1);
    assert_eq!((docked[0].block_face, docked[0].child), (east, 0));
    world.switch_off(east);
    assert!(world.anchored(0).is_none());
    assert_eq!(world.state(0).velocity, Vector3::zeros());
    // The block gets the impulse in the next step and stays close enough to dock for two more
    // ticks. It does not dock: its energy, 3.9e-4, exceeds the work of the magnets so far, 3.3e-4.
    assert!(dockings(&mut world, 4).is_empty());
    let away = world.state(0);
    assert!(away.position.x > 1.05, "{away:?}");
    // The total work of the magnets, 0.01 * 0.2 / 3, exceeds its energy, so it returns and docks.
    let again = dockings(&mut world, 400);
    assert_eq!(again.len(), 1);
    assert_eq!(again[0].block_face, east);
}

fn a_block_that_is_rejected_from_a_corner_is_not_taken_by_the_other_side<W: SpatialWorld>() {
    // The block is before the east face of one block and the south face of another.
    let blocks = [
        BodyState::at_rest(at(1.03, 0.0, 0.5)),
        BodyState::at_rest(at(-5.0, 0.0, 5.0)),
        BodyState::at_rest(at(0.0, 5.0, 5.0)),
    ];
    let mut world: W = world(&reject(0.005, 0.1), &blocks);
    let other = BlockFace {
        body: Body::Seed(Cell::new(2, 2, 0)),
        face: Face::Up,
    };
    for seed in [SEED, other] {
        world.plant(seed).expect("a free block");
    }
    let docked = dockings(&mut world, 1);
    assert_eq!(docked.len(), 1);
    world.switch_off(docked[0].block_face);
    assert!(dockings(&mut world, 10).is_empty());
    let away = world.state(0).position - at(1.0, 0.0, 0.5);
    assert!(away.norm() > 0.2, "{away}");
}

fn a_docked_block_rejects_what_hangs_on_it<W: SpatialWorld>() {
    let blocks = [
        BodyState::at_rest(at(1.08, 0.0, 0.5)),
        BodyState::at_rest(at(2.09, 0.0, 0.5)),
        BodyState::at_rest(at(0.0, 5.0, 5.0)),
    ];
    let mut world: W = world(&reject(0.002, 0.05), &blocks);
    dockings(&mut world, 2);
    assert_eq!(world.groups(), [[0, 1]]);
    world.plant(SEED).expect("a free block");
    let docked = dockings(&mut world, 60);
    assert_eq!(docked.len(), 1);
    assert_eq!(docked[0].child, 0);
    assert!(world.groups().is_empty());
    let other = world.state(1);
    assert!(
        other.position.x > 2.0 && other.velocity.x > 0.01,
        "{other:?}"
    );
}

fn an_open_face_draws_a_block_and_holds_it<W: SpatialWorld>() {
    let start = [BodyState::at_rest(at(0.0, 0.0, 2.0))];
    let mut world: W = world(&suction(), &start);
    dockings(&mut world, 50);
    assert_eq!(
        world.state(0).velocity,
        Vector3::zeros(),
        "the valve is closed"
    );
    world.magnetize(SEED);
    // The flow is head / (supply + valve), a sink at a wall. The block follows the fluid: d^2 d' =
    // -Q / 2 pi.
    let flow = 0.02 / 0.06;
    let rate = Fluid::friction(0.05, 1.0);
    dockings(&mut world, 3);
    let block = world.state(0);
    let (height, speed) = (block.position.z, -block.velocity.z);
    let drawn = flow / (std::f64::consts::TAU * height * height);
    let follows = 1.0 - (-rate * 3.0_f64).exp();
    assert!(
        (speed / drawn / follows - 1.0).abs() < 0.1,
        "{speed} {drawn} {follows}"
    );
    let docked = dockings(&mut world, 100);
    assert_eq!(docked.len(), 1);
    world.switch_off(SEED);
    assert!(world.anchored(0).is_none());
    assert!(dockings(&mut world, 20).is_empty());
}

fn suction_from_few_numbers_runs_as_with_all_numbers<W: SpatialWorld>() {
    let drawn = |scene: &Scene| {
        let mut world: W = world(scene, &[BodyState::at_rest(at(0.0, 0.3, 2.0))]);
        world.magnetize(SEED);
        let docked = dockings(&mut world, 200);
        (docked.len(), world.state(0))
    };
    let few = Scene {
        bond: Some(Bond::Suction {
            pump: Pump {
                head: 0.02,
                opening: None,
                supply: None,
                valve: None,
                passage: None,
            },
            seal: None,
            anchor: None,
            strength: None,
        }),
        ..suction()
    };
    let defaults = Suction::from_scene(&few).unwrap();
    let all = Scene {
        bond: Some(Bond::Suction {
            pump: Pump {
                head: 0.02,
                opening: Some(0.5),
                supply: Some(0.0),
                valve: defaults.valve,
                passage: defaults.valve,
            },
            seal: Some(0.125),
            anchor: Some(defaults.anchor),
            strength: None,
        }),
        ..suction()
    };
    // 3 η / r³ is the resistance of an orifice in a fluid without a density.
    let valve = 3.0 * 0.05 / 0.25_f64.powi(3);
    assert!((defaults.valve.unwrap() / valve - 1.0).abs() < 1e-12);
    let (docked, state) = drawn(&few);
    assert_eq!((docked, state), drawn(&all));
    assert_ne!(state.position, at(0.0, 0.3, 2.0));
}

fn a_second_open_face_halves_what_the_first_draws<W: SpatialWorld>() {
    let draw = |open: &[i32]| {
        let scene = Scene {
            // The whole head is lost upstream of the plate, so two open faces share one flow.
            bond: suction().bond.map(|bond| match bond {
                Bond::Suction {
                    pump,
                    seal,
                    anchor,
                    strength,
                } => Bond::Suction {
                    pump: Pump {
                        supply: pump.valve.map(|valve| 1000.0 * valve),
                        head: 1000.0 * pump.head,
                        ..pump
                    },
                    seal,
                    anchor,
                    strength,
                },
                other => other,
            }),
            ..suction()
        };
        let start = [BodyState::at_rest(at(-1.0, 0.0, 2.0))];
        let mut world: W = world(&scene, &start);
        for &x in open {
            let body = Body::Seed(Cell { x, y: 1, z: 0 });
            world.magnetize(BlockFace {
                body,
                face: Face::Up,
            });
        }
        dockings(&mut world, 1);
        world.state(0).velocity
    };
    let (alone, other, both) = (draw(&[0]), draw(&[2]), draw(&[0, 2]));
    // Each face gets half of the flow, as long as the block has moved little.
    assert!(
        (both - (alone + other) / 2.0).norm() < 0.02 * both.norm(),
        "{alone} {other} {both}"
    );
}

fn planting_needs_a_free_block<W: SpatialWorld>() {
    let mut scene = reject(0.1, 0.0);
    scene.contact = contact(0.0, 0.3);
    let mut world: W = world(&scene, &[]);
    assert_eq!(world.plant(SEED), None);
}
