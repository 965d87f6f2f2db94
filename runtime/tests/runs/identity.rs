//! Checks that runs are equal to the bit, independently of threads, order and scale.

use std::ops::ControlFlow;

use crate::scenes::{Dice, Kind, at, compliant, contact, empty, hemisphere, kicks, paper, pass};
use crate::tables::chain;
use nalgebra::Vector3;
use stochc_ir::Face;
use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::scene::{Agitation, Bond, Contact, ContactLaw, Drag, Scene};
use stochc_ir::table::{PhaseId, Tables};
use stochc_runtime::world::{BodyState, SpatialWorld};
use stochc_runtime::{Reduction, Settings, run};

in_either_precision!(
    a_run_is_the_same_in_order_alone_and_on_any_thread,
    length_mass_and_time_scale,
    a_block_far_away_changes_nothing,
    a_world_that_was_looked_at_goes_on_as_one_that_was_not,
);

/// Returns a small enclosure with many blocks, whose captures follow each other quickly.
fn crowd() -> Scene {
    let mut scene = paper();
    scene.free.count = 40;
    scene.enclosure = hemisphere(1.4, 25.0);
    if let Some(Bond::Attract { anchor, .. }) = &mut scene.bond {
        anchor.within = 0.02;
    }
    scene.drag = Some(Drag { rate: 0.5 });
    scene
}

fn tower() -> Tables {
    chain(&[Face::Up, Face::Up, Face::East]).0
}

fn record(scene: &Scene, settings: &Settings, number: u64) -> RunRecord {
    let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
    run(&tower(), scene, settings, 9, number, &mut watch).expect("a valid scene")
}

/// Returns scenes and settings: the full kernel, substeps, each term left out, both kinds of
/// contact.
fn cases<K: Kind>() -> Vec<(Scene, Settings)> {
    let mut cases = vec![(crowd(), K::settings()), (crowd(), K::with_substeps(3))];
    for reduction in Reduction::ALL {
        let reduction = Some(reduction);
        let settings = K::settings();
        cases.push((
            crowd(),
            Settings {
                reduction,
                ..settings
            },
        ));
    }
    let mut soft = crowd();
    soft.contact = compliant(200.0, 2.0, 0.2);
    cases.push((soft, K::settings()));
    for (_, settings) in &mut cases {
        settings.max_ticks = Some(1500);
    }
    cases
}

fn a_run_is_the_same_in_order_alone_and_on_any_thread<K: Kind>() {
    for (scene, settings) in cases::<K>() {
        let sequence: Vec<RunRecord> = (0..2).map(|n| record(&scene, &settings, n)).collect();
        assert_ne!(sequence[0].bonds, sequence[1].bonds, "{settings:?}");
        assert!(
            sequence
                .iter()
                .all(|r| !matches!(r.outcome, Outcome::Failed { .. }))
        );
        std::thread::scope(|threads| {
            let (scene, settings) = (&scene, &settings);
            let alone = [1, 0].map(|n| (n, threads.spawn(move || record(scene, settings, n))));
            for (n, run) in alone {
                assert_eq!(
                    run.join().expect("a run never panics"),
                    sequence[n as usize]
                );
            }
        });
    }
}

/// The factors are powers of two, so results are equal to the bit.
fn length_mass_and_time_scale<K: Kind>() {
    let (length, mass, time) = (2f64.powi(-14), 2f64.powi(-40), 2f64.powi(-9));
    for (scene, settings) in cases::<K>() {
        let (speed, force) = (length / time, mass * length / (time * time));
        let mut small = scene.clone();
        small.tick *= time;
        small.block.side *= length;
        small.block.mass *= mass;
        small.enclosure = hemisphere(1.4 * length, 25.0 * mass / (time * time));
        small.drag = Some(Drag { rate: 0.5 / time });
        if let Some(Agitation::Kicks { speed: (_, most) }) = &mut small.agitation {
            *most *= speed;
        }
        if let Some(Contact {
            law: ContactLaw::Compliant { stiffness, damping },
            ..
        }) = &mut small.contact
        {
            *stiffness *= mass / (time * time);
            *damping *= mass / time;
        }
        if let Some(Bond::Attract {
            pull,
            align,
            anchor,
            ..
        }) = &mut small.bond
        {
            for reach in [Some(pull), align.as_mut()].into_iter().flatten() {
                reach.force *= force;
                reach.within *= length;
            }
            anchor.within *= length;
        }
        let large = record(&scene, &settings, 2);
        assert!(!large.bonds.is_empty(), "{settings:?}");
        assert_eq!(record(&small, &settings, 2), large);
    }
}

/// Returns blocks that collide in the open, without an enclosure.
fn cluster() -> Vec<BodyState> {
    let mut dice = Dice::new(1);
    let lattice = (0..27).map(|i| at(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)));
    lattice
        .map(|cell| BodyState {
            orientation: dice.rotation(),
            velocity: -0.05 * (cell - at(1.0, 1.0, 1.0)) + 0.03 * dice.direction(),
            spin: 0.05 * dice.direction(),
            position: 1.9 * (cell - at(1.0, 1.0, 1.0)) + at(0.3, 0.2, 8.0),
        })
        .collect()
}

fn states(world: &impl SpatialWorld, count: u32) -> Vec<BodyState> {
    (0..count).map(|id| world.state(id)).collect()
}

/// Without an enclosure the grid extends to the farthest block. A distant block changes the cells
/// of the grid, which changes the order of neighbours.
fn a_block_far_away_changes_nothing<K: Kind>() {
    let mut scene = empty();
    scene.contact = contact(0.3, 0.3);
    scene.agitation = kicks(0.002);
    let near = cluster();
    let end_with = |far: Option<Vector3<f64>>| {
        let blocks: Vec<BodyState> = near
            .iter()
            .copied()
            .chain(far.map(BodyState::at_rest))
            .collect();
        let mut world = K::world(&scene, &blocks);
        pass(&mut world, 400);
        states(&world, 27)
    };
    let alone = end_with(None);
    assert!(
        alone.iter().zip(&near).all(|(a, b)| a.spin != b.spin),
        "each has met another"
    );
    for far in [
        at(60.0, 0.0, 0.0),
        at(0.0, -700.0, 300.0),
        at(9000.0, 9000.0, -9000.0),
    ] {
        assert_eq!(end_with(Some(far)), alone);
    }
}

/// Reading a state must not update the orientation, because that would round it once more.
fn a_world_that_was_looked_at_goes_on_as_one_that_was_not<K: Kind>() {
    let mut scene = empty();
    scene.contact = contact(0.3, 0.3);
    let end = |look: bool| {
        let mut world = K::world(&scene, &cluster());
        for _ in 0..200 {
            pass(&mut world, 1);
            if look {
                states(&world, 27);
            }
        }
        states(&world, 27)
    };
    assert_eq!(end(true), end(false));
}
