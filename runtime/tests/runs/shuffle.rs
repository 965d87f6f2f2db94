//! Compares the world without physics with a simple implementation that visits all blocks in every
//! tick.

use std::collections::BTreeSet;

use crate::tables::Draft;
use proptest::prelude::*;
use stochc_control::{Lattice, Orientation};
use stochc_ir::{Cell, Face};
use stochc_runtime::counter_rng::{Draws, Stream, below, unit};
use stochc_runtime::world::shuffle::ShuffleWorld;
use stochc_runtime::world::{BlockFace, Body, Docking, World as _};

struct Plain {
    tick: u64,
    draws: Draws,
    count: u32,
    lattice: Lattice,
    strays: f64,
    /// Blocks of the plate.
    seeds: BTreeSet<Cell>,
}

impl Plain {
    fn free(&self) -> Vec<u32> {
        let is_free = |id: &u32| !self.lattice.is_anchored(*id);
        (0..self.count).filter(is_free).collect()
    }

    fn magnetize(&mut self, block_face: BlockFace) {
        self.lattice.magnetize(block_face);
    }

    fn plant(&mut self, block_face: BlockFace) -> Option<Docking> {
        self.magnetize(block_face);
        self.lattice.target(block_face)?;
        let child = *self.free().last()?;
        let parent = self.lattice.pose(block_face.body)?.orientation;
        let (child_face, turn) = Orientation::IDENTITY.as_docked(parent, block_face.face)?;
        let docking = Docking {
            block_face,
            child,
            child_face,
            turn,
            entries: 1,
            entered: self.tick,
        };
        self.lattice.dock(&docking);
        Some(docking)
    }

    fn exposed(&self) -> Vec<BlockFace> {
        let seeds = self.seeds.iter().map(|&cell| Body::Seed(cell));
        let blocks = self.lattice.cells().values().map(|&id| Body::Free(id));
        let block_faces = seeds.chain(blocks).flat_map(|body| {
            let faces = match body {
                Body::Seed(_) => &[Face::Up][..],
                Body::Free(_) => &Face::ALL,
            };
            faces.iter().map(move |&face| BlockFace { body, face })
        });
        let is_off = |block_face: &BlockFace| !self.lattice.active().contains(block_face);
        let has_room = |block_face: &BlockFace| self.lattice.target(*block_face).is_some();
        block_faces.filter(is_off).filter(has_room).collect()
    }

    fn dock_one(
        &mut self,
        block_faces: &[BlockFace],
        words: [u32; 3],
        dockings: &mut Vec<Docking>,
    ) {
        let free = self.free();
        if block_faces.is_empty() || free.is_empty() {
            return;
        }
        let [which, which_block, how] = words;
        let pose = below(how, 24) as u8;
        let docking = Docking {
            block_face: block_faces[below(which, block_faces.len() as u32) as usize],
            child: free[below(which_block, free.len() as u32) as usize],
            child_face: Face::ALL[usize::from(pose / 4)],
            turn: pose % 4,
            entries: 1,
            entered: self.tick,
        };
        self.lattice.dock(&docking);
        dockings.push(docking);
    }

    fn step(&mut self) -> Vec<Docking> {
        let mut dockings = Vec::new();
        let [whether, which, which_block, how] = self.draws.step(self.tick).block(1);
        if unit(whether) < self.strays {
            self.dock_one(&self.exposed(), [which, which_block, how], &mut dockings);
        }
        let open = self.lattice.active().iter().copied();
        let open: Vec<_> = open
            .filter(|&block_face| self.lattice.target(block_face).is_some())
            .collect();
        let [which, which_block, how, _] = self.draws.step(self.tick).block(0);
        self.tick += 1;
        self.dock_one(&open, [which, which_block, how], &mut dockings);
        dockings
    }
}

#[derive(Clone, Debug)]
enum Operation {
    Magnetize,
    SwitchOff,
    Plant,
    Step,
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn the_world_agrees_with_a_reference(
        deeds in prop::collection::vec(
            (
                prop_oneof![
                    4 => Just(Operation::Magnetize),
                    1 => Just(Operation::SwitchOff),
                    1 => Just(Operation::Plant),
                    4 => Just(Operation::Step),
                ],
                any::<prop::sample::Index>(),
                prop::sample::select(Face::ALL.to_vec()),
            ),
            0..150,
        ),
        count in 0u32..40,
        strays in prop_oneof![Just(0.0), 0.0..1.0],
        seed: u64,
    ) {
        let mut draft = Draft::default();
        let plate = [(2, 1), (0, 0), (1, 1), (1, 0)];
        for (x, y) in plate {
            draft.seed("seed", x, y);
        }
        let tables = draft.tables();
        let mut world = ShuffleWorld::new(&tables, count, seed, 7).with_strays(strays);
        let mut plain = Plain {
            tick: 0,
            draws: Draws::new(seed, 7, Stream::Shuffle),
            count,
            lattice: Lattice::default(),
            strays,
            seeds: plate.map(|(x, y)| Cell::new(x, y, 0)).into(),
        };
        for (deed, which, face) in deeds {
            let seeds = plate.map(|(x, y)| Body::Seed(Cell::new(x, y, 0)));
            let blocks = plain.lattice.cells().values().map(|id| Body::Free(*id));
            let bodies: Vec<Body> = seeds.into_iter().chain(blocks).collect();
            let block_face = BlockFace { body: bodies[which.index(bodies.len())], face };
            match deed {
                Operation::Magnetize => {
                    plain.magnetize(block_face);
                    world.magnetize(block_face);
                }
                Operation::SwitchOff => {
                    plain.lattice.switch_off(block_face);
                    world.switch_off(block_face);
                }
                Operation::Plant => prop_assert_eq!(plain.plant(block_face), world.plant(block_face)),
                Operation::Step => {
                    let mut dockings = Vec::new();
                    prop_assert_eq!(world.step(&mut dockings), Ok(()));
                    prop_assert_eq!(plain.step(), dockings);
                }
            }
            prop_assert_eq!(plain.lattice.cells(), &world.cells());
        }
        for &id in plain.lattice.cells().values() {
            let pose = plain.lattice.pose(Body::Free(id));
            prop_assert_eq!(pose.map(|pose| pose.orientation), world.orientation(Body::Free(id)));
        }
    }
}
