//! The number of an anchored block.
use serde::{Deserialize, Serialize};

/// Where an anchored block is kept, as long as it is anchored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct BlockSlot(pub u32);

impl BlockSlot {
    /// That of nobody.
    pub const NONE: BlockSlot = BlockSlot(u32::MAX);
}
