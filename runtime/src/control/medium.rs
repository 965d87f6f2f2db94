//! What lies between the blocks of a structure: contacts, and the world outside.
use stochc_ir::table::{PhaseId, RoleId};
use stochc_ir::{Cell, Face};

use super::block::Open;
use super::message::{Message, Reporter};
use crate::world::{Body, Docking, Site};

/// Carries out what a [`Structure`](super::structure::Structure) decides.
///
/// A structure has neither time nor chance; whoever drives it brings them: the
/// [`Controller`](super::Controller) with a clock, the [explorer](crate::explore) in every order.
pub(crate) trait Medium {
    /// Switches a face on, for the role `by` to capture what `open` says; where every face always
    /// attracts, nothing has to be switched.
    fn magnetize(&mut self, site: Site, by: RoleId, open: &Open);

    /// Switches a face off, and lets go what it holds; where every face always attracts, that is an
    /// impulse.
    fn switch_off(&mut self, site: Site);

    /// Takes a message for a neighbour: one hop. It comes back by
    /// [`Structure::receive`](super::structure::Structure::receive).
    fn send(&mut self, from: Body, to: Body, message: Message);

    /// Takes back all that is under way between a block that is being let go and its neighbours.
    fn recall(&mut self, gone: Body) -> Recalled;

    /// Throws away all that is under way.
    fn hush(&mut self);

    /// A block has been captured.
    fn captured(&mut self, _capture: &Capture, _docking: &Docking) {}

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
pub(crate) struct Recalled {
    pub to: Vec<Message>,
    pub from: Vec<Message>,
}

/// A capture, as the two blocks see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capture {
    pub phase: PhaseId,
    pub parent: RoleId,
    /// In the structure's frame.
    pub face: Face,
    pub child: RoleId,
    pub cell: Cell,
}
