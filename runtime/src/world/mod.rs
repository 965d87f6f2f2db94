//! Where free blocks move, and what the control of a structure can do to them.
pub(crate) mod lattice;
pub mod rapier;
pub mod shuffle;

use stochc_compiler::{Cell, Face};

/// A block, as a world knows it: without role, and without a part in the structure's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Body {
    /// A block of the plate, which sits at z = 0 in [`Orientation::IDENTITY`] and never moves.
    ///
    /// [`Orientation::IDENTITY`]: crate::orientation::Orientation::IDENTITY
    Seed(Cell),
    /// A block that was free at the beginning: its number, from 0.
    Free(u32),
}

/// One face of one block, named in the block's own frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Site {
    /// Whose.
    pub body: Body,
    /// Which of its own faces.
    pub face: Face,
}

/// A free block has been anchored on a magnetized face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Docking {
    /// The face that captured.
    pub site: Site,
    /// The free block that it holds now.
    pub child: u32,
    /// The child's own face that touches it.
    pub child_face: Face,
    /// Quarter turns, as [`Orientation::docked`] counts them.
    ///
    /// [`Orientation::docked`]: crate::orientation::Orientation::docked
    pub turn: u8,
    /// Times that any free block came into reach of the face since it was magnetized, re-entries
    /// included; a block that is in reach when the face is switched on counts once.
    pub entries: u32,
    /// Tick of the captured block's last entry.
    pub entered: u64,
}

/// The physics broke down at one block.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The number of the free block.
    pub body: u32,
    /// What was found there, as a clause: `speed is not a number`.
    pub what: String,
}

/// A place where free blocks move and magnetized faces capture them.
///
/// A world counts ticks from 0. What is asked of it between two steps holds from the next one on.
pub trait World {
    /// Ticks that have passed.
    fn tick(&self) -> u64;

    /// Switches a face of an anchored block on, to capture the first block that docks there.
    ///
    /// A face that already is on, or holds a block, stays as it is.
    fn magnetize(&mut self, site: Site);

    /// Switches a face off: what it holds drifts away from rest, with all that hangs on it.
    fn switch_off(&mut self, site: Site);

    /// Advances one tick and adds what docked in it to `dockings`, in a reproducible order.
    ///
    /// # Errors
    /// When a block's state makes no sense any more; the world is of no use afterwards.
    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault>;
}
