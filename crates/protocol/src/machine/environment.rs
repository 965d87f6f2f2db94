//! What lies between the blocks of a structure: contacts, and the world outside.
use stochc_ir::table::{PhaseId, RoleId};
use stochc_ir::{Cell, Face};

use super::message::{Message, Reporter};
use crate::body::{BlockFace, Body, Docking};

/// Carries out what a [`Structure`](super::Structure) decides.
///
/// A structure has neither time nor chance; whoever drives it brings them.
pub trait Environment {
    /// What it notes of a face that is on, until the face captures: for instance since when.
    type Mark: Copy;

    /// Switches a face on, for what `capture` says; where every face always attracts, nothing has to be
    /// switched.
    fn magnetize(&mut self, site: BlockFace, capture: &PlannedCapture) -> Self::Mark;

    /// Switches a face off, and lets go what it holds; where every face always attracts, that is an
    /// impulse.
    fn switch_off(&mut self, site: BlockFace);

    /// Takes a message for a neighbour: one hop. It comes back by
    /// [`Structure::receive`](super::Structure::receive).
    fn send(&mut self, from: Body, to: Body, message: Message);

    /// Whether a report that a block is about to send is at the plate at once, over so many hops: it may be if transfers take no
    /// time, none is under way, and nothing else docks meanwhile, so that nothing can come in between. Otherwise it is
    /// sent hop by hop.
    fn carry_to_plate(&mut self, _hops: u32) -> bool {
        false
    }

    /// Takes back all that is under way between a block that is being let go and its neighbours:
    /// `unreceived` hops, as the structure counts them.
    fn recall(&mut self, gone: Body, unreceived: u32) -> Recalled;

    /// Throws away all that is under way.
    fn clear_messages(&mut self);

    /// A block has been captured, by a face that was on with this mark.
    fn captured(&mut self, _capture: &PlannedCapture, _docking: &Docking, _mark: Self::Mark) {}

    /// A block has docked on a face of the block with the role `by` that expects none; its face is
    /// switched off next. `face` is in the structure's frame.
    fn unplanned(&mut self, _by: RoleId, _face: Face, _docking: &Docking) {}

    /// The block with the role `by` has let another one go, on which `orphans` others still hung.
    fn released(&mut self, _by: RoleId, _role: RoleId, _body: Body, _orphans: usize) {}

    /// A report has come to the plate.
    fn reported(&mut self, _by: Reporter) {}
}

/// What was under way to a block that is being let go, and from it.
#[derive(Clone, Debug, Default)]
pub struct Recalled {
    /// To it.
    pub to: Vec<Message>,
    /// From it.
    pub from: Vec<Message>,
}

/// A capture, as the two blocks see it.
#[derive(Clone, Copy, Debug)]
pub struct PlannedCapture {
    /// In which phase.
    pub phase: PhaseId,
    /// The role that magnetizes a face.
    pub parent: RoleId,
    /// Which, in the structure's frame.
    pub face: Face,
    /// The role that is given.
    pub child: RoleId,
    /// Where the child will sit.
    pub cell: Cell,
}
