//! What can happen next.
use crate::control::message::Message;
use crate::world::{Body, Site};

/// A hop that a message is making.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Flight {
    pub from: Body,
    pub to: Body,
    pub message: Message,
}

/// One step of an order of events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Step {
    /// A hop is complete.
    Arrive(Flight),
    /// A face captures a block.
    Capture(Site),
    /// The plate begins the next phase.
    EndPhase,
}
