//! What a transition has done besides changing the state.
use stochc_ir::table::{News, RoleId};

use super::report::Property;
use crate::{BlockFace, Body, Message};

/// What a transition has done besides changing the state.
#[derive(Debug, Default)]
pub(super) struct Effects {
    /// What went wrong.
    pub faults: Vec<(Property, Mistake)>,
    /// Blocks that were let go: who held it, and who went.
    pub released: Vec<(RoleId, RoleId)>,
    /// Faces that were switched on.
    pub opened: Vec<BlockFace>,
    /// Faces that were switched off.
    pub closed: Vec<BlockFace>,
    /// Messages that made their first hop, or a further one, from a block.
    pub sent: Vec<(Body, Message)>,
    /// Reports that came to the plate.
    pub reports: u32,
    /// Blocks that were captured.
    pub captured: Vec<RoleId>,
}

/// What went wrong, before it is put into words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mistake {
    /// A block was let go that holds others.
    Adrift(RoleId),
    /// A name was given that a block already has.
    SecondHolder(RoleId),
    /// An event happened before another one for which it should have waited.
    TooEarly(News, News),
    /// A block was captured before enough of those that its parent captures first.
    OutOfTurn(RoleId),
    /// A block has too many faces on.
    TooManyFaces(RoleId),
}
