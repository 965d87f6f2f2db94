//! Environment of a structure: the contacts between blocks, and the world.
use stochc_ir::table::{PhaseId, RoleId};
use stochc_ir::{Cell, Face};

use super::message::{Message, Reporter};
use crate::body::{BlockFace, Body, Docking};

/// Environment that carries out the decisions of a [`Structure`](super::Structure).
///
/// A structure has neither time nor chance. Its driver supplies both.
pub trait Environment {
    /// Mark of an open face until the face captures a block, for example a tick.
    type Mark: Copy;

    /// Switches a face on for a planned capture. Faces that always attract need no switching.
    fn magnetize(&mut self, block_face: BlockFace, capture: &PlannedCapture) -> Self::Mark;

    /// Switches a face off and releases its block. A face that always attracts rejects its block
    /// with an impulse instead.
    fn switch_off(&mut self, block_face: BlockFace);

    /// Sends a message to a neighbour, over one hop. The driver later delivers the message by
    /// [`Structure::receive`](super::Structure::receive).
    fn send(&mut self, from: Body, to: Body, message: Message);

    /// Sends a message to a neighbour after a time \[ticks\]. A driver without time sends it at once,
    /// because it may deliver the message at any later moment.
    fn send_later(&mut self, from: Body, to: Body, message: Message, _ticks: u32) {
        self.send(from, to, message);
    }

    /// Decides whether a report is carried to the plate at once, over `_hops` hops. Otherwise, the
    /// report is sent hop by hop.
    ///
    /// `true` is allowed if transfers take no time, no message is in transit, and no other capture
    /// happens in the meantime.
    fn carry_to_plate(&mut self, _hops: u32) -> bool {
        false
    }

    /// Removes all messages in transit between a block that is being released and its neighbours.
    /// `unreceived` is the number of these messages, as counted by the structure.
    fn recall(&mut self, left: Body, unreceived: u32) -> Recalled;

    /// Discards all messages in transit.
    fn clear_messages(&mut self);

    /// Records that a face with this mark has captured a block.
    fn captured(&mut self, _capture: &PlannedCapture, _docking: &Docking, _mark: Self::Mark) {}

    /// Records a capture at a face that expects none. `_by` is the role of the block with the face,
    /// and `_face` is in the structure's frame. The face is switched off next.
    fn unplanned(&mut self, _by: RoleId, _face: Face, _docking: &Docking) {}

    /// Records a release. `_by` is the role of the former parent. `_role` and `_body` are the
    /// released block, and `_orphans` is the number of its descendants.
    fn released(&mut self, _by: RoleId, _role: RoleId, _body: Body, _orphans: usize) {}

    /// Records that a report has reached the plate.
    fn reported(&mut self, _by: Reporter) {}
}

/// Messages in transit to and from a block that is being released.
#[derive(Clone, Debug, Default)]
pub struct Recalled {
    /// Messages to the released block.
    pub to: Vec<Message>,
    /// Messages from the released block.
    pub from: Vec<Message>,
}

/// Planned capture, as known to the two blocks.
#[derive(Clone, Copy, Debug)]
pub struct PlannedCapture {
    /// Phase of the capture.
    pub phase: PhaseId,
    /// Role that magnetizes the face.
    pub parent: RoleId,
    /// The face, in the structure's frame.
    pub face: Face,
    /// Role of the captured block.
    pub child: RoleId,
    /// Cell of the captured block.
    pub cell: Cell,
}
