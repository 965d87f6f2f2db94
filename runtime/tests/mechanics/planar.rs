//! Tests blocks that slide and turn in a plane.
use std::f64::consts::PI;

use crate::scenes::{
    Dice, at, attract, contact, dockings, empty, energy, in_steps, kicks, moving, pass, states,
    viscous,
};
use nalgebra::{UnitQuaternion, Vector3};
use stochc_ir::scene::dimensionless::{BlockUnits, speed};
use stochc_ir::scene::room::{MIN_SPACING, Obstacles};
use stochc_ir::scene::{
    Agitation, Arrangement, Drag, Enclosure, Fluid, Free, Interior, Planar, Scene, Strength,
    Turbulence,
};
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};
use stochc_runtime::Settings;
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld, World};

in_every_world!(
    a_free_block_keeps_its_motion,
    a_wall_is_met_as_often_as_kinetic_theory_says,
    friction_stops_a_sliding_block,
    friction_stops_a_turning_block,
    friction_holds_a_weakly_pulled_block,
    a_seed_is_solid,
    a_face_of_a_seed_captures_a_square,
    kicks_stay_in_the_plane,
);

mod kernel {
    use super::*;
    in_either_precision!(
        elastic_squares_keep_energy_and_share_it_equally,
        nothing_leaves_the_plane,
        extreme_scenes_stay_in_the_plane,
        blocks_have_the_expected_speed,
    );
}

/// Stiffness of the walls \[1 / tick^2\].
const WALL: f64 = 0.2;

/// The seed in the middle of a plate of 3 x 3, and its block.
const MIDDLE: Cell = Cell::new(1, 1, Planar::LAYER);

fn table(friction: Option<f64>) -> Scene {
    Scene {
        planar: Some(Planar { friction }),
        gravity: friction.map(|_| 0.01),
        ..empty()
    }
}

fn rectangle(length: f64, width: f64) -> Option<Enclosure> {
    let wall = WALL;
    Some(Enclosure::Rectangle {
        length,
        width,
        wall,
    })
}

/// Returns a block in the plane.
fn sliding(x: f64, y: f64, velocity: Vector3<f64>, yaw: f64, spin: f64) -> BodyState {
    BodyState {
        orientation: UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw),
        spin: at(0.0, 0.0, spin),
        ..moving(at(x, y, 0.5), velocity)
    }
}

/// Returns a gas of squares with these speeds and random directions in a rectangle.
fn gas(count: usize, size: [f64; 2], speed: f64) -> Vec<BodyState> {
    let mut dice = Dice::new(5);
    let mut gas: Vec<BodyState> = Vec::new();
    while gas.len() < count {
        let [x, y] = size.map(|length| (length - 2.0) * (dice.unit() - 0.5));
        let (sin, cos) = (2.0 * PI * dice.unit()).sin_cos();
        let pose = at(x, y, 0.5);
        if gas.iter().all(|b| (b.position - pose).norm() > 1.5) {
            let velocity = speed * at(cos, sin, 0.0);
            gas.push(sliding(x, y, velocity, 6.0 * dice.unit(), 0.0));
        }
    }
    gas
}

fn is_level(state: &BodyState) -> bool {
    let turn = state.orientation;
    state.position.z == 0.5
        && state.velocity.z == 0.0
        && [turn.i, turn.j, state.spin.x, state.spin.y] == [0.0; 4]
}

fn a_free_block_keeps_its_motion<W: SpatialWorld>() {
    let velocity = at(0.03, -0.02, 0.0);
    let mut world: W = in_steps(&table(None), &[sliding(0.0, 0.0, velocity, 0.2, 0.01)]);
    pass(&mut world, 100);
    let end = world.state(0);
    assert!(is_level(&end), "{end:?}");
    assert!((end.velocity - velocity).norm() < 1e-6);
    assert!((end.position - at(3.0, -2.0, 0.5)).norm() < 1e-4, "{end:?}");
    assert!((end.orientation.euler_angles().2 - 1.2).abs() < 1e-4);
}

/// Points of one speed v in an area A hit a wall of the length L n v L / π times per tick, n = N /
/// A.
fn a_wall_is_met_as_often_as_kinetic_theory_says<W: SpatialWorld>() {
    let (speed, count, ticks) = (0.02, 1000, 600);
    let disc = Enclosure::Disc {
        radius: 8.0,
        wall: WALL,
    };
    for enclosure in [rectangle(20.0, 14.0), Some(disc)].into_iter().flatten() {
        let mut scene = table(None);
        scene.enclosure = Some(enclosure.clone());
        let plate = Plate { width: 3, depth: 3 };
        let interior = enclosure.interior(&plate, BlockUnits::from_scene(&scene));
        let (area, length) = match interior {
            Interior::Box { half: [x, y], .. } => (4.0 * x * y, 4.0 * (x + y)),
            Interior::Cylinder { radius, .. } => (PI * radius * radius, 2.0 * PI * radius),
            Interior::Ball { .. } => panic!("a flat enclosure"),
        };
        let mut dice = Dice::new(7);
        let mut gas = Vec::new();
        while gas.len() < count {
            let mut along = || interior.reach() * (2.0 * dice.unit() - 1.0);
            let pose = at(along(), along(), 0.5);
            if interior.distance(pose.into()) < 0.0 {
                let (sin, cos) = (2.0 * PI * dice.unit()).sin_cos();
                gas.push(moving(pose, speed * at(cos, sin, 0.0)));
            }
        }
        let mut world: W = in_steps(&scene, &gas);
        let walls = |pose: Vector3<f64>| match interior {
            Interior::Box { half, .. } => [pose.x.abs() > half[0], pose.y.abs() > half[1]],
            _ => [interior.distance(pose.into()) > 0.0, false],
        };
        let mut before = vec![[false; 2]; count];
        let mut hits = 0;
        for _ in 0..ticks {
            pass(&mut world, 1);
            for (block, before) in states(&world).iter().zip(&mut before) {
                let now = walls(block.position);
                hits += (0..2).filter(|&i| now[i] && !before[i]).count();
                *before = now;
                assert_eq!(block.position.z, 0.5);
            }
        }
        let (hits, span) = (hits as f64, count as f64 * f64::from(ticks));
        // A hit takes half of a period of the spring. During this time, a block cannot hit again.
        let found = hits / (1.0 - hits * PI / WALL.sqrt() / span);
        let expected = speed * length / (PI * area) * span;
        let error = 4.0 / expected.sqrt();
        assert!(
            (found / expected - 1.0).abs() < error,
            "{enclosure:?}: {found} {expected}"
        );
    }
}

/// Coulomb friction stops a block at the speed v after v² / (2 μ g).
fn friction_stops_a_sliding_block<W: SpatialWorld>() {
    let (friction, speed) = (0.1, 0.05);
    for yaw in [0.0, 0.4] {
        let velocity = speed * at(0.6, 0.8, 0.0);
        let mut world: W = in_steps(
            &table(Some(friction)),
            &[sliding(0.0, 0.0, velocity, yaw, 0.0)],
        );
        let distance = speed * speed / (2.0 * friction * 0.01);
        pass(&mut world, 49);
        assert!(world.state(0).velocity.norm() > 0.0);
        pass(&mut world, 3);
        let end = world.state(0);
        assert_eq!(end.velocity, Vector3::zeros());
        // Velocities lag positions by half of a step.
        let travelled = end.position.xy().norm();
        assert!(
            (travelled - distance).abs() < speed / 4.0,
            "{travelled} {distance}"
        );
        assert!((end.position.y / end.position.x - 0.8 / 0.6).abs() < 1e-4);
        assert!(is_level(&end), "{end:?}");
    }
}

/// Friction with the mean lever arm c turns a block by I ω² / (2 μ m g c) until it rests.
fn friction_stops_a_turning_block<W: SpatialWorld>() {
    let (friction, spin) = (0.1, 0.05);
    let mut world: W = in_steps(
        &table(Some(friction)),
        &[sliding(0.0, 0.0, Vector3::zeros(), 0.0, spin)],
    );
    pass(&mut world, 100);
    let end = world.state(0);
    assert_eq!(end.spin, Vector3::zeros());
    let angle = spin * spin / 6.0 / (2.0 * friction * 0.01 * Planar::ARM);
    let turned = end.orientation.euler_angles().2;
    assert!((turned - angle).abs() < spin / 4.0, "{turned} {angle}");
    assert!(is_level(&end) && end.position.xy().norm() == 0.0, "{end:?}");
}

/// A block rests under a force below the friction, and moves under a force above it.
fn friction_holds_a_weakly_pulled_block<W: SpatialWorld>() {
    for (pull, is_moved) in [(0.0005, false), (0.002, true)] {
        let mut scene = table(Some(0.1));
        scene.bond = attract(pull, 0.05);
        let mut world: W = in_steps(&scene, &[sliding(1.7, 0.0, Vector3::zeros(), 0.0, 0.0)]);
        world.place_seeds(&[MIDDLE]);
        world.magnetize(side(Face::East));
        pass(&mut world, 10);
        let state = world.state(0);
        assert_eq!(state.position.x < 1.69, is_moved, "{pull}: {state:?}");
        assert!(is_moved || state.velocity.norm() == 0.0);
    }
}

fn side(face: Face) -> BlockFace {
    let body = Body::Seed(MIDDLE);
    BlockFace { body, face }
}

fn a_seed_is_solid<W: SpatialWorld>() {
    let mut scene = table(None);
    scene.contact = contact(0.0, 0.0);
    let mut world: W = in_steps(&scene, &[sliding(3.0, 0.2, at(-0.05, 0.0, 0.0), 0.0, 0.0)]);
    world.place_seeds(&[MIDDLE]);
    pass(&mut world, 100);
    let end = world.state(0);
    assert!((end.position.x - 1.0).abs() < 0.03, "{end:?}");
    assert!(end.velocity.norm() < 0.005, "{end:?}");
}

/// Every side of a seed pulls a square, which docks in the layer of the seed.
fn a_face_of_a_seed_captures_a_square<W: SpatialWorld>() {
    for face in Face::SIDES {
        let normal = Vector3::from(face.normal().map(f64::from));
        let mut scene = table(Some(0.01));
        scene.contact = contact(0.0, 0.1);
        scene.bond = attract(0.01, 0.05);
        let turned = sliding(0.0, 0.0, Vector3::zeros(), 0.3, 0.0);
        let block = BodyState {
            position: at(0.0, 0.0, 0.5) + normal * 1.6 + at(0.1, -0.1, 0.0),
            ..turned
        };
        let mut world: W = in_steps(&scene, &[block]);
        world.place_seeds(&[MIDDLE]);
        world.magnetize(side(face));
        let found = dockings(&mut world, 400);
        assert_eq!(found.len(), 1, "{face:?}");
        let end = world.state(0).position;
        assert_eq!(end, at(0.0, 0.0, 0.5) + normal);
    }
}

/// Random impulses have the mean square of their range in the plane, equal in all directions.
fn kicks_stay_in_the_plane<W: SpatialWorld>() {
    let mut scene = table(None);
    scene.agitation = kicks(0.01);
    let rest = |i: u32| sliding(3.0 * f64::from(i), 0.0, Vector3::zeros(), 0.0, 0.0);
    let blocks: Vec<BodyState> = (0..400).map(rest).collect();
    let mut world: W = in_steps(&scene, &blocks);
    pass(&mut world, 25);
    let squares = states(&world).iter().fold(Vector3::zeros(), |sum, block| {
        assert!(is_level(block));
        sum + block.velocity.component_mul(&block.velocity)
    });
    let expected = 400.0 * 25.0 * 1e-4 / 2.0;
    for found in [squares.x, squares.y] {
        // Four standard errors of a sum of 400 squares.
        assert!((found / expected - 1.0).abs() < 4.0 * (2.0 / 400.0_f64).sqrt());
    }
}

/// A closed elastic gas of squares keeps its energy. Each of the two translations and the rotation
/// gets a third.
fn elastic_squares_keep_energy_and_share_it_equally<K: crate::scenes::Kind>() {
    let size = [24.0, 18.0];
    let mut scene = table(None);
    scene.enclosure = rectangle(size[0], size[1]);
    scene.contact = contact(1.0, 0.0);
    let blocks = gas(60, size, 0.03);
    let total = |blocks: &[BodyState]| blocks.iter().map(energy).sum::<f64>();
    let start = total(&blocks);
    let settings = K::with_substeps(4);
    let mut world: K::World = crate::scenes::world(&scene, &settings, &blocks);
    world.place_seeds(&[]);
    let mut shares = [0.0; 3];
    let mut samples = 0.0;
    for sample in 0..400 {
        pass(&mut world, 25);
        let now = states(&world);
        assert!(now.iter().all(is_level));
        if sample >= 80 {
            for block in &now {
                shares[0] += block.velocity.x.powi(2) / 2.0;
                shares[1] += block.velocity.y.powi(2) / 2.0;
                shares[2] += block.spin.z.powi(2) / 12.0;
            }
            samples += 1.0;
        }
    }
    let mean = shares.map(|share| share / samples);
    let all: f64 = mean.iter().sum();
    // Springs of the walls store a part of the energy.
    assert!((all / start - 1.0).abs() < 0.02, "{all} {start}");
    for share in mean {
        assert!((share / all * 3.0 - 1.0).abs() < 0.06, "{mean:?}");
    }
}

/// Stirs squares by every agitation, pulls them, and lets them collide.
fn nothing_leaves_the_plane<K: crate::scenes::Kind>() {
    let turbulence = Agitation::Turbulence(Turbulence {
        strength: Strength::Speed(0.03),
        length: 3.0,
        time: None,
        vertical: 1.0,
    });
    for (agitation, fluid) in [
        (kicks(0.01), None),
        (kicks(0.01), viscous(0.1)),
        (Some(turbulence), viscous(0.3)),
    ] {
        let scene = Scene {
            free: Free {
                count: 60,
                arrangement: Arrangement::Uniform,
            },
            enclosure: rectangle(16.0, 12.0),
            agitation,
            fluid,
            drag: Some(Drag { rate: 0.02 }),
            contact: contact(0.3, 0.3),
            bond: attract(0.01, 0.05),
            ..table(Some(0.02))
        };
        let plate = Plate { width: 3, depth: 3 };
        let settings = Settings {
            substeps: 8,
            away: Some(2),
            ..K::settings()
        };
        let mut world = K::World::new(&scene, &plate, &settings, 1, 0).expect("it fits");
        world.place_seeds(&[MIDDLE]);
        world.magnetize(side(Face::North));
        let found = dockings(&mut world, 600);
        assert_eq!(found.len(), 1);
        for (id, state) in states(&world).iter().enumerate() {
            assert!(is_level(state), "{id} {state:?}");
            let out = [state.position.x.abs() - 8.0, state.position.y.abs() - 6.0];
            assert!(out[0] < 0.5 && out[1] < 0.5, "{state:?}");
        }
    }
}

/// Compares the rms speed under random impulses with the speed that `check --physics` prints: exact
/// for drag, and an estimate for friction with the table and for collisions.
fn blocks_have_the_expected_speed<K: crate::scenes::Kind>() {
    // Fluid that adds half of the mass of a block, and hardly slows it.
    let heavy = Fluid {
        density: Some(1e-3),
        viscosity: None,
        added_mass: Some(500.0),
    };
    for (friction, restitution, fluid, tolerance) in [
        (None, None, None, 0.04),
        (Some(0.1), None, None, 0.06),
        (Some(0.1), None, Some(heavy), 0.06),
        (Some(0.02), Some(0.5), None, 0.12),
    ] {
        let mut scene = table(friction);
        scene.fluid = fluid;
        scene.agitation = kicks(0.006);
        scene.drag = Some(Drag { rate: 0.01 });
        scene.enclosure = rectangle(40.0, 40.0);
        scene.free.count = 200;
        scene.contact = restitution.and_then(|restitution| contact(restitution, 0.0));
        let plate = Plate { width: 1, depth: 1 };
        let settings = K::with_substeps(2);
        let mut world = K::World::new(&scene, &plate, &settings, 1, 0).expect("it fits");
        let (mut sum, mut samples) = (0.0, 0.0);
        for _ in 0..80 {
            pass(&mut world, 25);
            if world.tick() > 500 {
                let squares = states(&world)
                    .into_iter()
                    .map(|it| it.velocity.norm_squared());
                sum += squares.sum::<f64>() / 200.0;
                samples += 1.0;
            }
        }
        let found = f64::sqrt(sum / samples);
        let expected = speed(&scene).rms.expect("drag limits the speed");
        let error = found / expected - 1.0;
        assert!(
            error.abs() < tolerance,
            "{friction:?} {restitution:?}: {found} {expected}"
        );
    }
}

/// Runs scenes with extreme sizes, frictions and impulses.
fn extreme_scenes_stay_in_the_plane<K: crate::scenes::Kind>() {
    for (radius, count) in [(1.8, 1), (4.0, 15), (30.0, 60), (1e4, 60)] {
        for friction in [None, Some(0.0), Some(1e-9), Some(1e6)] {
            for rms in [1e-9, 0.02, 0.2] {
                let scene = Scene {
                    free: Free {
                        count,
                        arrangement: Arrangement::Uniform,
                    },
                    enclosure: Some(Enclosure::Disc { radius, wall: WALL }),
                    agitation: kicks(rms),
                    drag: Some(Drag { rate: 0.1 }),
                    contact: contact(0.5, 0.5),
                    ..table(friction)
                };
                let settings = K::with_substeps(8);
                let plate = Plate { width: 1, depth: 1 };
                let case = format!("{radius} {count} {friction:?} {rms}");
                let world = K::World::new(&scene, &plate, &settings, 1, 0);
                let mut world = world.unwrap_or_else(|error| panic!("{case}: {error}"));
                world.place_seeds(&[]);
                pass(&mut world, 100);
                for state in states(&world) {
                    assert!(is_level(&state), "{case}: {state:?}");
                    let out = state.position.xy().norm() - radius;
                    assert!(out < 1.0, "{case}: {state:?}");
                    let is_at_rest = state.velocity.norm() == 0.0;
                    assert!(is_at_rest || friction != Some(1e6), "{case}");
                }
            }
        }
    }
}

/// Blocks fill discs and rectangles apart from the seeds.
#[test]
fn blocks_start_apart_from_seeds() {
    let (wide, deep) = (14, 11);
    let plate = Plate {
        width: wide,
        depth: deep,
    };
    let seeds = [Cell::new(7, 0, 1), Cell::new(3, 5, 1), Cell::new(4, 5, 1)];
    let interior = |scene: &Scene| {
        let enclosure = scene.enclosure.as_ref().expect("an enclosure");
        enclosure.interior(&plate, BlockUnits::from_scene(scene))
    };
    for enclosure in [
        rectangle(f64::from(wide), f64::from(deep)),
        Some(Enclosure::Disc {
            radius: 9.0,
            wall: WALL,
        }),
    ] {
        let mut scene = table(None);
        scene.enclosure = enclosure;
        let interior = interior(&scene);
        let obstacles = Obstacles::new(&scene, &plate, &seeds);
        let points: Vec<_> = obstacles.apart(interior.lattice(1.2)).collect();
        assert!(points.len() > 50, "{}", points.len());
        for [x, y, z] in &points {
            assert_eq!(*z, 0.5);
            assert!(interior.distance([*x, *y, *z]) < -0.4999);
            for seed in &seeds {
                let [u, v] = [f64::from(seed.x) - 6.5, f64::from(seed.y) - 5.0];
                assert!((x - u).abs().max((y - v).abs()) > 1.0);
            }
        }
        let all = obstacles.apart(interior.lattice(MIN_SPACING)).count() as u32;
        let mut has_room = |count: u32, seeds: &[Cell]| {
            scene.free.count = count;
            scene.has_room(&plate, seeds).is_ok()
        };
        assert!(has_room(all, &seeds));
        // Without seeds, more blocks fit.
        assert!(!has_room(all + 1, &seeds) && has_room(all + 1, &[]));
    }
}

/// Blocks on a circle do not start on a seed.
#[test]
fn a_ring_avoids_seeds() {
    let plate = Plate { width: 9, depth: 9 };
    // Three blocks east of the centre of the plate.
    let seed = Cell::new(7, 4, Planar::LAYER);
    for (radius, is_free) in [(1.5, true), (2.5, false), (3.0, false), (4.2, true)] {
        let mut scene = table(None);
        scene.enclosure = rectangle(14.0, 14.0);
        scene.free = Free {
            count: 4,
            arrangement: Arrangement::Ring { radius },
        };
        assert!(scene.has_room(&plate, &[]).is_ok(), "{radius}");
        let found = scene.has_room(&plate, &[seed]);
        assert_eq!(found.is_ok(), is_free, "{radius}: {found:?}");
    }
}
