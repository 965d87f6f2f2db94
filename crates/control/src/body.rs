//! Blocks and faces at the level of hardware, without roles or positions in the structure.
use serde::{Deserialize, Serialize};
use stochc_ir::{Cell, Face};

/// Physical block, in contrast to the role that the block has in the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Body {
    /// Block of the plate. It is at z = 0 in [`Orientation::IDENTITY`] and never moves.
    ///
    /// [`Orientation::IDENTITY`]: crate::Orientation::IDENTITY
    Seed(Cell),
    /// A block that was free at the start, by its number from 0.
    Free(u32),
}

/// Face of a block, in the block's own frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct BlockFace {
    /// Block that owns the face.
    pub body: Body,
    /// The face.
    pub face: Face,
}

/// Capture of a free block by a magnetized face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Docking {
    /// Face that captured the block.
    pub block_face: BlockFace,
    /// Captured block.
    pub child: u32,
    /// Face of the captured block that touches the parent.
    pub child_face: Face,
    /// Number of quarter turns, as counted by [`Orientation::docked`](crate::Orientation::docked).
    pub turn: u8,
    /// Number of entries of free blocks into the reach of the face since it was magnetized,
    /// including re-entries. A block that was within reach from the start counts as one entry.
    pub entries: u32,
    /// Tick of the captured block's last entry.
    pub entered: u64,
}
