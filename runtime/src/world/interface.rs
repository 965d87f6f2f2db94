//! Interface between a world and its controller.
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use stochc_control::{BlockFace, Docking, Orientation};
use stochc_ir::scene::Scene;
use stochc_ir::state::State;
use stochc_ir::table::{Plate, Tables};
use stochc_ir::{Cell, Face};

use super::blocks::BodyState;
use super::error::SceneError;
use super::initial_state;
use crate::settings::Settings;

/// Numerical failure at a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The number of the free block.
    pub body: u32,
    /// Description as a clause: `speed is not a number`.
    pub what: String,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "block {}: {}", self.body, self.what)
    }
}

/// Bond between two free blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FreeBond {
    /// Numbers of the blocks, the lower one first.
    pub bodies: [u32; 2],
    /// Touching face of each block, in its own frame.
    pub faces: [Face; 2],
}

/// Environment of free blocks, which move, and of magnetized faces, which capture them.
///
/// A world counts ticks from 0. Calls between two steps take effect in the next one.
pub trait World: State {
    /// Returns the number of completed ticks.
    fn tick(&self) -> u64;

    /// Sets the cells of the plate that belong to the structure. Called before all other methods.
    /// If the faces of the scene always attract, the faces of the blocks in these cells attract
    /// from now on.
    fn place_seeds(&mut self, _cells: &[Cell]) {}

    /// Switches on a face of an anchored block, to capture the first block that docks there.
    ///
    /// Has no effect on a face that is on or holds a block. If faces always attract, restarts the
    /// entry count of the face.
    fn magnetize(&mut self, block_face: BlockFace);

    /// Switches a face off. Releases the block that it holds and all descendants of that block, at
    /// rest.
    fn switch_off(&mut self, block_face: BlockFace);

    /// Attaches the free block with the highest number to a face, and switches the face on. The
    /// block is aligned with the structure.
    ///
    /// Used for pre-attached blocks, before the first tick. Returns `None` if there is no free
    /// block or the face already holds a block.
    fn plant(&mut self, block_face: BlockFace) -> Option<Docking>;

    /// Returns the number of entries into the reach of an open face so far, including re-entries.
    ///
    /// Returns 0 for other faces and for worlds without positions. A block does not count if
    /// another face captures it into the cell in front of this face.
    fn entries(&self, _site: BlockFace) -> u32 {
        0
    }

    /// Returns the size of the largest group of bonded free blocks, or 1 if there are no bonds.
    fn largest_group(&self) -> u32 {
        1
    }

    /// Advances up to tick `last` while no capture can happen, if the model can predict that. A
    /// capture may follow in the next step.
    fn skip(&mut self, _last: u64) {}

    /// Advances one tick and adds its captures to `dockings`, in a reproducible order.
    ///
    /// # Errors
    ///
    /// If the state of a block is invalid. The world must not be used afterwards.
    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault>;
}

/// World of rigid blocks in space that can be set up and inspected.
///
/// All quantities are in block units: the block length is 1, its mass 1, the tick 1. The origin is
/// the centre of the plate's upper side; z points up.
pub trait SpatialWorld: World + Sized {
    /// Creates the world of a scene at tick 0. `seed` and `run` are the key of its random draws.
    ///
    /// # Errors
    ///
    /// If the scene cannot be set up.
    fn new(
        scene: &Scene,
        plate: &Plate,
        settings: &Settings,
        seed: u64,
        run: u64,
    ) -> Result<Self, SceneError> {
        let blocks = initial_state::blocks(scene, plate, &[])?;
        Self::with_blocks(scene, plate, settings, seed, run, &blocks)
    }

    /// Creates the world of a scene at tick 0 around the seeds of these tables.
    ///
    /// # Errors
    ///
    /// If the scene cannot be set up.
    fn for_tables(
        tables: &Tables,
        scene: &Scene,
        settings: &Settings,
        seed: u64,
        run: u64,
    ) -> Result<Self, SceneError> {
        let seeds: Vec<Cell> = tables.seeds().map(|(_, cell)| cell).collect();
        let blocks = initial_state::blocks(scene, &tables.plate, &seeds)?;
        Self::with_blocks(scene, &tables.plate, settings, seed, run, &blocks)
    }

    /// Creates the world of a scene with these free blocks instead of the scene's own.
    ///
    /// # Errors
    ///
    /// If the scene cannot be set up.
    fn with_blocks(
        scene: &Scene,
        plate: &Plate,
        settings: &Settings,
        seed: u64,
        run: u64,
        blocks: &[BodyState],
    ) -> Result<Self, SceneError>;

    /// Returns the number of blocks, free and anchored. They are numbered from 0.
    fn count(&self) -> u32;

    /// Returns the position and motion of a block.
    fn state(&self, id: u32) -> BodyState;

    /// Sets the position and motion of a free block.
    fn set_state(&mut self, id: u32, state: &BodyState);

    /// Returns the orientation of an anchored block, or `None` if it is free.
    fn anchored(&self, id: u32) -> Option<Orientation>;

    /// Returns the open faces, each with its number of entries so far.
    fn active(&self) -> Vec<(BlockFace, u32)>;

    /// Returns the groups of at least two bonded free blocks, in ascending order.
    fn groups(&self) -> Vec<Vec<u32>>;

    /// Returns the bonds between free blocks in ascending order. They form a tree in each group.
    fn free_bonds(&self) -> Vec<FreeBond>;

    /// Returns the blocks within reach of each open face, with the tick of entry. The list is
    /// sorted by face, then by that tick.
    ///
    /// The result describes the end of the last step: faces switched on since then are not
    /// included.
    fn in_reach(&self) -> Vec<(BlockFace, u32, u64)>;

    /// Returns the centre of the block in a cell \[block lengths\].
    fn centre(&self, cell: Cell) -> Vector3<f64>;
}
