//! State of one anchored block.
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use stochc_ir::table::{Action, Condition, RoleId, RuleRange, Tables, Trigger};
use stochc_ir::{Cell, Face};

use super::block_slot::BlockSlot;
use super::inline_vec::InlineVec;
use super::message::Message;
use crate::body::Body;
use crate::orientation::Orientation;

/// Length below which a linear search of conditions is faster than a binary one.
const SHORT: usize = 8;

/// Anchored block: role, orientation, neighbours in the tree, and progress.
///
/// Its lists are sorted, so the state does not depend on the order of observations.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StructureBlock<M = ()> {
    pub(super) body: Body,
    pub(super) role: RoleId,
    pub(super) orientation: Orientation,
    pub(super) is_dead: bool,
    /// Whether the block has begun a duty, made an observation or sent a message in this phase.
    pub(super) is_changed: bool,
    trigger: Trigger,
    /// Rules of the current duty. Empty without a duty.
    rules: RuleRange,
    /// Index of the next rule to test. All earlier rules have fired or are not ready after the
    /// latest observation.
    next: u32,
    /// Bit set of fired rules among the first 64 of the duty.
    fired: u64,
    /// Parent of the block, or [`BlockSlot::NONE`] for a seed.
    pub(super) parent: BlockSlot,
    pub(super) path: Path,
    /// Number of messages in transit between the block and its parent.
    pub(super) unreceived: u32,
    /// Children of the block by role.
    children: InlineVec<(RoleId, BlockSlot)>,
    /// Open faces of the block, sorted.
    open: InlineVec<ActiveFace<M>>,
    /// Observations in this phase, sorted.
    seen: SmallVec<[Condition; 2]>,
    cold: Option<Box<ColdState>>,
}

/// Path from a block to the plate, with jump pointers. All fields except the depth are computed on
/// demand.
///
/// # Source
///
/// E. W. Myers, An applicative random-access stack (1983).
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Path {
    /// Number of blocks between this block and the plate.
    pub depth: u32,
    /// Ancestor further up, to skip several parents at once. [`BlockSlot::NONE`] if it is unknown
    /// or if the block is on the plate.
    pub jump: BlockSlot,
    /// Depths of the ancestor `jump` and of the ancestor that `jump` itself jumps to, cached.
    pub after: [u32; 2],
}

impl Path {
    /// Path of a block of the plate.
    const ROOT: Path = Path {
        depth: 0,
        jump: BlockSlot::NONE,
        after: [0, 0],
    };

    /// Returns a path of known depth whose other fields are not computed.
    pub fn unknown(depth: u32) -> Path {
        Path {
            depth,
            ..Path::ROOT
        }
    }

    pub fn is_known(&self) -> bool {
        self.depth == 0 || self.jump != BlockSlot::NONE
    }
}

/// Data that few blocks have.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct ColdState {
    /// Bit set of fired rules after the first 64. Empty if none has fired.
    fired: Vec<u64>,
    /// Messages for future descendants, sorted.
    waiting: Vec<Message>,
}

/// An open face of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct ActiveFace<M = ()> {
    /// The face in the block's own frame.
    pub own: Face,
    /// Open face in the structure's frame.
    pub face: Face,
    /// Role of the expected block.
    pub child: RoleId,
    /// Cell of the expected block.
    pub cell: Cell,
    /// Mark that the [`Environment`](super::Environment) attached to the face.
    pub mark: M,
}

impl<M: Copy> StructureBlock<M> {
    #[inline]
    pub(super) fn new(body: Body, role: RoleId, orientation: Orientation) -> StructureBlock<M> {
        StructureBlock {
            body,
            role,
            orientation,
            is_dead: false,
            is_changed: false,
            trigger: Trigger::Start,
            rules: RuleRange::default(),
            next: 0,
            fired: 0,
            parent: BlockSlot::NONE,
            path: Path::ROOT,
            unreceived: 0,
            children: InlineVec::None,
            open: InlineVec::None,
            seen: SmallVec::new(),
            cold: None,
        }
    }

    pub(super) fn reset(&mut self) {
        self.is_changed = false;
        self.unreceived = 0;
        (self.trigger, self.rules) = (Trigger::Start, RuleRange::default());
        (self.next, self.fired) = (0, 0);
        self.seen.clear();
        self.cold = None;
    }

    /// Ends the duty because the phase is aborted. The block remembers only its captures.
    pub(super) fn stop(&mut self) {
        self.unreceived = 0;
        (self.next, self.fired) = (self.rules.count(), 0);
        let children = std::mem::take(&mut self.seen);
        let docked = |condition: &Condition| matches!(condition, Condition::Docked(_));
        self.seen = children.into_iter().filter(docked).collect();
        self.cold = None;
    }

    /// Forgets a child of an aborted phase after its release.
    pub(super) fn forget(&mut self, child: RoleId) {
        self.seen.retain(|condition| {
            *condition != Condition::Docked(child) && *condition != Condition::Released(child)
        });
        self.next = self.rules.count();
    }

    /// Returns whether the block's duty has captures.
    pub(super) fn captures(&self, tables: &Tables) -> bool {
        self.captured_faces(tables).next().is_some()
    }

    /// Returns the face of the duty's capture of a child, in the structure's frame.
    pub(super) fn face_of(&self, tables: &Tables, child: RoleId) -> Option<Face> {
        let mut captures = self.captured_faces(tables);
        captures.find_map(|(role, face)| (role == child).then_some(face))
    }

    fn captured_faces<'t>(
        &self,
        tables: &'t Tables,
    ) -> impl Iterator<Item = (RoleId, Face)> + use<'t, M> {
        let rules = self.rules;
        (0..rules.count() as usize).filter_map(move |index| match tables.rule(rules, index).then {
            Action::Magnetize { child, face, .. } => Some((child, face)),
            _ => None,
        })
    }

    #[inline]
    pub(super) fn begin(&mut self, trigger: Trigger, rules: RuleRange) {
        (self.trigger, self.rules) = (trigger, rules);
    }

    #[inline]
    pub(super) fn see(&mut self, condition: Condition) {
        let seen = self.seen.as_slice();
        let at = match seen.last() {
            Some(last) if *last >= condition => match seen.binary_search(&condition) {
                Ok(_) => return,
                Err(at) => at,
            },
            _ => seen.len(),
        };
        self.seen.insert(at, condition);
        self.next = self.first_unfired();
    }

    /// Keeps a message for a future descendant.
    pub(super) fn keep(&mut self, message: Message) {
        let waiting = &mut self.cold.get_or_insert_default().waiting;
        let i = waiting.partition_point(|other| *other <= message);
        waiting.insert(i, message);
    }

    /// Removes and returns all kept messages.
    pub(super) fn take_waiting(&mut self) -> Vec<Message> {
        let cold = self.cold.as_mut();
        cold.map_or_else(Vec::new, |cold| std::mem::take(&mut cold.waiting))
    }

    /// Returns the messages to pass on when the block is released. They are received notifications,
    /// addressed to the next holder of the block's role, and kept messages. Returns none if the
    /// block has failed.
    pub(super) fn legacy(&self) -> impl Iterator<Item = Message> {
        let notifications = self.seen().iter().filter_map(|&condition| match condition {
            Condition::Notified(notification) => Some(Message::notify(self.role, notification)),
            _ => None,
        });
        let all = notifications.chain(self.waiting().iter().copied());
        all.filter(|_| !self.is_dead)
    }

    /// Adds an open face.
    #[inline]
    pub(super) fn switch_on(&mut self, open: ActiveFace<M>) {
        let key = |open: &ActiveFace<M>| (open.own, open.face, open.child, open.cell);
        let i = (self.open()).partition_point(|other| key(other) <= key(&open));
        self.open.insert(i, open);
    }

    /// Removes an open face. Returns `None` if the face is not open.
    #[inline]
    pub(super) fn close(&mut self, own: Face) -> Option<ActiveFace<M>> {
        let i = self.open().iter().position(|open| open.own == own)?;
        self.open.remove(i)
    }

    /// Adds a child.
    #[inline]
    pub(super) fn hold(&mut self, child: RoleId, slot: BlockSlot) {
        let i = self.children().partition_point(|(role, _)| *role <= child);
        self.children.insert(i, (child, slot));
    }

    /// Removes a child. Returns `None` if there is no such child.
    pub(super) fn release(&mut self, child: RoleId) -> Option<BlockSlot> {
        let i = (self.children())
            .iter()
            .rposition(|(role, _)| *role == child)?;
        self.children.remove(i).map(|(_, slot)| slot)
    }

    /// Returns whether a rule may be ready. Failed blocks do not act.
    #[inline]
    pub(super) fn may_act(&self) -> bool {
        !self.is_dead && self.next < self.rules.count()
    }

    /// Returns the next ready rule, by its index in the duty, and marks it as fired. Requires that
    /// the block [may act](Self::may_act). Returns `None` if no rule is ready.
    #[inline(always)]
    pub(super) fn next_action(&mut self, tables: &Tables) -> Option<(u32, Action)> {
        let first = self.next as usize;
        let rule = tables.rule(self.rules, first);
        // Fast path: most rules tried by a new block have no condition.
        let is_first = rule.when.is_empty() && !self.has_fired(first);
        let (index, action) = if is_first {
            (first, rule.then)
        } else {
            self.next_ready(tables)?
        };
        self.mark_fired(index);
        Some((index as u32, action))
    }

    /// Marks the first rule of the duty as fired. Returns `false` if the rule has fired before or
    /// the block has failed.
    #[inline]
    pub(super) fn take_first(&mut self) -> bool {
        let is_left = !self.is_dead && !self.has_fired(0);
        if is_left {
            self.mark_fired(0);
        }
        is_left
    }

    #[inline]
    fn mark_fired(&mut self, index: usize) {
        match index / 64 {
            0 => {
                self.fired |= 1 << index;
                // Skips the following rules that have already fired.
                self.next = index as u32 + (self.fired >> index).trailing_ones();
            }
            word => {
                self.next = index as u32 + 1;
                self.mark_fired_later(word - 1, index % 64);
            }
        }
    }

    fn mark_fired_later(&mut self, word: usize, bit: usize) {
        let fired = &mut self.cold.get_or_insert_default().fired;
        fired.resize(self.rules.count() as usize / 64, 0);
        fired[word] |= 1 << bit;
    }

    #[inline(always)]
    fn has_seen(&self, what: Condition) -> bool {
        let seen = self.seen();
        match seen.len() {
            0..SHORT => seen.contains(&what),
            _ => seen.binary_search(&what).is_ok(),
        }
    }

    /// Returns the next ready rule. Returns `None` if no rule is ready before the next observation.
    fn next_ready(&mut self, tables: &Tables) -> Option<(usize, Action)> {
        let count = self.rules.count();
        let has = |when| self.has_seen(when);
        for index in self.next as usize..count as usize {
            if self.has_fired(index) {
                continue;
            }
            let rule = tables.rule(self.rules, index);
            let is_true = |when: &Condition| tables.is_true(self.rules, index, *when, has);
            if rule.when.iter().all(is_true) {
                return Some((index, rule.then));
            }
        }
        self.next = count;
        None
    }
}

impl<M> StructureBlock<M> {
    /// Returns the physical block.
    pub fn body(&self) -> Body {
        self.body
    }

    /// Returns the role of the block.
    pub fn role(&self) -> RoleId {
        self.role
    }

    /// Returns the orientation that the block assumes. It may be wrong after a fault.
    pub fn orientation(&self) -> Orientation {
        self.orientation
    }

    /// Returns whether the block has failed. A failed block does not act, does not forward messages
    /// and loses its state.
    pub(crate) fn is_dead(&self) -> bool {
        self.is_dead
    }

    /// Returns the open faces, sorted.
    pub fn open(&self) -> &[ActiveFace<M>] {
        self.open.as_slice()
    }

    /// Returns the observations in this phase, sorted.
    pub fn seen(&self) -> &[Condition] {
        self.seen.as_slice()
    }

    pub(super) fn children(&self) -> &[(RoleId, BlockSlot)] {
        self.children.as_slice()
    }

    /// Returns the messages kept for future descendants, sorted.
    pub fn waiting(&self) -> &[Message] {
        self.cold.as_ref().map_or(&[], |cold| &cold.waiting)
    }

    /// Returns the trigger of the block's duty.
    pub fn trigger(&self) -> Trigger {
        self.trigger
    }

    #[inline]
    pub(crate) fn has_fired(&self, rule: usize) -> bool {
        let word = match rule / 64 {
            0 => self.fired,
            word => self.fired_later().get(word - 1).copied().unwrap_or(0),
        };
        word & (1 << (rule % 64)) != 0
    }

    #[inline]
    fn first_unfired(&self) -> u32 {
        let mut count = self.fired.trailing_ones();
        if count == u64::BITS {
            for word in self.fired_later() {
                count += word.trailing_ones();
                if *word != u64::MAX {
                    break;
                }
            }
        }
        count
    }

    fn fired_later(&self) -> &[u64] {
        self.cold.as_ref().map_or(&[], |cold| &cold.fired)
    }

    /// Returns the bit sets of fired rules.
    pub(super) fn fired(&self) -> (u64, &[u64]) {
        (self.fired, self.fired_later())
    }
}
