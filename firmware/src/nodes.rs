//! Tree of parents in each phase, as the compiler knows it.
use std::collections::{BTreeMap, BTreeSet};

use stochc_ir::table::{Action, Condition, Notification, PhaseId, RoleId, Tables, Trigger};

/// A block of one phase, by its role and trigger. A block that was attached at the start differs
/// from a block that is captured during the phase. A phase has at most one of each per role.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Node {
    /// Role of the block.
    pub role: RoleId,
    /// Start of the block's duty.
    pub trigger: Trigger,
}

/// Captures of all roles, and the receivers of notifications.
#[derive(Debug)]
pub struct Nodes {
    /// For each role, its captures by phase, with the capturing block.
    captures: Vec<Vec<(PhaseId, Node)>>,
    /// Blocks that wait for a notification, by phase, role and notification.
    receivers: BTreeMap<(PhaseId, RoleId, Notification), BTreeSet<Node>>,
    /// Number of captures in the pre-attached phase. It is the first phase.
    pre_attached: usize,
}

impl Node {
    /// Returns the number of the node in an image.
    pub fn number(self) -> u16 {
        let anchored = u16::from(self.trigger == Trigger::Anchored);
        (self.role.0 as u16) | (anchored << 15)
    }
}

impl Nodes {
    pub fn new(tables: &Tables) -> Nodes {
        let mut captures = vec![Vec::new(); tables.roles.len()];
        let mut receivers: BTreeMap<_, BTreeSet<Node>> = BTreeMap::new();
        let mut pre_attached = 0;
        for duty in tables.duties() {
            let node = Node {
                role: duty.role,
                trigger: duty.trigger,
            };
            for rule in duty.rules() {
                if let Action::Magnetize { child, .. } = rule.then {
                    captures[child.0 as usize].push((duty.phase, node));
                    let phase = &tables.phases[duty.phase.0 as usize];
                    pre_attached += usize::from(phase.pre_attached);
                }
                for when in rule.when {
                    if let Condition::Notified(notification) = *when {
                        let key = (duty.phase, duty.role, notification);
                        receivers.entry(key).or_default().insert(node);
                    }
                }
            }
        }
        for of_role in &mut captures {
            of_role.sort_unstable();
        }
        Nodes {
            captures,
            receivers,
            pre_attached,
        }
    }

    /// Returns the captures of a role, by phase.
    pub fn captures(&self, role: RoleId) -> &[(PhaseId, Node)] {
        &self.captures[role.0 as usize]
    }

    /// Returns the number of pre-attached blocks of a phase.
    pub fn pre_attached(&self, phase: u32) -> usize {
        if phase == 0 { self.pre_attached } else { 0 }
    }

    /// Returns whether a node is pre-attached in a phase.
    pub fn is_pre_attached(&self, phase: PhaseId, role: RoleId) -> bool {
        self.pre_attached > 0
            && phase.0 == 0
            && (self.captures(role).first()).is_some_and(|&(first, _)| first == phase)
    }

    /// Returns the blocks that wait for a notification.
    pub fn receivers(
        &self,
        phase: PhaseId,
        to: RoleId,
        notification: Notification,
    ) -> impl Iterator<Item = Node> {
        let all = self.receivers.get(&(phase, to, notification));
        all.into_iter().flatten().copied()
    }

    /// Returns the parent of a node in a phase. Returns `None` for a seed.
    pub fn parent(&self, phase: PhaseId, node: Node) -> Option<Node> {
        let captures = self.captures(node.role);
        match node.trigger {
            Trigger::Anchored => {
                let (_, parent) = captures.iter().find(|(when, _)| *when == phase)?;
                Some(*parent)
            }
            Trigger::Start => {
                let (_, parent) = captures.iter().rfind(|(when, _)| *when < phase)?;
                Some(Node {
                    trigger: Trigger::Start,
                    ..*parent
                })
            }
        }
    }

    /// Returns the blocks that may keep a notification. They will capture an ancestor of the
    /// receiver, or the receiver itself.
    pub fn waiting_places(&self, phase: PhaseId, to: Node) -> Vec<Node> {
        let mut places = Vec::new();
        let mut at = to;
        // Stored tables may be circular.
        for _ in 0..self.captures.len() {
            let Some(parent) = self.parent(phase, at) else {
                break;
            };
            if at.trigger == Trigger::Anchored {
                places.push(parent);
            }
            at = parent;
        }
        places
    }
}
