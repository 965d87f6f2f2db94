//! What can happen next.
use stochc_ir::table::RoleId;

use crate::{BlockFace, Body, Message};

/// A hop that a message is making.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct InTransit {
    pub from: Body,
    pub to: Body,
    pub message: Message,
    /// Its number on the contact; 0 where nothing is lost. Only whether two are equal matters, so
    /// it is no part of what a state means.
    pub number: Ignored<u32>,
    /// Times that it, or its acknowledgement, has been lost.
    pub lost: u8,
    /// The receiver has it, but its sender does not know.
    pub is_taken: bool,
    /// It has been lost, and waits to be sent again.
    pub is_waiting: bool,
}

/// One transition of an order of events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Transition {
    /// A hop is complete.
    Arrive(InTransit),
    /// A message is lost.
    Lose(InTransit),
    /// A hop is complete, but its acknowledgement is lost.
    LoseAnswer(InTransit),
    /// A message is sent again.
    SendAgain(InTransit),
    /// A face captures a block.
    Capture(BlockFace),
    /// A face captures a block that then believes to sit in another way: one of 23.
    CaptureMistaken(BlockFace, u8),
    /// A block docks on a face that is not on.
    Stray(BlockFace),
    /// The block in a role dies.
    Die(RoleId),
    /// The plate begins the next phase.
    EndPhase,
}

impl Transition {
    /// The message that it is about.
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

/// A value that is no part of what the values around it mean: all are equal.
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
