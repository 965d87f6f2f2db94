//! A run as it stands at a tick, for whoever asks while it goes.
use stochc_ir::Cell;
use stochc_ir::table::{PhaseId, RoleId};

pub use crate::world::view::{ArenaView, pose};

/// A run as it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct RunView {
    /// Ticks that have passed.
    pub tick: u64,
    /// The phase that is running.
    pub phase: PhaseId,
    /// The free blocks that are part of the structure now, by role.
    pub held: Vec<HeldBlock>,
    /// What there is to be seen; `None`: the model has no places.
    pub arena: Option<ArenaView>,
}

/// A free block that is part of the structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeldBlock {
    /// Its number.
    pub body: u32,
    /// Its role.
    pub role: RoleId,
    /// Where it sits.
    pub cell: Cell,
    /// The phase in which it was captured.
    pub phase: PhaseId,
}
