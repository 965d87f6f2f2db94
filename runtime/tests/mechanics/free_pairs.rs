//! Tests where and when two free blocks bond, and which quantities stay unchanged.

use crate::scenes::{
    SEED, at, dockings, gas, hemisphere, in_steps, moving, reject, states, viscous,
};
use nalgebra::{UnitQuaternion, Vector3};
use stochc_ir::scene::{Agitation, Bond, Drag, Flow, Scene, Stir};
use stochc_runtime::world::{BodyState, SpatialWorld};

in_every_world!(
    a_face_takes_one_block,
    blocks_of_a_group_sit_side_by_side,
    a_block_does_not_dock_by_a_face_that_holds_another_one,
    a_pair_that_drag_tears_apart_stays_apart,
    a_pair_bonds_wherever_a_step_ends_and_however_fast_both_move,
    blocks_bond_from_beyond_the_reach_of_their_magnets,
    bonding_moves_no_middle_and_shares_the_turn,
);

/// Returns the least distance between two blocks of one group, at most 2.
fn nearest(world: &impl SpatialWorld) -> f64 {
    let blocks = states(world);
    let mut least: f64 = 2.0;
    for group in world.groups() {
        for (i, &a) in group.iter().enumerate() {
            for &b in &group[i + 1..] {
                let displacement = blocks[a as usize].position - blocks[b as usize].position;
                least = least.min(displacement.norm());
            }
        }
    }
    least
}

fn a_face_takes_one_block<W: SpatialWorld>() {
    let positions = [
        at(0.0, 0.0, 10.0),
        at(1.02, 0.0, 10.0),
        at(1.03, 0.01, 10.0),
    ];
    let mut world: W = in_steps(&reject(1e-6, 0.0), &positions.map(BodyState::at_rest));
    dockings(&mut world, 3);
    assert_eq!(world.groups(), [[0, 1]]);
}

/// Without contact only the bonds keep blocks from overlapping.
fn blocks_of_a_group_sit_side_by_side<W: SpatialWorld>() {
    let mut scene = reject(0.05, 0.0);
    scene.agitation = Some(Agitation::Kicks { speed: (0.0, 0.02) });
    scene.drag = Some(Drag { rate: 0.1 });
    scene.enclosure = hemisphere(3.5, 0.05);
    let blocks = gas(24, 5, (at(0.0, 0.0, 2.0), 2.0), 0.9, 0.01);
    let mut world: W = in_steps(&scene, &blocks);
    for tick in 0..300 {
        dockings(&mut world, 1);
        let least = nearest(&world);
        assert!(least > 0.9, "tick {tick}: {least}");
    }
    assert!(world.largest_group() > 3, "{:?}", world.groups());
}

fn a_block_does_not_dock_by_a_face_that_holds_another_one<W: SpatialWorld>() {
    let positions = [at(1.03, 0.0, 0.5), at(0.03, 0.0, 0.5), at(0.0, 5.0, 5.0)];
    let mut world: W = in_steps(&reject(1e-6, 0.01), &positions.map(BodyState::at_rest));
    dockings(&mut world, 1);
    assert_eq!(world.groups(), [[0, 1]]);
    world.plant(SEED).expect("a free block");
    assert!(dockings(&mut world, 4).is_empty());
    assert_eq!(world.groups(), [[0, 1]]);
}

/// A strain of the fluid separates two blocks at a relative speed u. Their bond has to hold γ u /
/// 2.
fn a_pair_that_drag_tears_apart_stays_apart<W: SpatialWorld>() {
    let (rate, apart, from_axis) = (40.0, 0.05, 3.0);
    let load = rate * apart / 2.0;
    for (hold, holds) in [(4.0 * load, true), (load / 4.0, false)] {
        let scene = Scene {
            fluid: viscous(rate),
            // Beyond the core u = Ω r²/s. At 45 degrees to the radius it strains by Ω r²/s².
            flow: Some(Flow::Stir(Stir {
                radius: 1.0,
                rate: apart * from_axis * from_axis,
                force: None,
                follow: 1.0,
            })),
            ..reject(hold, 0.0)
        };
        let out = at(0.5, -0.5, 0.0).normalize();
        let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * -std::f64::consts::FRAC_PI_4);
        let blocks = [-0.5, 0.5].map(|along| BodyState {
            orientation: turn,
            ..BodyState::at_rest(at(from_axis, 0.0, 10.0) + out * along)
        });
        let mut world: W = in_steps(&scene, &blocks);
        dockings(&mut world, 6);
        let gap = (world.state(1).position - world.state(0).position).norm() - 1.0;
        assert_eq!(!world.groups().is_empty(), holds, "{hold}: {gap}");
        assert_eq!(gap < 0.01, holds, "{hold}: {gap}");
    }
}

/// The blocks attract each other from a tenth of a block length. The window is 0.01 block lengths
/// wide, and a step crosses it by 0.024.
fn a_pair_bonds_wherever_a_step_ends_and_however_fast_both_move<W: SpatialWorld>() {
    let mut scene = reject(0.05, 0.0);
    if let Some(Bond::Reject { anchor, .. }) = &mut scene.bond {
        anchor.within = 0.005;
    }
    for start in 0..16 {
        for common in [Vector3::zeros(), at(0.3, 0.2, -0.4)] {
            let gap = 0.1 + 0.024 * f64::from(start) / 16.0;
            let positions = [at(0.0, 0.0, 10.0), at(1.0 + gap, 0.0, 10.0)];
            let mut world: W =
                in_steps(&scene, &positions.map(|position| moving(position, common)));
            dockings(&mut world, 5);
            assert_eq!(world.groups(), [[0, 1]], "{start} {common}");
        }
    }
}

fn blocks_bond_from_beyond_the_reach_of_their_magnets<W: SpatialWorld>() {
    let mut scene = reject(0.01, 0.0);
    if let Some(Bond::Reject { magnets, .. }) = &mut scene.bond {
        magnets.within = 0.01;
    }
    let positions = [at(0.0, 0.0, 10.0), at(1.03, 0.0, 10.0)];
    let mut world: W = in_steps(&scene, &positions.map(BodyState::at_rest));
    dockings(&mut world, 1);
    assert_eq!(world.groups(), [[0, 1]]);
}

fn bonding_moves_no_middle_and_shares_the_turn<W: SpatialWorld>() {
    let twist = |angle: f64| UnitQuaternion::from_scaled_axis(Vector3::x() * angle);
    for (off, angle) in [(at(0.03, 0.0, 0.0), 0.2), (at(0.01, 0.02, -0.03), 0.0)] {
        let first = at(0.0, 0.0, 10.0);
        let blocks = [
            BodyState::at_rest(first),
            BodyState {
                orientation: twist(angle),
                ..BodyState::at_rest(first + Vector3::x() + off)
            },
        ];
        let mut world: W = in_steps(&reject(1e-9, 0.0), &blocks);
        dockings(&mut world, 1);
        assert_eq!(world.groups(), [[0, 1]]);
        let [a, b] = [0, 1].map(|id| world.state(id));
        let middle = first + (Vector3::x() + off) / 2.0;
        assert!(((a.position + b.position) / 2.0 - middle).norm() < 1e-5);
        assert!((b.position - a.position - a.orientation * Vector3::x()).norm() < 1e-5);
        if angle > 0.0 {
            assert!(a.orientation.angle_to(&twist(angle / 2.0)) < 1e-3);
            assert!(b.orientation.angle_to(&twist(angle / 2.0)) < 1e-3);
        }
    }
}
