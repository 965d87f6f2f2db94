//! Messages between blocks, with recipients and contents.
use serde::{Deserialize, Serialize};
use stochc_ir::table::{Notification, RoleId, Trigger};

use crate::body::Body;

/// A message between blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Message {
    /// Recipient of the message.
    pub target: Recipient,
    /// Content of the message.
    pub payload: Payload,
}

/// Recipient of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Recipient {
    /// Any block of the plate.
    Plate,
    /// One block.
    Block(Body),
    /// The holder of a role.
    Role(RoleId),
}

/// Content of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Payload {
    /// Report that a branch of the phase is complete.
    Report(Reporter),
    /// Request for release by the child with this role.
    Ask(RoleId),
    /// Event that happened elsewhere.
    Notify(Notification),
}

/// Source of a report: a rule of a duty. A block may make several reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Reporter {
    /// Role that reports.
    pub role: RoleId,
    /// Trigger of the duty.
    pub trigger: Trigger,
    /// Index of the rule.
    pub rule: u32,
}

impl Message {
    /// Returns a notification for the present or future holder of a role.
    pub fn notify(to: RoleId, notification: Notification) -> Message {
        Message {
            target: Recipient::Role(to),
            payload: Payload::Notify(notification),
        }
    }
}
