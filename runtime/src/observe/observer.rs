//! Interface of observers, and the events that they see.
use stochc_control::{Body, Payload};
use stochc_ir::state::{State, StateError, StateReader, StateWriter};
use stochc_ir::table::{Notification, PhaseId, RoleId};
use stochc_ir::{Cell, Face};

use crate::world::{FreeBond, SpatialWorld};

/// Observer of a run. It cannot change the run.
pub trait Observer {
    /// Receives the state of every tick, including the first and the last, after all its events.
    ///
    /// `arena` is at that [tick](crate::world::World::tick). `events` are the events since the last
    /// call, in order, all at that tick.
    fn look(&mut self, arena: &impl SpatialWorld, events: &[ObservedEvent]);

    /// Writes the state of the observer for [`Observer::restore`]. See [`State::save`].
    ///
    /// # Errors
    ///
    /// The errors of [`State::save`].
    fn save(&self, to: &mut StateWriter<'_>) -> Result<(), StateError> {
        State::save(&Unknown, to)
    }

    /// Restores the state of the observer.
    ///
    /// # Errors
    ///
    /// The errors of [`State::restore`].
    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        State::restore(&mut Unknown, from)
    }
}

/// State of an observer that does not support checkpoints.
struct Unknown;

impl State for Unknown {}

/// Event in a structure. Faces are in the structure's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObservedEvent {
    /// A phase begins.
    Phase(PhaseId),
    /// A block switches a face on.
    Magnetized {
        /// Block that owns the face.
        body: Body,
        /// Role of the block.
        by: RoleId,
        /// Face that is switched on.
        face: Face,
        /// Role of the block to be captured.
        child: RoleId,
        /// Cell of the block to be captured.
        cell: Cell,
    },
    /// A free block comes within the reach of an open face.
    Entered {
        /// The number of the free block.
        body: u32,
        /// Block that owns the face.
        of: Body,
        /// The face.
        face: Face,
    },
    /// A free block leaves the reach of a face, or the face is switched off or captures another
    /// block.
    Left {
        /// The number of the free block.
        body: u32,
        /// Block that owns the face.
        of: Body,
        /// The face.
        face: Face,
    },
    /// A block is captured.
    Captured {
        /// The number of the block.
        body: u32,
        /// New parent of the block.
        on: Body,
        /// Face of the parent.
        face: Face,
        /// Role of the captured block.
        role: RoleId,
        /// Cell of the captured block.
        cell: Cell,
    },
    /// A block is captured at a face that expects none, and is rejected at once.
    Unplanned {
        /// The number of the block.
        body: u32,
        /// Capturing block.
        on: Body,
        /// Capturing face.
        face: Face,
        /// Role of the capturing block.
        by: RoleId,
    },
    /// Two free blocks bond.
    Bonded {
        /// The bond, with both faces.
        bond: FreeBond,
        /// Number of blocks in the group of the two blocks at the end of the tick.
        size: u32,
    },
    /// A bond between two free blocks breaks, or the structure captures one of them.
    Unbonded {
        /// The bond, with both faces.
        bond: FreeBond,
        /// For each of the two blocks, the number of blocks in its group at the end of the tick. 1
        /// if it is alone or anchored.
        sizes: [u32; 2],
    },
    /// A block is released, and its open faces are switched off.
    Released {
        /// The number of the block.
        body: u32,
        /// Former role of the block.
        role: RoleId,
        /// Role of the block that released it.
        by: RoleId,
    },
    /// A message is sent to a neighbour. Resent messages count again.
    Sent {
        /// Sender of the message.
        from: Body,
        /// Receiver of the message.
        to: Body,
        /// Content of the message.
        content: MessageContent,
    },
    /// The plate counts a report.
    Reported {
        /// Role that sent the report.
        by: RoleId,
    },
}

/// Content of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageContent {
    /// Report: a branch of the phase is complete.
    Report(RoleId),
    /// Request: the block in this role asks its parent for release.
    Ask(RoleId),
    /// A block has been anchored in this role.
    Anchored(RoleId),
    /// The block in this role has been released.
    Released(RoleId),
}

impl From<Payload> for MessageContent {
    fn from(payload: Payload) -> MessageContent {
        match payload {
            Payload::Report(by) => MessageContent::Report(by.role),
            Payload::Ask(role) => MessageContent::Ask(role),
            Payload::Notify(Notification::Anchored(role)) => MessageContent::Anchored(role),
            Payload::Notify(Notification::Released(role)) => MessageContent::Released(role),
        }
    }
}
