//! Where free blocks move, and what the control of a structure can do to them.
mod block_units;
mod blocks;
mod bonding;
mod cell_centres;
mod delegate;
mod error;
mod external_forces;
mod free_bonds;
mod grid;
mod groups;
mod initial_state;
mod lattice;
mod motion_limits;
mod parameters;
mod ranked;
pub mod rapier;
pub mod rate;
mod real;
pub mod rigid;
pub mod rotation;
mod shell_force;
pub mod shuffle;
mod step_limit;
mod stepper;
mod unit_cube;
pub mod view;

pub use blocks::BodyState;
pub use error::SceneError;
pub use stochc_protocol::{BlockFace, Body, Docking};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use stochc_ir::scene::Scene;
use stochc_ir::state::State;
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};

use stochc_protocol::Orientation;

use crate::settings::Settings;

/// The physics broke down at one block.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The number of the free block.
    pub body: u32,
    /// What was found there, as a clause: `speed is not a number`.
    pub what: String,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "block {}: {}", self.body, self.what)
    }
}

/// A bond between two free blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FreeBond {
    /// The numbers of the blocks, the lower one first.
    pub bodies: [u32; 2],
    /// The face of each that meets one of the other's, in its own frame.
    pub faces: [Face; 2],
}

/// A place where free blocks move and magnetized faces capture them.
///
/// A world counts ticks from 0. What is asked of it between two steps holds from the next one on.
pub trait World: State {
    /// Ticks that have passed.
    fn tick(&self) -> u64;

    /// Says in which cells of the plate there are blocks that belong to the structure: before the first tick, and before anything
    /// else is asked. Where every face attracts by itself, theirs do from then on.
    fn place_seeds(&mut self, _cells: &[Cell]) {}

    /// Switches a face of an anchored block on, to capture the first block that docks there.
    ///
    /// A face that already is on, or holds a block, stays as it is; where faces attract by themselves, one that is on counts
    /// entries from now on.
    fn magnetize(&mut self, site: BlockFace);

    /// Switches a face off: what it holds drifts away from rest, with all that hangs on it.
    fn switch_off(&mut self, site: BlockFace);

    /// Anchors the free block with the highest number on a face, as if it had docked there straight, and
    /// switches the face on if it was off; `None`: there is no free block, or the face holds one.
    ///
    /// For what is attached by hand before the first tick.
    fn plant(&mut self, site: BlockFace) -> Option<Docking>;

    /// Times so far that a free block came into the reach of a face that is on and holds nothing,
    /// re-entries included; 0 for other faces, and where nothing has a place. A block that is there for a moment on another one's
    /// face, in the cell before this one, changes nothing.
    fn entries(&self, _site: BlockFace) -> u32 {
        0
    }

    /// Blocks of the largest group of free blocks that are bonded to each other; 1: none are.
    fn largest_group(&self) -> u32 {
        1
    }

    /// Lets time pass up to tick `last` at most while nothing can dock, where the model knows when that is; the step after it may
    /// dock something.
    fn skip(&mut self, _last: u64) {}

    /// Advances one tick and adds what docked in it to `dockings`, in a reproducible order.
    ///
    /// # Errors
    /// When a block's state makes no sense any more; the world is of no use afterwards.
    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault>;
}

/// A world of rigid blocks in space, which can be set up by hand and looked into.
///
/// Everything is in block units: the side of a block is 1, its mass 1, the tick 1. The origin is the
/// centre of the plate's upper side; z is up.
pub trait Arena: World + Sized {
    /// The scene at tick 0, with the chance of run `run` of the ensemble with this `seed`.
    ///
    /// # Errors
    /// When the scene cannot be set up.
    fn new(
        scene: &Scene,
        plate: &Plate,
        settings: &Settings,
        seed: u64,
        run: u64,
    ) -> Result<Self, SceneError> {
        let blocks = initial_state::blocks(scene, plate)?;
        Self::with_blocks(scene, plate, settings, seed, run, &blocks)
    }

    /// The scene with free blocks of one's own choice instead of its own.
    ///
    /// # Errors
    /// When the scene cannot be set up.
    fn with_blocks(
        scene: &Scene,
        plate: &Plate,
        settings: &Settings,
        seed: u64,
        run: u64,
        blocks: &[BodyState],
    ) -> Result<Self, SceneError>;

    /// How many blocks there are, free and anchored; their numbers are from 0.
    fn count(&self) -> u32;

    /// Where a block is and how it moves.
    fn state(&self, id: u32) -> BodyState;

    /// Puts a free block somewhere else, or in another motion.
    fn set_state(&mut self, id: u32, state: &BodyState);

    /// How a block sits in the structure; `None`: it is free.
    fn anchored(&self, id: u32) -> Option<Orientation>;

    /// The faces that are on and hold nothing, each with the entries into its reach so far.
    fn active(&self) -> Vec<(BlockFace, u32)>;

    /// The free blocks that are bonded to each other, by group: at least two in each, all in rising order.
    fn groups(&self) -> Vec<Vec<u32>>;

    /// The bonds that hold them together, in rising order: a tree in each group.
    fn free_bonds(&self) -> Vec<FreeBond>;

    /// The blocks in the reach of each face that is on and holds nothing, by face and in the order
    /// of their entries: the block, and the tick of its entry.
    ///
    /// As of the end of the last step: a face that has been switched on since is not among them.
    fn in_reach(&self) -> Vec<(BlockFace, u32, u64)>;

    /// The centre of the block that sits in a cell \[side\].
    fn centre(&self, cell: Cell) -> Vector3<f64>;
}
