//! The structure as a state machine without time or chance: how every block reacts to events.
use std::collections::BTreeSet;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use serde::Serialize;
use serde::de::DeserializeOwned;
use smallvec::{SmallVec, smallvec};
use stochc_ir::Face;
use stochc_ir::table::{Action, Condition, PhaseId, RoleId, Tables, Trigger};

use super::block::{ActiveFace, Path, StructureBlock};
use super::block_slot::BlockSlot;
use super::environment::{Environment, PlannedCapture};
use super::index::Index;
use super::message::{Message, Payload, Recipient, Reporter};
use super::slots::Slots;
use crate::body::{BlockFace, Body, Docking};
use crate::orientation::Orientation;

/// State of all anchored blocks. Equality and hash depend only on the represented state, not on its
/// storage.
///
/// The work for an event hardly depends on the size of the structure. A message costs the work of
/// one hop. A capture or release costs work for the blocks involved, and a new phase for the blocks
/// with duties in it.
#[derive(Clone, Debug)]
pub struct Structure<'t, M = ()> {
    pub(super) tables: &'t Tables,
    pub(super) index: Arc<Index>,
    phase: u32,
    /// Number of reports at the plate in this phase.
    reports: u32,
    /// Anchored blocks with a role.
    pub(super) slots: Slots<M>,
    /// Holder of each role.
    pub(super) holders: Vec<BlockSlot>,
    /// Blocks changed since the start of the phase. Some have been released.
    changed: Vec<BlockSlot>,
    /// Faces that still need pre-attached blocks.
    to_plant: BTreeSet<BlockFace>,
    pub(super) has_dead: bool,
    /// Number of aborted attempts of the running phase.
    aborts: u32,
    /// Whether the running phase is aborted and its captures are being released.
    pub(super) is_aborting: bool,
}

stochc_ir::state! {
    (<M: DeserializeOwned + Serialize>) Structure<'_, M>;
    values: phase, reports, slots, holders, changed, to_plant, has_dead, aborts, is_aborting;
    parts: ;
    same: tables, index
}

impl<'t, M: Copy> Structure<'t, M> {
    /// Returns a structure of seeds only, before the first phase.
    pub fn new(tables: &'t Tables) -> Structure<'t, M> {
        let mut seeds: Vec<_> = tables.seeds().map(|(role, cell)| (cell, role)).collect();
        seeds.sort_unstable();
        let mut holders = vec![BlockSlot::NONE; tables.roles.len()];
        for (slot, (_, role)) in (0..).map(BlockSlot).zip(&seeds) {
            holders[role.0 as usize] = slot;
        }
        let cells: Vec<_> = seeds.iter().map(|(cell, _)| *cell).collect();
        let others = tables.roles.len() - seeds.len();
        let blocks = seeds
            .into_iter()
            .map(|(cell, role)| StructureBlock::new(Body::Seed(cell), role, Orientation::IDENTITY));
        Structure {
            tables,
            index: Arc::new(Index::new(tables, &cells)),
            phase: 0,
            reports: 0,
            slots: Slots::new(blocks, others),
            holders,
            changed: Vec::new(),
            to_plant: BTreeSet::new(),
            has_dead: false,
            aborts: 0,
            is_aborting: false,
        }
    }

    /// Returns the running phase, or `None` if all are complete.
    pub fn phase(&self) -> Option<PhaseId> {
        ((self.phase as usize) < self.tables.phases.len()).then_some(PhaseId(self.phase))
    }

    /// Returns whether the plate has all the reports that end the running phase, or its abort.
    pub fn is_phase_reported(&self) -> bool {
        let phase = self.tables.phases.get(self.phase as usize);
        phase.is_some_and(|phase| {
            let recovery = phase.recovery.filter(|_| self.is_aborting);
            self.reports >= recovery.map_or(phase.reports, |recovery| recovery.reports)
        })
    }

    /// Returns the number of reports at the plate in this phase.
    pub fn reports(&self) -> u32 {
        self.reports
    }

    /// Iterates over the anchored blocks with a role, in the order of their bodies.
    pub fn blocks(&self) -> impl Iterator<Item = &StructureBlock<M>> {
        self.slots.iter()
    }

    /// Returns the number of anchored blocks with a role.
    pub fn count(&self) -> usize {
        self.slots.count()
    }

    /// Returns an anchored block. Returns `None` if the block is not anchored.
    pub fn block(&self, body: Body) -> Option<&StructureBlock<M>> {
        self.slots.get(self.slots.find(&self.index, body)?)
    }

    /// Returns the block that has a role. Returns `None` if the role is free.
    pub fn holder(&self, role: RoleId) -> Option<&StructureBlock<M>> {
        self.slots.get(self.holders[role.0 as usize])
    }

    /// Returns the parent of a block, or `None` for a block of the plate.
    pub fn parent(&self, block: &StructureBlock<M>) -> Option<&StructureBlock<M>> {
        self.slots.get(block.parent)
    }

    /// Returns whether the running phase consists of pre-attached blocks.
    pub fn is_planting(&self) -> bool {
        let phase = self.tables.phases.get(self.phase as usize);
        phase.is_some_and(|phase| phase.pre_attached)
    }

    /// Removes the next face that needs a pre-attached block. Returns it with the block's role.
    /// Returns `None` if no face is left.
    pub fn next_to_plant(&mut self) -> Option<(BlockFace, RoleId)> {
        let block_face = self.to_plant.pop_first()?;
        let open = self.block(block_face.body)?.open();
        let child = open.iter().find(|open| open.own == block_face.face)?.child;
        Some((block_face, child))
    }

    /// Begins the first phase.
    pub fn start(&mut self, environment: &mut impl Environment<Mark = M>) {
        self.begin_phase(environment);
    }

    /// Begins the next phase.
    pub fn next_phase(&mut self, environment: &mut impl Environment<Mark = M>) {
        self.phase += 1;
        self.aborts = 0;
        self.begin_phase(environment);
    }

    /// Returns whether the plate may abort the running phase.
    pub fn can_abort(&self) -> bool {
        let phase = self.tables.phases.get(self.phase as usize);
        let recovery = phase.and_then(|phase| phase.recovery);
        !self.is_aborting && recovery.is_some_and(|recovery| self.aborts < recovery.retries)
    }

    /// Returns whether the running phase is aborted and its captures are being released.
    pub fn is_aborting(&self) -> bool {
        self.is_aborting
    }

    /// Returns the number of aborted attempts of the running phase.
    pub fn aborts(&self) -> u32 {
        self.aborts
    }

    /// Aborts the running phase. All blocks learn it at once, as they learn the start of a phase.
    /// Requires that the plate [may abort](Self::can_abort) the phase.
    pub fn abort(&mut self, environment: &mut impl Environment<Mark = M>) {
        self.reports = 0;
        self.aborts += 1;
        self.is_aborting = true;
        environment.clear_messages();
        let mut changed = self.changed.clone();
        changed.retain(|slot| self.slots.get(*slot).is_some());
        self.slots.sort(&mut changed);
        for &slot in &changed {
            // A failed block does not react.
            let Some(block) = self.slots.get_mut(slot).filter(|block| !block.is_dead) else {
                continue;
            };
            block.stop();
            while let Some(open) = block.open().first().copied() {
                block.close(open.own);
                environment.switch_off(BlockFace {
                    body: block.body,
                    face: open.own,
                });
            }
        }
        for slot in changed {
            self.retreat(slot, environment);
        }
    }

    /// Begins the aborted phase again. Requires that the phase [is
    /// reported](Self::is_phase_reported).
    pub fn retry(&mut self, environment: &mut impl Environment<Mark = M>) {
        self.begin_phase(environment);
    }

    fn begin_phase(&mut self, environment: &mut impl Environment<Mark = M>) {
        self.reports = 0;
        self.is_aborting = false;
        // Messages are valid only within their phase.
        environment.clear_messages();
        for slot in std::mem::take(&mut self.changed) {
            if let Some(block) = self.slots.get_mut(slot) {
                block.reset();
            }
        }
        let Some(phase) = self.phase() else { return };
        let mut starting = Vec::new();
        for duty in self.index.starting(phase) {
            let duty = self.tables.duty_at(*duty as usize);
            let slot = self.holders[duty.role.0 as usize];
            if let Some(block) = self.slots.get_mut(slot) {
                block.begin(Trigger::Start, duty.range());
                block.is_changed = true;
                starting.push(slot);
            }
        }
        self.slots.sort(&mut starting);
        self.changed.extend_from_slice(&starting);
        for slot in starting {
            self.fire(slot, environment);
        }
    }

    /// Returns the role of the block that a face waits for. Returns `None` if the face waits for
    /// none.
    pub fn awaited(&self, block_face: BlockFace) -> Option<RoleId> {
        let block = self.block(block_face.body)?;
        let mut open = block.open().iter();
        open.find(|open| open.own == block_face.face)
            .map(|open| open.child)
    }

    /// Processes the capture of a block: it has docked and acknowledged its role.
    ///
    /// A docked block that has not acknowledged its role has no part in the structure. Its face
    /// stays open, so an abort switches the face off and releases the block.
    pub fn dock(&mut self, docking: &Docking, environment: &mut impl Environment<Mark = M>) {
        let BlockFace { body, face } = docking.block_face;
        // An earlier capture in the same tick may have released the parent, and with it this block.
        // A failed parent does not react.
        let Some(at) = self.slots.find(&self.index, body) else {
            return;
        };
        let Some(parent) = self.slots.get_mut(at).filter(|parent| !parent.is_dead) else {
            return;
        };
        // A block at a face that is off, or was just switched off, is rejected. For faces that
        // always attract, the tables state this: *otherwise, reject*. Nothing has been recorded
        // yet, so only the world has changed.
        let Some(open) = parent.close(face) else {
            if self.tables.bond.is_passive() {
                let face = parent.orientation.to_structure(face);
                environment.unplanned(parent.role, face, docking);
            }
            return environment.switch_off(docking.block_face);
        };
        let orientation =
            Orientation::docked(parent.orientation, face, docking.child_face, docking.turn);
        let child = self.slots.reserve(docking.child);
        let Some(parent) = self.slots.get_mut(at) else {
            return;
        };
        parent.see(Condition::Docked(open.child));
        parent.hold(open.child, child);
        if !parent.is_changed {
            parent.is_changed = true;
            self.changed.push(at);
        }
        let wakes = parent.may_act();
        let waiting = parent.take_waiting();
        let depth = parent.path.depth + 1;
        let phase = PhaseId(self.phase);
        let capture = PlannedCapture {
            phase,
            parent: parent.role,
            face: open.face,
            child: open.child,
            cell: open.cell,
        };
        environment.captured(&capture, docking, open.mark);
        let mut block = StructureBlock::new(Body::Free(docking.child), open.child, orientation);
        block.parent = at;
        block.path = Path::unknown(depth);
        block.is_changed = true;
        let begins = (self.index).beginning(self.tables, open.child, phase, Trigger::Anchored);
        block.begin(Trigger::Anchored, begins.rules);
        self.slots.put(child, block);
        self.changed.push(child);
        self.holders[open.child.0 as usize] = child;
        for message in waiting {
            self.forward(at, message, environment);
        }
        if wakes {
            self.fire(at, environment);
        }
        if let Some(action) = begins.at_once
            && (self.slots.get_mut(child)).is_some_and(StructureBlock::take_first)
        {
            self.act(child, 0, action, environment);
        }
        self.fire(child, environment);
    }

    /// Makes a block fail.
    pub fn kill(&mut self, body: Body) {
        let slot = self.slots.find(&self.index, body);
        if let Some(block) = slot.and_then(|slot| self.slots.get_mut(slot)) {
            block.is_dead = true;
            self.has_dead = true;
        }
    }

    /// Processes the arrival of a message at `at` after a hop from its neighbour `from`.
    pub fn receive(
        &mut self,
        from: Body,
        at: Body,
        message: Message,
        environment: &mut impl Environment<Mark = M>,
    ) {
        let find = |body| self.slots.find(&self.index, body);
        let (Some(from), Some(at)) = (find(from), find(at)) else {
            return;
        };
        let is_up = self.slots.get(from).is_some_and(|from| from.parent == at);
        let below = if is_up { from } else { at };
        if let Some(below) = self.slots.get_mut(below) {
            below.unreceived = below.unreceived.saturating_sub(1);
        }
        self.forward(at, message, environment);
    }

    /// Returns the two ends of the contact between a block and its parent, and counts a message on
    /// this contact. Returns `None` for a block of the plate.
    pub(super) fn contact(&mut self, child: BlockSlot) -> Option<(Body, Body)> {
        let parent = self.slots.get(child)?.parent;
        let above = self.slots.get(parent)?.body;
        self.change(child, |child| {
            child.unreceived += 1;
            (child.body, above)
        })
    }

    /// Changes a block and records that it has changed in this phase. Returns `None` if the slot is
    /// empty.
    fn change<R>(
        &mut self,
        slot: BlockSlot,
        change: impl FnOnce(&mut StructureBlock<M>) -> R,
    ) -> Option<R> {
        let block = self.slots.get_mut(slot)?;
        if !block.is_changed {
            block.is_changed = true;
            self.changed.push(slot);
        }
        Some(change(block))
    }

    /// Delivers a message to its recipient.
    pub(super) fn hand_over(
        &mut self,
        at: BlockSlot,
        message: Message,
        environment: &mut impl Environment<Mark = M>,
    ) {
        let seen = match (message.payload, message.target) {
            (Payload::Report(by), _) => {
                self.reports += 1;
                return environment.reported(by);
            }
            (Payload::Notify(notification), Recipient::Role(role)) => {
                if self.slots.get(at).is_some_and(|block| block.role != role) {
                    self.change(at, |block| block.keep(message));
                    return;
                }
                Condition::Notified(notification)
            }
            (Payload::Notify(notification), _) => Condition::Notified(notification),
            (Payload::Ask(child), _) if self.is_aborting => {
                return self.withdraw(at, child, environment);
            }
            (Payload::Ask(child), _) => Condition::Asked(child),
        };
        self.change(at, |block| block.see(seen));
        self.fire(at, environment);
    }

    /// Fires all ready rules of a block in order, until none is ready.
    fn fire(&mut self, at: BlockSlot, environment: &mut impl Environment<Mark = M>) {
        while let Some(block) = self.slots.get_mut(at).filter(|block| block.may_act()) {
            let Some((rule, action)) = block.next_action(self.tables) else {
                return;
            };
            self.act(at, rule, action, environment);
        }
    }

    #[inline]
    fn act(
        &mut self,
        at: BlockSlot,
        rule: u32,
        action: Action,
        environment: &mut impl Environment<Mark = M>,
    ) {
        let Some(block) = self.slots.get_mut(at) else {
            return;
        };
        match action {
            Action::Magnetize { face, child, cell } => {
                let capture = PlannedCapture {
                    phase: PhaseId(self.phase),
                    parent: block.role,
                    face,
                    child,
                    cell,
                };
                let block_face = magnetize(block, &capture, environment);
                if self.is_planting() {
                    self.to_plant.insert(block_face);
                }
            }
            Action::SwitchOff { face, child } => {
                let own = block.orientation.to_own(face);
                self.release_block(at, own, child, environment);
            }
            action => self.send_message(at, rule, action, environment),
        }
    }

    fn send_message(
        &mut self,
        at: BlockSlot,
        rule: u32,
        action: Action,
        environment: &mut impl Environment<Mark = M>,
    ) {
        let Some(block) = self.slots.get(at) else {
            return;
        };
        let role = block.role;
        let (target, payload) = match action {
            Action::AskReleaseLater(ticks) => {
                return self.ask_later(at, ticks, environment);
            }
            Action::AskRelease => match self.slots.get(block.parent) {
                Some(parent) => (Recipient::Block(parent.body), Payload::Ask(role)),
                None => return,
            },
            Action::Notify { to, notification } => {
                (Recipient::Role(to), Payload::Notify(notification))
            }
            Action::Report => {
                let by = Reporter {
                    role,
                    trigger: block.trigger(),
                    rule,
                };
                (Recipient::Plate, Payload::Report(by))
            }
            Action::Magnetize { .. } | Action::SwitchOff { .. } => return,
        };
        self.forward(at, Message { target, payload }, environment);
    }

    /// Releases a child by switching off the parent's face.
    ///
    /// Before that, the parent takes over all messages in transit between the two blocks. It also
    /// takes over the messages that the child has received or kept. It keeps all of them for the
    /// next holders of their roles.
    pub(super) fn release_block(
        &mut self,
        at: BlockSlot,
        own: Face,
        child: RoleId,
        environment: &mut impl Environment<Mark = M>,
    ) {
        let released = self.change(at, |block| {
            block.close(own);
            block.see(Condition::Released(child));
            (block.body, block.role, block.release(child))
        });
        let Some((body, by, left_slot)) = released else {
            return;
        };
        environment.switch_off(BlockFace { body, face: own });
        let Some(left_slot) = left_slot else { return };
        for message in self.forget(by, left_slot, environment) {
            self.forward(at, message, environment);
        }
    }

    /// Removes a released block and all its descendants. Their messages remain at the parent.
    fn forget(
        &mut self,
        by: RoleId,
        left_slot: BlockSlot,
        environment: &mut impl Environment<Mark = M>,
    ) -> Vec<Message> {
        let mut left = Vec::new();
        let mut going: SmallVec<[_; 4]> = smallvec![(by, left_slot)];
        while let Some((by, slot)) = going.pop() {
            let Some(block) = self.slots.get(slot) else {
                continue;
            };
            let holder = &mut self.holders[block.role.0 as usize];
            if *holder == slot {
                *holder = BlockSlot::NONE;
            }
            environment.released(by, block.role, block.body, block.children().len());
            left.extend(block.legacy());
            let below = block
                .children()
                .iter()
                .filter_map(|(_, child)| self.slots.get(*child));
            let unreceived = block.unreceived + below.map(|child| child.unreceived).sum::<u32>();
            let recalled = environment.recall(block.body, unreceived);
            left.extend(recalled.to);
            // Failed blocks cannot resend messages that may have been lost.
            left.extend(recalled.from.into_iter().filter(|_| !block.is_dead));
            going.extend(
                block
                    .children()
                    .iter()
                    .rev()
                    .map(|(_, child)| (block.role, *child)),
            );
            self.slots.remove(slot);
        }
        left
    }

    /// Returns the state of the plate, for comparison.
    fn stage(&self) -> (u32, u32, u32, bool) {
        (self.phase, self.reports, self.aborts, self.is_aborting)
    }

    /// Returns the content of the state for comparison: the body, role, orientation, parent,
    /// failure and progress of each block.
    fn meaning(&self) -> impl Iterator<Item = impl Hash + Eq>
    where
        M: Hash + Eq,
    {
        self.blocks().map(|block| {
            let parent = self.parent(block).map(StructureBlock::body);
            let is = (
                block.body,
                block.role,
                block.orientation,
                parent,
                block.is_dead,
            );
            let did = (block.trigger(), block.fired());
            (is, did, block.open(), block.seen(), block.waiting())
        })
    }
}

/// Switches on a face of a block and returns it.
#[inline]
fn magnetize<M: Copy>(
    block: &mut StructureBlock<M>,
    capture: &PlannedCapture,
    environment: &mut impl Environment<Mark = M>,
) -> BlockFace {
    let own = block.orientation.to_own(capture.face);
    let block_face = BlockFace {
        body: block.body,
        face: own,
    };
    let mark = environment.magnetize(block_face, capture);
    block.switch_on(ActiveFace {
        own,
        face: capture.face,
        child: capture.child,
        cell: capture.cell,
        mark,
    });
    block_face
}

impl<M: Copy + Hash + Eq> PartialEq for Structure<'_, M> {
    fn eq(&self, other: &Structure<'_, M>) -> bool {
        self.stage() == other.stage() && self.meaning().eq(other.meaning())
    }
}

impl<M: Copy + Hash + Eq> Eq for Structure<'_, M> {}

impl<M: Copy + Hash + Eq> Hash for Structure<'_, M> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.stage().hash(state);
        for block in self.meaning() {
            block.hash(state);
        }
    }
}
