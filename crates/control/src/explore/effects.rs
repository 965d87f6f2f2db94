//! Effects of a transition other than the change of the state.
use stochc_ir::table::{Notification, RoleId};

use super::report::Property;
use crate::{BlockFace, Body, Message};

/// Effects of a transition other than the change of the state.
#[derive(Debug, Default)]
pub(super) struct Effects {
    /// Violated properties, each with the mistake that violates it.
    pub faults: Vec<(Property, Mistake)>,
    /// Releases, as pairs of the former parent and the released block.
    pub released: Vec<(RoleId, RoleId)>,
    /// Faces that were switched on.
    pub opened: Vec<BlockFace>,
    /// Faces that were switched off.
    pub closed: Vec<BlockFace>,
    /// Messages that a block sent or forwarded.
    pub sent: Vec<(Body, Message)>,
    /// Number of reports that reached the plate.
    pub reports: u32,
    pub captured: Vec<RoleId>,
}

/// Mistake in a transition. Each mistake violates a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mistake {
    /// A block was released while it held other blocks.
    Adrift(RoleId),
    /// A role was given to a second block.
    SecondHolder(RoleId),
    /// An event happened before another one that it must follow.
    TooEarly(Notification, Notification),
    /// A block was captured too early: too few of its predecessors at the same parent had been
    /// captured.
    OutOfTurn(RoleId),
    TooManyFaces(RoleId),
}
