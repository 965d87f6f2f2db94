//! What can happen next.
use stochc_ir::table::RoleId;

use crate::control::message::Message;
use crate::world::{Body, Site};

/// A hop that a message is making.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Flight {
    pub from: Body,
    pub to: Body,
    pub message: Message,
    /// Its number on the contact; 0 where nothing is lost. Only whether two are equal matters, so
    /// it is no part of what a state means.
    pub number: Mute<u32>,
    /// Times that it, or its acknowledgement, has been lost.
    pub lost: u8,
    /// The receiver has it, but its sender does not know.
    pub is_taken: bool,
    /// It has been lost, and waits to be sent again.
    pub is_waiting: bool,
}

/// One step of an order of events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Step {
    /// A hop is complete.
    Arrive(Flight),
    /// A message is lost.
    Lose(Flight),
    /// A hop is complete, but its acknowledgement is lost.
    LoseAnswer(Flight),
    /// A message is sent again.
    SendAgain(Flight),
    /// A face captures a block.
    Capture(Site),
    /// A face captures a block that then believes to sit in another way: one of 23.
    CaptureMistaken(Site, u8),
    /// A block docks on a face that is not on.
    Stray(Site),
    /// The block in a role dies.
    Die(RoleId),
    /// The plate begins the next phase.
    EndPhase,
}

impl Step {
    /// The message that it is about.
    pub fn flight(&self) -> Option<Flight> {
        match *self {
            Step::Arrive(flight)
            | Step::Lose(flight)
            | Step::LoseAnswer(flight)
            | Step::SendAgain(flight) => Some(flight),
            _ => None,
        }
    }
}

/// A value that is no part of what the values around it mean: all are equal.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mute<T>(pub T);

impl<T> PartialEq for Mute<T> {
    fn eq(&self, _: &Mute<T>) -> bool {
        true
    }
}

impl<T> Eq for Mute<T> {}

impl<T> PartialOrd for Mute<T> {
    fn partial_cmp(&self, other: &Mute<T>) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for Mute<T> {
    fn cmp(&self, _: &Mute<T>) -> std::cmp::Ordering {
        std::cmp::Ordering::Equal
    }
}

impl<T> std::hash::Hash for Mute<T> {
    fn hash<H: std::hash::Hasher>(&self, _: &mut H) {}
}
