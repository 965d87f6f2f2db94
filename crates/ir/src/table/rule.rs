//! Rules of blocks: conditions and actions.
use serde::{Deserialize, Serialize};

use crate::{Cell, Face};

/// Index of a role in [`Tables::roles`](super::Tables::roles). A role is a name that blocks take in
/// turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct RoleId(pub u32);

/// Index of a phase in [`Tables::phases`](super::Tables::phases).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct PhaseId(pub u32);

/// Event that starts a duty.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Trigger {
    /// The start of the phase, for a block that is anchored then.
    Start,
    /// The block's own capture, for a block that is captured during the phase.
    Anchored,
}

/// Condition of a rule, in addition to the start of its duty. A block checks its conditions with
/// its own observations only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// A block has been captured at a magnetized face of this block, in this role.
    Docked(RoleId),
    /// The child with this role requests its release.
    Asked(RoleId),
    /// This block has released the child with this role.
    Released(RoleId),
    /// A message has reported this event.
    Notified(Notification),
    /// At least this number of earlier captures of the duty are complete. The block can then
    /// magnetize another face.
    Turn(u8),
}

/// Event reported by a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Notification {
    /// A block has been captured in this role during this phase.
    Anchored(RoleId),
    /// The block in this role has been released during this phase.
    Released(RoleId),
}

/// Action of a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// Makes a face capture, and gives the role to the captured block.
    ///
    /// The mechanism depends on the [bond](super::Tables::bond): the face's magnet is switched on,
    /// or its valve is opened. A face that always attracts keeps the next block instead of
    /// rejecting it.
    Magnetize {
        /// Face in the structure's frame. The block converts it by its orientation.
        face: Face,
        /// Role to give.
        child: RoleId,
        /// Cell across the face, for the child.
        cell: Cell,
    },
    /// Requests release from the parent.
    AskRelease,
    /// Requests release from the parent after this time \[ticks\].
    AskReleaseLater(u32),
    /// Releases the child at a face: switches the magnet off, closes the valve, or rejects the
    /// child with an impulse.
    SwitchOff {
        /// Face in the structure's frame.
        face: Face,
        /// Role that ends.
        child: RoleId,
    },
    /// Sends a notification to another block of the structure, along parents and children.
    Notify {
        /// Receiver of the message.
        to: RoleId,
        /// Event to report.
        notification: Notification,
    },
    /// Reports to the plate, along the chain of parents, that this branch of the phase is complete.
    Report,
}

/// Rule of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Rule<'a> {
    /// Conditions that must all hold. Without conditions, the rule fires at once.
    pub when: &'a [Condition],
    /// Action, performed once.
    pub then: Action,
}
