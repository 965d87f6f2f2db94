//! How messages find their way: hop by hop along parents and children.
//!
//! A block sends to its parent, or to the child on whose branch the receiver is; the plate is one
//! body, so that crossing it is no hop. News for a role that nobody holds yet waits at the block
//! that will capture it: every block has the program, and knows which one that is. A block that is
//! let go leaves what it has heard to the next one in its role.
use stochc_ir::table::{Action, RoleId};

use super::medium::Medium;
use super::message::{Message, Target};
use super::structure::Structure;
use crate::world::Body;

impl Structure<'_> {
    /// Moves a message on from a block, or hands it over there.
    pub(super) fn forward(&mut self, at: Body, message: Message, medium: &mut impl Medium) {
        // Nobody is there any more to pass it on.
        let Some(block) = self.blocks.get(&at).filter(|block| !block.is_dead) else {
            return;
        };
        let goal = match message.target {
            Target::Plate => match block.parent {
                None => at,
                Some(parent) => return medium.send(at, parent, message),
            },
            Target::Block(body) => body,
            Target::Role(role) => match self.post_box(role) {
                Some(body) => body,
                None => return,
            },
        };
        if goal == at {
            return self.hand_over(at, message, medium);
        }
        let Some(branch) = self.branch(at, goal) else {
            return;
        };
        match (branch, block.parent) {
            (Branch::Below(child), _) => medium.send(at, child, message),
            (Branch::Elsewhere(_), Some(parent)) => medium.send(at, parent, message),
            (Branch::Elsewhere(root), None) => self.forward(root, message, medium),
        }
    }

    /// The block that holds a role, or the anchored one that is nearest to capturing it.
    fn post_box(&self, mut role: RoleId) -> Option<Body> {
        // No chain of captures is longer than the list of roles.
        for _ in 0..=self.holders.len() {
            if let Some(body) = self.holders[role.0 as usize] {
                return Some(body);
            }
            role = self.captor(role)?;
        }
        None
    }

    /// Where `goal` is, seen from `at`; `None`: it is not part of the structure.
    fn branch(&self, at: Body, goal: Body) -> Option<Branch> {
        let mut here = goal;
        loop {
            match self.blocks.get(&here)?.parent {
                None => return Some(Branch::Elsewhere(here)),
                Some(parent) if parent == at => return Some(Branch::Below(here)),
                Some(parent) => here = parent,
            }
        }
    }

    /// The role that captures `child` in the running phase.
    fn captor(&self, child: RoleId) -> Option<RoleId> {
        let phase = self.phase()?;
        (self.tables.duties())
            .filter(|duty| duty.phase == phase)
            .find(|duty| {
                duty.rules().any(
                    |rule| matches!(rule.then, Action::Magnetize { child: given, .. } if given == child),
                )
            })
            .map(|duty| duty.role)
    }
}

/// Where a block is, seen from another one.
enum Branch {
    /// On the branch of this child.
    Below(Body),
    /// Not below; on the tree of this seed.
    Elsewhere(Body),
}
