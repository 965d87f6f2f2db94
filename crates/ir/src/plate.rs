//! The blocks on which a structure grows.
use serde::{Deserialize, Serialize};

/// The seed plate: `width` x `depth` blocks at z = 0, only their upper faces exposed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plate {
    /// Blocks from west to east.
    pub width: u32,
    /// Blocks from south to north.
    pub depth: u32,
}

impl Plate {
    /// Blocks along one edge, at most.
    pub const LONGEST: u32 = 100_000;
}
