//! What a step of any length makes of a magnet: the docking window along the way, and the force near its middle.

use crate::scenes::{Kind, at, attract, empty, world};
use nalgebra::UnitQuaternion;
use stochc_ir::scene::Bond;
use stochc_ir::{Cell, Face};
use stochc_runtime::world::{Arena, BlockFace, Body, BodyState, World};
use stochc_runtime::{Substeps, step_errors};

in_every_kind!(
    a_fast_block_docks_if_its_way_leads_through_the_window,
    a_block_next_to_the_middle_of_a_magnet_stays_there,
    a_block_swings_about_the_middle_of_a_magnet_without_gain_or_loss,
);

fn open(world: &mut impl World) {
    let (body, face) = (Body::Seed(Cell::new(1, 1, 0)), Face::Up);
    world.magnetize(BlockFace { body, face });
}

/// It passes the face at three times the width of the window in a step, wherever steps end.
fn a_fast_block_docks_if_its_way_leads_through_the_window<K: Kind>() {
    let (within, speed) = (0.05, 0.3);
    for start in 0..16 {
        for (aside, expected) in [(0.0, 1), (0.04, 1), (0.06, 0)] {
            let mut scene = empty();
            scene.bond = attract(1e-9, within);
            let way = at(0.6, 0.0, -0.8);
            let late = f64::from(start) / 16.0;
            let block = BodyState {
                velocity: way * speed,
                ..BodyState::at_rest(at(0.0, aside, 0.5) - way * (speed * (2.0 + late)))
            };
            let mut world = K::world(&scene, &[block]);
            open(&mut world);
            let mut dockings = Vec::new();
            for _ in 0..5 {
                world.step(&mut dockings).expect("sound physics");
            }
            assert_eq!(dockings.len(), expected, "{late} {aside}");
        }
    }
}

/// Without contact and docking, its face swings through that of the plate, by 0.3 sides, for some 300 times.
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
        // Down from 0.3 with the pull and four corners at a twentieth each.
        let quarter = (2.0 * 0.3 / (1.2 * pull)).sqrt();
        let expected = 8000.0 / (4.0 * quarter);
        assert!((highest / 0.3 - 1.0).abs() < 0.02, "{highest}");
        assert!(
            (f64::from(rises) / expected - 1.0).abs() < 0.02,
            "{rises} {expected}"
        );
    }
}

/// It is nearer to the middle than a step moves it at the full force: a force that does not fall off throws it a hundredth of
/// a side to and fro.
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

/// Also where a docking takes less than a tick: what `check --scene` tells of it.
#[test]
fn a_docking_takes_as_long_as_a_constant_force_says() {
    const CASES: u32 = 32;
    // The reach is a side.
    let within = 0.005;
    for force in [0.02, 2.0] {
        let mut scene = empty();
        scene.bond = attract(force, within);
        if let Some(Bond::Attract { align, .. }) = &mut scene.bond {
            *align = None;
        }
        let times = (0..CASES).map(|case| {
            let phase = (f64::from(case) + 0.5) / f64::from(CASES);
            let way = 0.25 + 0.7 * phase - within;
            (2.0 * way / force).sqrt()
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
