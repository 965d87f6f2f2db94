//! What one anchored block keeps in mind.
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use stochc_ir::table::{Action, Condition, RoleId, RuleRange, Tables, Trigger};
use stochc_ir::{Cell, Face};

use super::block_slot::BlockSlot;
use super::inline_vec::InlineVec;
use super::message::Message;
use crate::body::Body;
use crate::orientation::Orientation;

/// A list with fewer conditions is faster gone through than searched.
const SHORT: usize = 8;

/// An anchored block: its name, how it sits, its neighbours in the tree, and its progress.
///
/// Its lists are sorted: what a block knows does not depend on the order in which it came to know.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StructureBlock<M = ()> {
    pub(super) body: Body,
    pub(super) role: RoleId,
    pub(super) orientation: Orientation,
    pub(super) is_dead: bool,
    /// It has begun a duty, seen or sent something in this phase.
    pub(super) is_changed: bool,
    trigger: Trigger,
    /// Those of its duty; without one none.
    rules: RuleRange,
    /// All rules before this one have fired, or are not ready with what it has seen.
    next: u32,
    /// The rules of its duty that have fired, one bit each, but for those behind the first 64.
    fired: u64,
    /// The block that captured it; that of nobody for a seed.
    pub(super) parent: BlockSlot,
    pub(super) path: Path,
    /// Hops between it and its parent that have been sent and not been received.
    pub(super) unreceived: u32,
    /// The blocks that it holds, by role.
    children: InlineVec<(RoleId, BlockSlot)>,
    /// The faces that it has on and that hold nothing yet, sorted.
    open: InlineVec<ActiveFace<M>>,
    /// What it has seen in this phase, sorted.
    seen: SmallVec<[Condition; 2]>,
    cold: Option<Box<ColdState>>,
}

/// The way from a block to the plate, to find others by (E. W. Myers 1983). All but the depth is for those who look for
/// somebody, and unknown until then.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Path {
    /// Blocks between it and the plate.
    pub depth: u32,
    /// One of those; [`BlockSlot::NONE`]: unknown, or on the plate.
    pub jump: BlockSlot,
    /// The depth of that one, and of the one to which that one jumps: so nobody has to look at them.
    pub after: [u32; 2],
}

impl Path {
    /// That of a block of the plate.
    const ROOT: Path = Path {
        depth: 0,
        jump: BlockSlot::NONE,
        after: [0, 0],
    };

    /// That of a block so far from the plate, which nobody has looked for yet.
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

/// What few blocks have.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct ColdState {
    /// The rules that have fired of those behind the first 64, one bit each; none: none has.
    fired: Vec<u64>,
    /// Messages for blocks that will hang on it, sorted.
    waiting: Vec<Message>,
}

/// A face that is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct ActiveFace<M = ()> {
    /// In the block's own frame.
    pub own: Face,
    /// The same face in the structure's frame.
    pub face: Face,
    /// The role for the block that docks there.
    pub child: RoleId,
    /// Where that block will sit.
    pub cell: Cell,
    /// What the [`Environment`](super::Environment) notes of it.
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

    /// Waits for a phase, with nothing done and nothing seen.
    pub(super) fn reset(&mut self) {
        self.is_changed = false;
        self.unreceived = 0;
        (self.trigger, self.rules) = (Trigger::Start, RuleRange::default());
        (self.next, self.fired) = (0, 0);
        self.seen.clear();
        self.cold = None;
    }

    /// Begins a duty, of which it has done nothing yet.
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

    /// Keeps a message for a block that will hang on it.
    pub(super) fn keep(&mut self, message: Message) {
        let waiting = &mut self.cold.get_or_insert_default().waiting;
        let i = waiting.partition_point(|other| *other <= message);
        waiting.insert(i, message);
    }

    /// Takes out all that waits.
    pub(super) fn take_waiting(&mut self) -> Vec<Message> {
        let cold = self.cold.as_mut();
        cold.map_or_else(Vec::new, |cold| std::mem::take(&mut cold.waiting))
    }

    /// What it has heard and what waits at it, as messages to whoever has the role next.
    pub(super) fn legacy(&self) -> impl Iterator<Item = Message> {
        let heard = self.seen().iter().filter_map(|&condition| match condition {
            Condition::Heard(news) => Some(Message::tell(self.role, news)),
            _ => None,
        });
        let all = heard.chain(self.waiting().iter().copied());
        all.filter(|_| !self.is_dead)
    }

    /// Adds a face to those that are on.
    #[inline]
    pub(super) fn switch_on(&mut self, open: ActiveFace<M>) {
        let key = |open: &ActiveFace<M>| (open.own, open.face, open.child, open.cell);
        let i = (self.open()).partition_point(|other| key(other) <= key(&open));
        self.open.insert(i, open);
    }

    /// Takes a face from those that are on.
    #[inline]
    pub(super) fn close(&mut self, own: Face) -> Option<ActiveFace<M>> {
        let i = self.open().iter().position(|open| open.own == own)?;
        self.open.remove(i)
    }

    /// Adds a block to those that it holds.
    #[inline]
    pub(super) fn hold(&mut self, child: RoleId, slot: BlockSlot) {
        let i = self.children().partition_point(|(role, _)| *role <= child);
        self.children.insert(i, (child, slot));
    }

    /// Takes a block from those that it holds.
    pub(super) fn release(&mut self, child: RoleId) -> Option<BlockSlot> {
        let i = (self.children())
            .iter()
            .rposition(|(role, _)| *role == child)?;
        self.children.remove(i).map(|(_, slot)| slot)
    }

    /// Whether a rule may be ready; a dead block does nothing.
    #[inline]
    pub(super) fn may_act(&self) -> bool {
        !self.is_dead && self.next < self.rules.count()
    }

    /// The next rule that is ready, by its place in the duty; it counts as fired from now on. It has to be one that
    /// [may act](Self::may_act).
    #[inline(always)]
    pub(super) fn next_action(&mut self, tables: &Tables) -> Option<(u32, Action)> {
        let first = self.next as usize;
        let rule = tables.rule(self.rules, first);
        // As most rules are that a new block tries.
        let is_first = rule.when.is_empty() && !self.has_fired(first);
        let (place, action) = if is_first {
            (first, rule.then)
        } else {
            self.next_ready(tables)?
        };
        self.mark_fired(place);
        Some((place as u32, action))
    }

    /// Takes the first rule of its duty, unless it has fired.
    #[inline]
    pub(super) fn take_first(&mut self) -> bool {
        let is_left = !self.is_dead && !self.has_fired(0);
        if is_left {
            self.mark_fired(0);
        }
        is_left
    }

    #[inline]
    fn mark_fired(&mut self, place: usize) {
        match place / 64 {
            0 => {
                self.fired |= 1 << place;
                // Those that have fired right after it are not asked again.
                self.next = place as u32 + (self.fired >> place).trailing_ones();
            }
            word => {
                self.next = place as u32 + 1;
                self.mark_fired_later(word - 1, place % 64);
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

    /// The first rule from the next one on that is ready; without one there will be none until the block sees something.
    fn next_ready(&mut self, tables: &Tables) -> Option<(usize, Action)> {
        let count = self.rules.count();
        let has = |when| self.has_seen(when);
        for place in self.next as usize..count as usize {
            if self.has_fired(place) {
                continue;
            }
            let rule = tables.rule(self.rules, place);
            let is_true = |when: &Condition| tables.is_true(self.rules, place, *when, has);
            if rule.when.iter().all(is_true) {
                return Some((place, rule.then));
            }
        }
        self.next = count;
        None
    }
}

impl<M> StructureBlock<M> {
    /// Which it is.
    pub fn body(&self) -> Body {
        self.body
    }

    /// The name that it has.
    pub fn role(&self) -> RoleId {
        self.role
    }

    /// How it believes to sit.
    pub fn orientation(&self) -> Orientation {
        self.orientation
    }

    /// Whether it neither acts nor passes anything on any more; what it knew is lost.
    pub(crate) fn is_dead(&self) -> bool {
        self.is_dead
    }

    /// The faces that are on and hold nothing, sorted.
    pub fn open(&self) -> &[ActiveFace<M>] {
        self.open.as_slice()
    }

    /// What it has seen in this phase, sorted.
    pub fn seen(&self) -> &[Condition] {
        self.seen.as_slice()
    }

    /// The blocks that it holds, by role.
    pub(super) fn children(&self) -> &[(RoleId, BlockSlot)] {
        self.children.as_slice()
    }

    /// The messages that wait at it for blocks that will hang on it, sorted.
    pub fn waiting(&self) -> &[Message] {
        self.cold.as_ref().map_or(&[], |cold| &cold.waiting)
    }

    /// When its duty began.
    pub fn trigger(&self) -> Trigger {
        self.trigger
    }

    /// Whether a rule of its duty has fired.
    #[inline]
    pub(crate) fn has_fired(&self, rule: usize) -> bool {
        let word = match rule / 64 {
            0 => self.fired,
            word => self.fired_later().get(word - 1).copied().unwrap_or(0),
        };
        word & (1 << (rule % 64)) != 0
    }

    /// The rules before the first that has not fired.
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

    /// All rules that have fired, one bit each.
    pub(super) fn fired(&self) -> (u64, &[u64]) {
        (self.fired, self.fired_later())
    }
}
