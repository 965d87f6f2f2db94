//! Routing of messages, hop by hop along parents and children.
//!
//! A block sends to its parent, or to the child whose branch contains the receiver. The plate is
//! one body, so crossing it is not a hop. A notification for a role without a holder
//! waits at the block that will capture it: every block has the program and can determine that
//! block. A released block leaves its received messages to the next holder of its role.
use smallvec::SmallVec;
use stochc_ir::table::RoleId;

use super::block::Path;
use super::block_slot::BlockSlot;
use super::environment::Environment;
use super::message::{Message, Payload, Recipient};
use super::structure::Structure;

impl<M: Copy> Structure<'_, M> {
    /// Forwards a message from a block, or delivers it there.
    pub(super) fn forward(
        &mut self,
        at: BlockSlot,
        message: Message,
        environment: &mut impl Environment<Mark = M>,
    ) {
        // The block has gone or failed and cannot forward it.
        let Some(block) = self.slots.get(at).filter(|block| !block.is_dead) else {
            return;
        };
        let (parent, depth) = (block.parent, block.path.depth);
        let goal = match message.target {
            Recipient::Plate
                if parent == BlockSlot::NONE
                    || (!self.has_dead && environment.carry_to_plate(depth)) =>
            {
                return self.hand_over(at, message, environment);
            }
            Recipient::Plate => return self.send_up(at, message, environment),
            Recipient::Block(body) => self.slots.find(&self.index, body),
            Recipient::Role(role) => self.nearest_holder(role),
        };
        let Some(goal) = goal else { return };
        if goal == at {
            return self.hand_over(at, message, environment);
        }
        if goal == parent {
            return self.send_up(at, message, environment);
        }
        match self.ancestor(goal, depth + 1) {
            Some(child)
                if self
                    .slots
                    .get(child)
                    .is_some_and(|child| child.parent == at) =>
            {
                self.send_down(child, message, environment);
            }
            _ if parent != BlockSlot::NONE => self.send_up(at, message, environment),
            _ => {
                let root = self.ancestor(goal, 0).filter(|root| *root != at);
                if let Some(root) = root {
                    self.forward(root, message, environment);
                }
            }
        }
    }

    /// Lets a block ask its parent for its release after a time \[ticks\].
    pub(super) fn ask_later(
        &mut self,
        child: BlockSlot,
        ticks: u32,
        environment: &mut impl Environment<Mark = M>,
    ) {
        let role = self.slots.get(child).map(|block| block.role);
        if let (Some(role), Some((below, above))) = (role, self.contact(child)) {
            let message = Message {
                target: Recipient::Block(above),
                payload: Payload::Ask(role),
            };
            environment.send_later(below, above, message, ticks);
        }
    }

    fn send_up(
        &mut self,
        child: BlockSlot,
        message: Message,
        environment: &mut impl Environment<Mark = M>,
    ) {
        if let Some((below, above)) = self.contact(child) {
            environment.send(below, above, message);
        }
    }

    fn send_down(
        &mut self,
        child: BlockSlot,
        message: Message,
        environment: &mut impl Environment<Mark = M>,
    ) {
        if let Some((below, above)) = self.contact(child) {
            environment.send(above, below, message);
        }
    }

    /// Returns the holder of a role. If the role has no holder, returns the anchored block that is
    /// the nearest ancestor of the future holder.
    fn nearest_holder(&self, mut role: RoleId) -> Option<BlockSlot> {
        // No chain of captures is longer than the list of roles.
        for _ in 0..=self.holders.len() {
            let holder = self.holders[role.0 as usize];
            if holder != BlockSlot::NONE {
                return Some(holder);
            }
            role = self.index.captor(self.tables, self.phase()?, role)?;
        }
        None
    }

    /// Computes the paths of a block and of its ancestors.
    fn find_path(&mut self, slot: BlockSlot) {
        let mut unknown: SmallVec<[_; 16]> = SmallVec::new();
        let mut at = slot;
        while let Some(block) = self.slots.get(at).filter(|block| !block.path.is_known()) {
            unknown.push((at, block.parent));
            at = block.parent;
        }
        for (slot, parent) in unknown.into_iter().rev() {
            let path = self.path_from(parent);
            if let (Some(block), Some(path)) = (self.slots.get_mut(slot), path) {
                block.path = path;
            }
        }
    }

    /// Returns the path of a child of this block. If the parent's last two jumps have equal
    /// lengths, the child jumps over both.
    fn path_from(&self, parent: BlockSlot) -> Option<Path> {
        let Path { depth, jump, after } = self.slots.get(parent)?.path;
        let is_twice = after[0] > after[1] && depth - after[0] == after[0] - after[1];
        let first = self.slots.get(jump).filter(|_| is_twice);
        let (jump, after) = match first.map(|first| first.path) {
            Some(first) => (first.jump, [after[1], first.after[1]]),
            None => (parent, [depth, after[0]]),
        };
        Some(Path {
            depth: depth + 1,
            jump,
            after,
        })
    }

    /// Returns the block at a depth, among `slot` and its ancestors. Returns `None` if `slot` is
    /// not as deep.
    fn ancestor(&mut self, mut slot: BlockSlot, depth: u32) -> Option<BlockSlot> {
        self.find_path(slot);
        loop {
            let block = self.slots.get(slot)?;
            let path = block.path;
            if path.depth <= depth {
                return (path.depth == depth).then_some(slot);
            }
            slot = if path.after[0] >= depth {
                path.jump
            } else {
                block.parent
            };
        }
    }
}
