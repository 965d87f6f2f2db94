//! Messages between blocks, hop by hop along parents and children.
//!
//! A block sends to its parent, or to the child on whose branch the receiver is; the plate is one
//! body, so that crossing it is no hop. News for a role that nobody holds yet waits at the block
//! that will capture it: every block has the program, and knows which one that is. A block that is
//! let go leaves what it has heard to the next one in its role.
use std::collections::BTreeMap;

use stochc_compiler::table::{Action, Condition, News, PhaseId, RoleId, Tables};

use super::Controller;
use crate::world::{Body, World};

/// The messages that are under way.
#[derive(Debug)]
pub(super) struct Post {
    /// Ticks per hop.
    hop: u64,
    /// By tick of arrival, then by order of sending.
    under_way: BTreeMap<(u64, u64), (Body, Message)>,
    sent: u64,
    /// Hops so far.
    pub hops: u64,
}

/// A message, wherever it is.
#[derive(Clone, Debug)]
pub(super) struct Message {
    target: Target,
    payload: Payload,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Target {
    /// Any block of the plate.
    Plate,
    /// One block.
    Block(Body),
    /// Whoever holds the role.
    Role(RoleId),
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Payload {
    /// A branch of the phase is done.
    Report,
    /// The child with this role asks to be let go.
    Ask(RoleId),
    /// Something happened elsewhere.
    Tell(News),
}

impl Message {
    /// News for whoever holds a role, or will.
    pub fn tell(to: RoleId, news: News) -> Message {
        Message {
            target: Target::Role(to),
            payload: Payload::Tell(news),
        }
    }
}

impl Post {
    pub fn new(hop: u64) -> Post {
        Post {
            hop,
            under_way: BTreeMap::new(),
            sent: 0,
            hops: 0,
        }
    }

    pub fn clear(&mut self) {
        self.under_way.clear();
    }

    /// Takes the next message that has arrived by `tick`, with where it is.
    pub fn due(&mut self, tick: u64) -> Option<(Body, Message)> {
        let first = self.under_way.first_entry()?;
        (first.key().0 <= tick).then(|| first.remove())
    }

    fn hop(&mut self, tick: u64, to: Body, message: Message) {
        let key = (tick + self.hop, self.sent);
        self.sent += 1;
        self.hops += 1;
        self.under_way.insert(key, (to, message));
    }
}

impl Controller<'_> {
    pub(super) fn send(
        &mut self,
        from: Body,
        target: Target,
        payload: Payload,
        world: &mut impl World,
    ) {
        self.forward(from, Message { target, payload }, world);
    }

    pub(super) fn deliver(&mut self, (at, message): (Body, Message), world: &mut impl World) {
        self.forward(at, message, world);
    }

    /// Moves a message on from a block, or hands it over there.
    pub(super) fn forward(&mut self, at: Body, message: Message, world: &mut impl World) {
        // A block that has drifted away takes the messages it carried with it.
        let Some(block) = self.blocks.get(&at) else {
            return;
        };
        let goal = match message.target {
            Target::Plate => match block.parent {
                None => at,
                Some(parent) => return self.post.hop(self.tick, parent, message),
            },
            Target::Block(body) => body,
            Target::Role(role) => match self.post_box(role) {
                Some(body) => body,
                None => return,
            },
        };
        if goal == at {
            return self.hand_over(at, message, world);
        }
        let Some(branch) = self.branch(at, goal) else {
            return;
        };
        match (branch, block.parent) {
            (Branch::Below(child), _) => self.post.hop(self.tick, child, message),
            (Branch::Elsewhere(_), Some(parent)) => self.post.hop(self.tick, parent, message),
            (Branch::Elsewhere(root), None) => self.forward(root, message, world),
        }
    }

    fn hand_over(&mut self, at: Body, message: Message, world: &mut impl World) {
        let Some(block) = self.blocks.get_mut(&at) else {
            return;
        };
        match (message.payload, message.target) {
            (Payload::Report, _) => self.reports += 1,
            (Payload::Tell(_), Target::Role(role)) if role != block.role => {
                block.waiting.push(message);
            }
            (Payload::Tell(news), _) => {
                block.see(Condition::Heard(news));
                self.fire(at, world);
            }
            (Payload::Ask(child), _) => {
                block.see(Condition::Asked(child));
                self.fire(at, world);
            }
        }
    }

    /// The block that holds a role, or the anchored one that is nearest to capturing it.
    fn post_box(&self, mut role: RoleId) -> Option<Body> {
        // No chain of captures is longer than the list of roles.
        for _ in 0..=self.holders.len() {
            if let Some(body) = self.holders[role.0 as usize] {
                return Some(body);
            }
            role = captor(self.tables, PhaseId(self.phase), role)?;
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
}

/// Where a block is, seen from another one.
enum Branch {
    /// On the branch of this child.
    Below(Body),
    /// Not below; on the tree of this seed.
    Elsewhere(Body),
}

/// The role that captures `child` in `phase`.
fn captor(tables: &Tables, phase: PhaseId, child: RoleId) -> Option<RoleId> {
    tables
        .duties()
        .filter(|duty| duty.phase == phase)
        .find(|duty| {
            duty.rules().any(
                |rule| matches!(rule.then, Action::Magnetize { child: given, .. } if given == child),
            )
        })
        .map(|duty| duty.role)
}
