//! What blocks say to each other.
use stochc_ir::table::{News, RoleId, Trigger};

use crate::observe::Said;
use crate::world::Body;

/// A message, wherever it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Message {
    pub target: Target,
    pub payload: Payload,
}

/// For whom.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Target {
    /// Any block of the plate.
    Plate,
    /// One block.
    Block(Body),
    /// Whoever holds the role.
    Role(RoleId),
}

/// What it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Payload {
    /// A branch of the phase is done.
    Report(Reporter),
    /// The child with this role asks to be let go.
    Ask(RoleId),
    /// Something happened elsewhere.
    Tell(News),
}

/// Who reports, and by which rule of its duty: a block may have several reports to make.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Reporter {
    pub role: RoleId,
    pub trigger: Trigger,
    pub rule: u32,
}

impl Payload {
    /// What it says, for those who look on.
    pub fn said(self) -> Said {
        match self {
            Payload::Report(by) => Said::Report(by.role),
            Payload::Ask(role) => Said::Ask(role),
            Payload::Tell(News::Anchored(role)) => Said::Anchored(role),
            Payload::Tell(News::Released(role)) => Said::Released(role),
        }
    }
}

impl Message {
    /// News for whoever holds a role, or will.
    pub fn tell(to: RoleId, news: News) -> Message {
        Message {
            target: Target::Role(to),
            payload: Payload::Tell(news),
        }
    }
}
