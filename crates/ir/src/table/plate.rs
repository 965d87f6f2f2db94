//! Seed plate of a structure.
use serde::{Deserialize, Serialize};

/// Seed plate: `width` x `depth` blocks at z = 0, with only their upper faces exposed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plate {
    /// Blocks from west to east.
    pub width: u32,
    /// Blocks from south to north.
    pub depth: u32,
}

impl Plate {
    /// Largest number of blocks along one edge.
    pub const LONGEST: u32 = 100_000;
}
