//! What blocks say to each other.
use serde::{Deserialize, Serialize};
use stochc_ir::table::{News, RoleId, Trigger};

use crate::body::Body;

/// A message, wherever it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Message {
    /// For whom.
    pub target: Recipient,
    /// What it says.
    pub payload: Payload,
}

/// For whom a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Recipient {
    /// Any block of the plate.
    Plate,
    /// One block.
    Block(Body),
    /// Whoever holds the role.
    Role(RoleId),
}

/// What a message says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Payload {
    /// A branch of the phase is done.
    Report(Reporter),
    /// The child with this role asks to be let go.
    Ask(RoleId),
    /// Something happened elsewhere.
    Tell(News),
}

/// Who reports, and by which rule of its duty: a block may have several reports to make.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Reporter {
    /// Whose report it is.
    pub role: RoleId,
    /// By which duty.
    pub trigger: Trigger,
    /// By which of its rules.
    pub rule: u32,
}

impl Message {
    /// News for whoever holds a role, or will.
    pub fn tell(to: RoleId, news: News) -> Message {
        Message {
            target: Recipient::Role(to),
            payload: Payload::Tell(news),
        }
    }
}
