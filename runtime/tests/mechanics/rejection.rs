//! What becomes of a block that is rejected, and of those that hang on one that docks.

use crate::scenes::{SEED, at, dockings, in_steps, reject, viscous};
use stochc_ir::Face;
use stochc_ir::scene::Scene;
use stochc_runtime::world::{Arena, BlockFace, Body, BodyState};
use stochc_runtime::{Model, Settings};

in_every_world!(
    an_impulse_moves_a_block_in_a_viscous_fluid_by_j_over_m_gamma_at_every_step,
    what_hangs_on_a_docked_block_leaves_in_one_piece_with_the_impulse,
);

/// Of the block that is planted first.
const EAST: BlockFace = BlockFace {
    body: Body::Free(1),
    face: Face::East,
};

fn an_impulse_moves_a_block_in_a_viscous_fluid_by_j_over_m_gamma_at_every_step<W: Arena>() {
    let way = 2.0;
    for rate in [0.5, 20.0] {
        for substeps in [1, 4, 16] {
            let scene = Scene {
                fluid: viscous(rate),
                ..reject(1e-7, way * rate)
            };
            let blocks = [at(1.0, 0.0, 0.5), at(0.0, 5.0, 5.0)].map(BodyState::at_rest);
            let settings = Settings::of(Model::Rapier, substeps);
            let mut world: W = crate::scenes::world(&scene, &settings, &blocks);
            world.plant(SEED).expect("a free block");
            assert_eq!(dockings(&mut world, 1).len(), 1);
            world.switch_off(EAST);
            assert!(dockings(&mut world, 60).is_empty());
            let moved = world.state(0).position - at(1.0, 0.0, 0.5);
            assert!(
                (moved - at(way, 0.0, 0.0)).norm() < 1e-3 * way,
                "{rate} {substeps}: {moved}"
            );
        }
    }
}

/// Of three abreast the middle one gets all of the impulse, which the others follow.
fn what_hangs_on_a_docked_block_leaves_in_one_piece_with_the_impulse<W: Arena>() {
    let impulse = 0.05;
    let places = [
        at(1.04, 0.0, 0.5),
        at(2.04, 0.0, 0.5),
        at(2.04, 1.0, 0.5),
        at(2.04, -1.0, 0.5),
        at(0.0, 5.0, 5.0),
    ];
    let mut world: W = in_steps(&reject(0.002, impulse), &places.map(BodyState::at_rest));
    dockings(&mut world, 1);
    assert_eq!(world.groups(), [[0, 1, 2, 3]]);
    world.plant(SEED).expect("a free block");
    let docked = dockings(&mut world, 1);
    assert_eq!(docked.len(), 1);
    assert_eq!(docked[0].child, 0);
    assert_eq!(world.groups(), [[1, 2, 3]]);
    for id in 1..4 {
        let velocity = world.state(id).velocity;
        let off = velocity - at(impulse / 3.0, 0.0, 0.0);
        assert!(off.norm() < 0.1 * impulse / 3.0, "{velocity}");
    }
}
