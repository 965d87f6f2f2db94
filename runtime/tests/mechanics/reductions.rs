//! Checks that each reduction leaves out what its name states, and nothing else.

use crate::scenes::{
    Dice, Kind, at, attract, contact, empty, hemisphere, kicks, pass, reject, states,
};
use nalgebra::Vector3;
use stochc_ir::scene::Scene;
use stochc_ir::{Cell, Face};
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld, World};
use stochc_runtime::{Reduction, Settings};

in_either_precision!(
    without_rotation_nothing_turns_whatever_pushes_it,
    without_rotation_two_magnets_turn_no_block,
    without_rotation_a_corner_yields_no_more_than_a_face,
    spheres_touch_at_one_side_whatever_their_orientation,
    spheres_that_collide_off_centre_push_along_their_centres,
    without_friction_what_slides_keeps_its_speed,
    without_block_contact_free_blocks_pass_but_anchored_ones_and_the_ground_hold,
);

fn reduced<K: Kind>(reduction: Reduction) -> Settings {
    Settings {
        reduction: Some(reduction),
        ..K::settings()
    }
}

/// Returns an agitated crowd above a magnet.
fn crowd() -> (Scene, Vec<BodyState>) {
    let mut scene = empty();
    scene.agitation = kicks(0.01);
    scene.contact = contact(0.2, 0.4);
    scene.enclosure = hemisphere(5.0, 0.05);
    scene.bond = attract(0.02, 0.0);
    let mut dice = Dice::new(3);
    let mut blocks: Vec<BodyState> = Vec::new();
    while blocks.len() < 24 {
        let mut position = 5.0 * dice.unit().cbrt() * dice.direction();
        position.z = position.z.abs() + 0.9;
        if blocks.iter().all(|b| (b.position - position).norm() > 1.5) {
            blocks.push(BodyState {
                orientation: dice.rotation(),
                velocity: 0.1 * dice.direction(),
                ..BodyState::at_rest(position)
            });
        }
    }
    (scene, blocks)
}

fn middle_face() -> BlockFace {
    let (body, face) = (Body::Seed(Cell::new(1, 1, 0)), Face::Up);
    BlockFace { body, face }
}

fn without_rotation_nothing_turns_whatever_pushes_it<K: Kind>() {
    let (scene, blocks) = crowd();
    let end_of = |settings: &Settings| {
        let mut world: K::World = crate::scenes::world(&scene, settings, &blocks);
        world.magnetize(middle_face());
        pass(&mut world, 300);
        states(&world)
    };
    let fixed = end_of(&reduced::<K>(Reduction::Rotation));
    for (end, start) in fixed.iter().zip(&blocks) {
        assert_eq!(end.spin, Vector3::zeros());
        assert!(end.orientation.angle_to(&start.orientation) < 8.0 * K::ROUNDING.max(1e-9));
        assert_ne!(end.velocity, start.velocity);
    }
    // In the same scene without the reduction, nearly every block turns.
    let turned = end_of(&K::settings());
    assert!(turned.iter().filter(|b| b.spin.norm() > 1e-3).count() > 12);
}

fn without_rotation_two_magnets_turn_no_block<K: Kind>() {
    let mut dice = Dice::new(6);
    let blocks = [at(0.0, 0.0, 8.0), at(1.4, 0.3, 8.2)].map(|position| BodyState {
        orientation: dice.rotation(),
        ..BodyState::at_rest(position)
    });
    let scene = reject(0.01, 0.0);
    let mut world: K::World =
        crate::scenes::world(&scene, &reduced::<K>(Reduction::Rotation), &blocks);
    pass(&mut world, 10);
    for (before, after) in blocks.iter().zip(states(&world)) {
        assert!(after.velocity.norm() > 1e-5 && after.spin == Vector3::zeros());
        assert!(before.orientation.angle_to(&after.orientation) < 1e-6);
    }
}

/// Without rotation the effective mass of a contact is the whole mass: v' = -e v along the normal.
fn without_rotation_a_corner_yields_no_more_than_a_face<K: Kind>() {
    let mut scene = empty();
    scene.contact = contact(0.5, 0.0);
    scene.enclosure = hemisphere(50.0, 0.01);
    let mut dice = Dice::new(4);
    for _ in 0..20 {
        let orientation = dice.rotation();
        let rows = orientation.to_rotation_matrix().matrix().row(2).abs();
        let block = BodyState {
            orientation,
            velocity: at(0.03, -0.02, -0.1),
            ..BodyState::at_rest(at(0.0, 0.0, 0.5 * rows.sum() - 1e-4))
        };
        let mut world: K::World =
            crate::scenes::world(&scene, &reduced::<K>(Reduction::Rotation), &[block]);
        pass(&mut world, 1);
        let off = (world.state(0).velocity - at(0.03, -0.02, 0.05)).amax();
        assert!(off < 0.1 * 16.0 * K::ROUNDING, "{off:e}");
    }
}

fn spheres_touch_at_one_side_whatever_their_orientation<K: Kind>() {
    let mut scene = empty();
    scene.contact = contact(1.0, 0.3);
    let mut dice = Dice::new(5);
    for _ in 0..20 {
        let (direction, speed) = (dice.direction(), 0.01);
        let mut block = |sign: f64| BodyState {
            orientation: dice.rotation(),
            velocity: -sign * speed * direction,
            ..BodyState::at_rest(at(0.0, 0.0, 8.0) + sign * 0.755 * direction)
        };
        let start = [block(1.0), block(-1.0)];
        let mut world: K::World =
            crate::scenes::world(&scene, &reduced::<K>(Reduction::Corners), &start);
        let mut least = 2.0f64;
        for _ in 0..60 {
            pass(&mut world, 1);
            least = least.min((world.state(0).position - world.state(1).position).norm());
        }
        // An overlap is found at the beginning of a tick, at most one tick after it began. The
        // spheres then return to their previous positions.
        assert!(least < 1.0 && least > 1.0 - 2.0 * speed, "{least}");
        for (id, start) in start.iter().enumerate() {
            let end = world.state(id as u32);
            // In 60 ticks each position has been rounded 60 times to 8 units. The line of centres
            // has the same error. The rebound along it has twice that error. Friction turns the
            // error into spin with I = 1/6 and an arm of 1/2.
            let off = speed * 2.0 * 60.0 * 8.0 * K::ROUNDING;
            assert!((end.velocity + start.velocity).norm() < off);
            assert!(end.spin.norm() < 3.0 * off);
        }
    }
}

/// Frictionless balls exchange their velocities along the line of centres.
fn spheres_that_collide_off_centre_push_along_their_centres<K: Kind>() {
    let mut scene = empty();
    let mut dice = Dice::new(6);
    for e in [0.0, 0.5, 1.0] {
        scene.contact = contact(e, 0.0);
        let direction = dice.direction();
        let depth = 1e-4;
        let mut block = |sign: f64| BodyState {
            orientation: dice.rotation(),
            velocity: -sign * 0.05 * direction + 0.03 * dice.direction(),
            ..BodyState::at_rest(at(0.0, 0.0, 4.0) + sign * 0.5 * (1.0 - depth) * direction)
        };
        let start = [block(1.0), block(-1.0)];
        let mut world: K::World =
            crate::scenes::world(&scene, &reduced::<K>(Reduction::Corners), &start);
        pass(&mut world, 1);
        let impulse = -(1.0 + e) * (start[0].velocity - start[1].velocity).dot(&direction) / 2.0;
        for ((id, sign), start) in [(0, 1.0), (1, -1.0)].into_iter().zip(&start) {
            let end = world.state(id);
            let off = (end.velocity - start.velocity - sign * impulse * direction).amax();
            // Positions, and with them the normal, are rounded to 4 units.
            assert!(off < 0.1 * 20.0 * K::ROUNDING, "{off:e}");
            assert!(end.spin.amax() < 6.0 * 0.1 * 20.0 * K::ROUNDING);
        }
    }
}

fn without_friction_what_slides_keeps_its_speed<K: Kind>() {
    let mut scene = empty();
    scene.contact = contact(0.0, 0.8);
    scene.enclosure = hemisphere(50.0, 0.01);
    let block = BodyState {
        velocity: at(0.05, 0.02, -0.04),
        spin: at(0.0, 0.0, 0.03),
        ..BodyState::at_rest(at(0.0, 0.0, 0.4999))
    };
    let after = |settings: &Settings| {
        let mut world: K::World = crate::scenes::world(&scene, settings, &[block]);
        pass(&mut world, 1);
        world.state(0)
    };
    let slippery = after(&reduced::<K>(Reduction::Friction));
    let off = slippery.velocity.xy() - block.velocity.xy();
    assert!(off.norm() < 0.1 * 8.0 * K::ROUNDING, "{off:?}");
    assert!((slippery.spin.z - block.spin.z).abs() < 0.1 * 8.0 * K::ROUNDING);
    assert!(
        slippery.velocity.z > -1e-4,
        "friction still acts: {:?}",
        slippery.velocity
    );
    let rough = after(&K::settings());
    assert!(rough.velocity.xy().norm() < 0.8 * block.velocity.xy().norm());
}

fn without_block_contact_free_blocks_pass_but_anchored_ones_and_the_ground_hold<K: Kind>() {
    let mut scene = empty();
    scene.contact = contact(1.0, 0.0);
    scene.enclosure = hemisphere(50.0, 0.01);
    scene.bond = attract(0.0, 0.1);
    let settings = reduced::<K>(Reduction::BlockContact);
    let flying = |x: f64, z: f64, vx: f64, vz: f64| BodyState {
        velocity: at(vx, 0.0, vz),
        ..BodyState::at_rest(at(x, 0.0, z))
    };
    // Block 0 is anchored in the first tick. Two blocks meet, one falls on block 0, and one falls
    // on the ground.
    let blocks = [
        flying(0.0, 0.52, 0.0, 0.0),
        flying(-3.0, 5.0, 0.0625, 0.0),
        flying(3.0, 5.0, -0.0625, 0.0),
        flying(0.0, 3.0, 0.0, -0.0625),
        flying(5.0, 3.0, 0.0, -0.0625),
    ];
    let mut world: K::World = crate::scenes::world(&scene, &settings, &blocks);
    world.magnetize(middle_face());
    let mut dockings = Vec::new();
    for _ in 0..96 {
        world.step(&mut dockings).expect("the physics is stable");
    }
    assert_eq!(dockings.len(), 1);
    assert!(world.anchored(0).is_some());
    for (id, sign) in [(1, 1.0), (2, -1.0)] {
        let end = world.state(id);
        // All values are powers of two, so the results are equal to the bit.
        assert_eq!(end.position, at(sign * 3.0, 0.0, 5.0));
        assert_eq!(end.velocity, at(sign * 0.0625, 0.0, 0.0));
    }
    for id in [3, 4] {
        let end = world.state(id);
        assert!(
            (end.velocity - at(0.0, 0.0, 0.0625)).norm() < 1e-3,
            "{end:?}"
        );
    }
    assert!(world.state(3).position.z > 1.49);
}
