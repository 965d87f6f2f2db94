//! Index of an anchored block.
use serde::{Deserialize, Serialize};

/// Index of an anchored block in memory, valid while it is anchored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct BlockSlot(pub u32);

impl BlockSlot {
    pub const NONE: BlockSlot = BlockSlot(u32::MAX);
}
