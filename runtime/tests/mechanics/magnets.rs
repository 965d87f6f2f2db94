//! Tests magnets with steps of any length: the docking window along the path, and the force near
//! the middle.

use crate::scenes::{Kind, at, attract, empty, world};
use nalgebra::UnitQuaternion;
use stochc_ir::scene::{Bond, Reach, Scene};
use stochc_ir::{Cell, Face};
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld, World};
use stochc_runtime::{Substeps, step_errors};

in_every_kind!(
    a_fast_block_docks_if_its_path_leads_through_the_window,
    a_block_next_to_the_middle_of_a_magnet_stays_there,
    a_block_swings_about_the_middle_of_a_magnet_without_gain_or_loss,
    each_force_of_a_magnet_has_its_own_reach,
    a_block_docks_from_beyond_the_reach_of_the_pull,
);

fn open(world: &mut impl World) {
    let (body, face) = (Body::Seed(Cell::new(1, 1, 0)), Face::Up);
    world.magnetize(BlockFace { body, face });
}

/// Returns a scene with these reaches of pull and alignment and a docking window of 0.05.
fn reaches(pull: f64, align: f64) -> Scene {
    let reach = |force, within| Reach { force, within };
    let mut scene = empty();
    scene.bond = attract(0.0, 0.05);
    if let Some(Bond::Attract {
        pull: to_middle,
        align: to_corners,
        ..
    }) = &mut scene.bond
    {
        *to_middle = reach(0.02, pull);
        *to_corners = Some(reach(0.01, align));
    }
    scene
}

/// Uses a twisted block 0.3 over the face.
fn each_force_of_a_magnet_has_its_own_reach<K: Kind>() {
    let block = BodyState {
        orientation: UnitQuaternion::from_scaled_axis(at(0.0, 0.0, 0.2)),
        ..BodyState::at_rest(at(0.0, 0.0, 0.8))
    };
    let after = |pull, align| {
        let mut world = K::world(&reaches(pull, align), &[block]);
        open(&mut world);
        crate::scenes::pass(&mut world, 1);
        let entries = world.active()[0].1;
        (world.state(0).velocity, world.state(0).spin, entries)
    };
    let (both, pull, align, neither) = (
        after(1.0, 1.0),
        after(1.0, 0.1),
        after(0.1, 1.0),
        after(0.1, 0.1),
    );
    assert!((pull.0 - at(0.0, 0.0, -0.02)).norm() < 1e-6 && pull.1.norm() < 1e-6);
    assert!(align.1.z < -1e-3, "{align:?}");
    assert!((pull.0 + align.0 - both.0).norm() < 1e-6);
    assert!((align.1 - both.1).norm() < 1e-6);
    assert!(neither.0.norm() + neither.1.norm() < 1e-6);
    // A block within the reach of the pull counts as entered.
    assert_eq!([both.2, pull.2, align.2, neither.2], [1, 1, 0, 0]);
}

fn a_block_docks_from_beyond_the_reach_of_the_pull<K: Kind>() {
    let block = BodyState::at_rest(at(0.03, 0.0, 0.5));
    let mut world = K::world(&reaches(0.01, 0.01), &[block]);
    open(&mut world);
    let docked = crate::scenes::dockings(&mut world, 1);
    assert_eq!(docked.len(), 1);
    assert_eq!((docked[0].entries, docked[0].entered), (1, 1));
}

/// The block passes the face at three times the width of the window per step. Steps end at various
/// positions.
fn a_fast_block_docks_if_its_path_leads_through_the_window<K: Kind>() {
    let (within, speed) = (0.05, 0.3);
    for start in 0..16 {
        for (aside, expected) in [(0.0, 1), (0.04, 1), (0.06, 0)] {
            let mut scene = empty();
            scene.bond = attract(1e-9, within);
            let direction = at(0.6, 0.0, -0.8);
            let late = f64::from(start) / 16.0;
            let block = BodyState {
                velocity: direction * speed,
                ..BodyState::at_rest(at(0.0, aside, 0.5) - direction * (speed * (2.0 + late)))
            };
            let mut world = K::world(&scene, &[block]);
            open(&mut world);
            let mut dockings = Vec::new();
            for _ in 0..5 {
                world.step(&mut dockings).expect("the physics is stable");
            }
            assert_eq!(dockings.len(), expected, "{late} {aside}");
        }
    }
}

/// Without contact and docking, the face of the block swings through the face of the plate about
/// 300 times. The amplitude is 0.3 block lengths.
fn a_block_swings_about_the_middle_of_a_magnet_without_gain_or_loss<K: Kind>() {
    for (pull, substeps) in [(0.004, 1), (0.016, 2), (0.016, 4)] {
        let mut scene = empty();
        scene.bond = attract(pull, 0.0);
        let block = BodyState::at_rest(at(0.0, 0.0, 0.8));
        let mut world: K::World = world(&scene, &K::with_substeps(substeps), &[block]);
        open(&mut world);
        let mut highest = 0.0f64;
        let (mut rises, mut before) = (0, -1.0);
        for tick in 0..8000 {
            crate::scenes::pass(&mut world, 1);
            let state = world.state(0);
            rises += u32::from(before < 0.0 && state.velocity.z >= 0.0);
            before = state.velocity.z;
            if tick >= 7000 {
                highest = highest.max(state.position.z - 0.5);
            }
        }
        // The block falls from 0.3 under the pull and four corner forces of a twentieth each.
        let quarter = (2.0 * 0.3 / (1.2 * pull)).sqrt();
        let expected = 8000.0 / (4.0 * quarter);
        assert!((highest / 0.3 - 1.0).abs() < 0.02, "{highest}");
        assert!(
            (f64::from(rises) / expected - 1.0).abs() < 0.02,
            "{rises} {expected}"
        );
    }
}

/// The block is closer to the middle than one step at full force would move it. A force that did
/// not fall off would move it to and fro by a hundredth of a block length.
fn a_block_next_to_the_middle_of_a_magnet_stays_there<K: Kind>() {
    let (pull, off) = (0.02, at(1e-4, -5e-5, 2e-4));
    let mut scene = empty();
    scene.bond = attract(pull, 0.0);
    let block = BodyState {
        orientation: UnitQuaternion::from_scaled_axis(at(2e-4, 1e-4, -2e-4)),
        ..BodyState::at_rest(at(0.0, 0.0, 0.5) + off)
    };
    let mut world = K::world(&scene, &[block]);
    open(&mut world);
    for _ in 0..1000 {
        crate::scenes::pass(&mut world, 1);
        let away = world.state(0).position - at(0.0, 0.0, 0.5);
        assert!(away.norm() < 5.0 * off.norm(), "{away}");
    }
}

/// `check --physics` also reports docking times below one tick.
#[test]
fn the_docking_time_follows_from_the_force() {
    const CASES: u32 = 32;
    // The reach is one block length.
    let within = 0.005;
    for force in [0.02, 2.0] {
        let mut scene = empty();
        scene.bond = attract(force, within);
        if let Some(Bond::Attract { align, .. }) = &mut scene.bond {
            *align = None;
        }
        let times = (0..CASES).map(|case| {
            let phase = (f64::from(case) + 0.5) / f64::from(CASES);
            let distance = 0.25 + 0.7 * phase - within;
            (2.0 * distance / force).sqrt()
        });
        let exact = times.sum::<f64>() / f64::from(CASES);
        let steps = Substeps {
            near: 8,
            away: None,
        };
        let errors = step_errors(&scene, steps);
        let [docking] = &errors[..] else {
            panic!("{errors:?}");
        };
        let off = docking.resolved / exact - 1.0;
        assert!(off.abs() < 0.01, "{force}: {docking:?}, exactly {exact}");
    }
}
