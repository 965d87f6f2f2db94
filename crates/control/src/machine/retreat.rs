//! Release of all captures of an aborted phase, children first.
//!
//! A block that was captured in the phase asks its parent for its release as soon as it holds no
//! block of the phase. A block that stood before the phase and captures in it then reports to the
//! plate. Each block uses only its own table, its faces and its messages.
use stochc_ir::table::{RoleId, Trigger};

use super::block_slot::BlockSlot;
use super::environment::Environment;
use super::message::{Message, Payload, Recipient, Reporter};
use super::structure::Structure;

impl<M: Copy> Structure<'_, M> {
    /// Lets a block ask for its release or report, if it holds no block of the aborted phase.
    pub(super) fn retreat(&mut self, at: BlockSlot, environment: &mut impl Environment<Mark = M>) {
        let Some(block) = self.slots.get(at).filter(|block| !block.is_dead()) else {
            return;
        };
        if !block.seen().is_empty() {
            return;
        }
        let (role, trigger) = (block.role(), block.trigger());
        let (target, payload) = match trigger {
            Trigger::Anchored => match self.parent(block) {
                Some(parent) => (Recipient::Block(parent.body()), Payload::Ask(role)),
                None => return,
            },
            Trigger::Start if block.captures(self.tables) => {
                let rule = 0;
                let by = Reporter {
                    role,
                    trigger,
                    rule,
                };
                (Recipient::Plate, Payload::Report(by))
            }
            // This block only forwarded messages.
            Trigger::Start => return,
        };
        self.forward(at, Message { target, payload }, environment);
    }

    /// Releases a child of the aborted phase, which has asked for it.
    pub(super) fn withdraw(
        &mut self,
        at: BlockSlot,
        child: RoleId,
        environment: &mut impl Environment<Mark = M>,
    ) {
        let Some(block) = self.slots.get(at).filter(|block| !block.is_dead()) else {
            return;
        };
        let Some(face) = block.face_of(self.tables, child) else {
            return;
        };
        let own = block.orientation().to_own(face);
        self.release_block(at, own, child, environment);
        if let Some(block) = self.slots.get_mut(at) {
            block.forget(child);
        }
        self.retreat(at, environment);
    }
}
