//! Transitions: the possible next events of a state.
use stochc_ir::table::RoleId;

use crate::{BlockFace, Body, Message};

/// Message on a hop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct InTransit {
    pub from: Body,
    pub to: Body,
    pub message: Message,
    /// Number of the message on its contact. 0 if messages are never lost. Comparisons of states
    /// ignore it.
    pub number: Ignored<u32>,
    /// Number of times that the message or its acknowledgement was lost in this transfer.
    pub lost: u8,
    /// Whether the receiver has accepted the message, but the sender has received no
    /// acknowledgement.
    pub is_taken: bool,
    /// Whether the message was lost and is waiting to be resent.
    pub is_waiting: bool,
}

/// One step in an order of events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Transition {
    /// The message completes a hop.
    Arrive(InTransit),
    Lose(InTransit),
    /// The message completes a hop, but its acknowledgement is lost.
    LoseAnswer(InTransit),
    SendAgain(InTransit),
    Capture(BlockFace),
    /// A block docks at a face, but does not acknowledge its name.
    Hold(BlockFace),
    /// A silent block acknowledges its name. It may also stay silent.
    Answer(BlockFace),
    /// A face captures a block that assumes one of 23 wrong orientations.
    CaptureMistaken(BlockFace, u8),
    /// A block is captured at a face that is off.
    Stray(BlockFace),
    /// The block in a role fails.
    Die(RoleId),
    /// The plate begins the next phase.
    EndPhase,
    /// The plate aborts the phase at its timeout.
    Abort,
    /// The plate begins the aborted phase again.
    Retry,
}

impl Transition {
    /// Returns whether the transition happens if nothing else does.
    pub fn is_certain(&self) -> bool {
        !matches!(self, Transition::Answer(_))
    }

    /// Returns whether the transition happens only with faults.
    pub fn is_fault(&self) -> bool {
        matches!(
            self,
            Transition::Lose(_)
                | Transition::LoseAnswer(_)
                | Transition::Hold(_)
                | Transition::CaptureMistaken(..)
                | Transition::Stray(_)
                | Transition::Die(_)
        )
    }

    /// Returns the message of the transition. Returns `None` for a transition without a message.
    pub fn transit(&self) -> Option<InTransit> {
        match *self {
            Transition::Arrive(transit)
            | Transition::Lose(transit)
            | Transition::LoseAnswer(transit)
            | Transition::SendAgain(transit) => Some(transit),
            _ => None,
        }
    }
}

/// Value that does not distinguish states: all values are equal.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ignored<T>(pub T);

impl<T> PartialEq for Ignored<T> {
    fn eq(&self, _: &Ignored<T>) -> bool {
        true
    }
}

impl<T> Eq for Ignored<T> {}

impl<T> PartialOrd for Ignored<T> {
    fn partial_cmp(&self, other: &Ignored<T>) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for Ignored<T> {
    fn cmp(&self, _: &Ignored<T>) -> std::cmp::Ordering {
        std::cmp::Ordering::Equal
    }
}

impl<T> std::hash::Hash for Ignored<T> {
    fn hash<H: std::hash::Hasher>(&self, _: &mut H) {}
}
