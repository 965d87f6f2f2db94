//! Tests rejected blocks, and groups attached to a block that docks.

use crate::scenes::{SEED, at, dockings, in_steps, reject, viscous};
use nalgebra::{UnitQuaternion, Vector3};
use stochc_ir::scene::Scene;
use stochc_ir::{Cell, Face};
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld};
use stochc_runtime::{Model, Settings};

in_every_world!(
    an_impulse_moves_a_block_in_a_viscous_fluid_by_j_over_m_gamma_at_every_step,
    what_hangs_on_a_docked_block_leaves_in_one_piece_with_the_impulse,
    a_face_keeps_its_entries_while_a_stray_fills_its_cell,
    entries_count_from_when_a_block_is_expected,
);

/// East face of the block that is planted first.
const EAST: BlockFace = BlockFace {
    body: Body::Free(1),
    face: Face::East,
};

fn an_impulse_moves_a_block_in_a_viscous_fluid_by_j_over_m_gamma_at_every_step<W: SpatialWorld>() {
    let distance = 2.0;
    for rate in [0.5, 20.0] {
        for substeps in [1, 4, 16] {
            let scene = Scene {
                fluid: viscous(rate),
                ..reject(1e-7, distance * rate)
            };
            let blocks = [at(1.0, 0.0, 0.5), at(0.0, 5.0, 5.0)].map(BodyState::at_rest);
            let settings = Settings::new(Model::Rapier, substeps);
            let mut world: W = crate::scenes::world(&scene, &settings, &blocks);
            world.plant(SEED).expect("a free block");
            assert_eq!(dockings(&mut world, 1).len(), 1);
            world.switch_off(EAST);
            assert!(dockings(&mut world, 60).is_empty());
            let moved = world.state(0).position - at(1.0, 0.0, 0.5);
            assert!(
                (moved - at(distance, 0.0, 0.0)).norm() < 1e-3 * distance,
                "{rate} {substeps}: {moved}"
            );
        }
    }
}

/// In a row of three, the middle block gets the whole impulse, and the others follow it.
fn what_hangs_on_a_docked_block_leaves_in_one_piece_with_the_impulse<W: SpatialWorld>() {
    let impulse = 0.05;
    let positions = [
        at(1.04, 0.0, 0.5),
        at(2.04, 0.0, 0.5),
        at(2.04, 1.0, 0.5),
        at(2.04, -1.0, 0.5),
        at(0.0, 5.0, 5.0),
    ];
    let mut world: W = in_steps(&reject(0.002, impulse), &positions.map(BodyState::at_rest));
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

/// Returns two planted blocks, 1 and 2. The east face of block 1 and the south face of block 2
/// adjoin the same cell. Block 0 waits far away.
fn corner<W: SpatialWorld>() -> (W, BlockFace, BlockFace) {
    let positions = [at(0.0, 9.0, 9.0), at(-5.0, 0.0, 5.0), at(0.0, 5.0, 5.0)];
    let mut world: W = in_steps(&reject(1e-6, 0.5), &positions.map(BodyState::at_rest));
    let other = BlockFace {
        body: Body::Seed(Cell::new(2, 2, 0)),
        face: Face::Up,
    };
    let [one, other] = [SEED, other].map(|seed| {
        let docking = world.plant(seed).expect("a free block");
        Body::Free(docking.child)
    });
    let east = BlockFace {
        body: one,
        face: Face::East,
    };
    let south = BlockFace {
        body: other,
        face: Face::South,
    };
    (world, east, south)
}

/// Moves block 0 into the reach of the faces before the cell east of the middle, and away again.
fn visit(world: &mut impl SpatialWorld) {
    for position in [at(1.5, 0.0, 0.5), at(0.0, 9.0, 9.0)] {
        world.set_state(0, &BodyState::at_rest(position));
        assert!(dockings(world, 1).is_empty());
    }
}

fn a_face_keeps_its_entries_while_a_stray_fills_its_cell<W: SpatialWorld>() {
    let (mut world, east, south) = corner::<W>();
    world.magnetize(east);
    visit(&mut world);
    visit(&mut world);
    assert_eq!(world.entries(east), 2);
    // The block is turned so that it docks at the face of the other block.
    let stray = BodyState {
        orientation: UnitQuaternion::from_scaled_axis(Vector3::z() * 0.04),
        ..BodyState::at_rest(at(1.03, -0.01, 0.5))
    };
    world.set_state(0, &stray);
    let docked = dockings(&mut world, 1);
    assert_eq!((docked.len(), docked[0].block_face), (1, south));
    assert_eq!(world.entries(east), 3);
    world.switch_off(south);
    assert!(dockings(&mut world, 1).is_empty());
    assert_eq!(world.entries(east), 3);
}

fn entries_count_from_when_a_block_is_expected<W: SpatialWorld>() {
    let (mut world, east, _) = corner::<W>();
    visit(&mut world);
    visit(&mut world);
    world.magnetize(east);
    assert_eq!(world.entries(east), 0);
    visit(&mut world);
    assert_eq!(world.entries(east), 1);
    // A block that is already there counts as an entry when the wait begins.
    world.set_state(0, &BodyState::at_rest(at(1.5, 0.0, 0.5)));
    dockings(&mut world, 1);
    world.magnetize(east);
    dockings(&mut world, 1);
    assert_eq!(world.entries(east), 1);
}
