//! Blocks and their faces, as hardware knows them: without roles, and without a part in the structure's frame.
use serde::{Deserialize, Serialize};
use stochc_ir::{Cell, Face};

/// A block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Body {
    /// A block of the plate, which sits at z = 0 in [`Orientation::IDENTITY`] and never moves.
    ///
    /// [`Orientation::IDENTITY`]: crate::Orientation::IDENTITY
    Seed(Cell),
    /// A block that was free at the beginning: its number, from 0.
    Free(u32),
}

/// One face of one block, named in the block's own frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct BlockFace {
    /// Whose.
    pub body: Body,
    /// Which of its own faces.
    pub face: Face,
}

/// A free block has been anchored on a magnetized face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Docking {
    /// The face that captured.
    pub site: BlockFace,
    /// The free block that it holds now.
    pub child: u32,
    /// The child's own face that touches it.
    pub child_face: Face,
    /// Quarter turns, as [`Orientation::docked`](crate::Orientation::docked) counts them.
    pub turn: u8,
    /// Times that any free block came into reach of the face since it was magnetized, re-entries
    /// included; a block that is in reach when the face is switched on counts once.
    pub entries: u32,
    /// Tick of the captured block's last entry.
    pub entered: u64,
}
