//! The structure as a machine without time or chance: what every block does when something happens
//! to it.
use std::collections::BTreeMap;

use stochc_ir::table::{Action, Condition, PhaseId, RoleId, Tables, Trigger};

use super::block::{Block, Open};
use super::medium::{Capture, Medium};
use super::message::{Message, Payload, Reporter, Target};
use crate::orientation::Orientation;
use crate::world::{Body, Docking, Site};

/// All anchored blocks and how far they are: a plain value, equal and hashed by what it means.
#[derive(Clone, Debug)]
pub(crate) struct Structure<'t> {
    pub(super) tables: &'t Tables,
    phase: u32,
    /// Reports that the plate has counted in this phase.
    pub(super) reports: u32,
    /// The anchored blocks that have a role.
    pub(super) blocks: BTreeMap<Body, Block>,
    /// Which block has a role now; one entry per role.
    pub(super) holders: Vec<Option<Body>>,
}

impl<'t> Structure<'t> {
    /// Seeds only, before the first phase.
    pub fn new(tables: &'t Tables) -> Structure<'t> {
        let mut holders = vec![None; tables.roles.len()];
        let mut blocks = BTreeMap::new();
        for (role, cell) in tables.seeds() {
            let body = Body::Seed(cell);
            holders[role.0 as usize] = Some(body);
            blocks.insert(body, Block::new(role, Orientation::IDENTITY, None));
        }
        Structure {
            tables,
            phase: 0,
            reports: 0,
            blocks,
            holders,
        }
    }

    /// The phase that is running; `None`: all are complete.
    pub fn phase(&self) -> Option<PhaseId> {
        ((self.phase as usize) < self.tables.phases.len()).then_some(PhaseId(self.phase))
    }

    /// Whether the plate has all the reports that end the running phase.
    pub fn is_phase_reported(&self) -> bool {
        let phase = self.tables.phases.get(self.phase as usize);
        phase.is_some_and(|phase| self.reports >= phase.reports)
    }

    /// Reports that the plate has counted in this phase.
    pub fn reports(&self) -> u32 {
        self.reports
    }

    /// The anchored blocks that have a role.
    pub fn blocks(&self) -> &BTreeMap<Body, Block> {
        &self.blocks
    }

    /// The block that has a role.
    pub fn holder(&self, role: RoleId) -> Option<Body> {
        self.holders[role.0 as usize]
    }

    /// Whether what the running phase captures is attached by hand.
    pub fn is_planting(&self) -> bool {
        let phase = self.tables.phases.get(self.phase as usize);
        phase.is_some_and(|phase| phase.planted)
    }

    /// A face that is on and holds nothing, with the role for what docks there: the next one to attach
    /// a block to.
    pub fn next_open(&self) -> Option<(Site, RoleId)> {
        self.blocks.iter().find_map(|(&body, block)| {
            let open = block.open().first()?;
            let face = open.own;
            Some((Site { body, face }, open.child))
        })
    }

    /// Begins the first phase.
    pub fn start(&mut self, medium: &mut impl Medium) {
        self.begin_phase(medium);
    }

    /// The plate begins the next phase.
    pub fn next_phase(&mut self, medium: &mut impl Medium) {
        self.phase += 1;
        self.begin_phase(medium);
    }

    fn begin_phase(&mut self, medium: &mut impl Medium) {
        self.reports = 0;
        // What was said in a phase is of no use in the next.
        medium.hush();
        for block in self.blocks.values_mut() {
            block.begin(Trigger::Start);
        }
        let anchored: Vec<Body> = self.blocks.keys().copied().collect();
        for body in anchored {
            self.fire(body, medium);
        }
    }

    /// A block has docked.
    pub fn dock(&mut self, docking: &Docking, medium: &mut impl Medium) {
        let Site { body, face } = docking.site;
        let child = Body::Free(docking.child);
        // In the same tick an earlier docking may have had the parent let go; then the world has
        // let the child go too. A dead one feels nothing.
        let Some(parent) = (self.blocks.get_mut(&body)).filter(|parent| !parent.is_dead) else {
            return;
        };
        // A block on a face that is off, or has just been switched off, is shaken off. Where faces
        // always attract, that is what the tables say: *otherwise, reject what docks on any other
        // face*. Nothing has been noted yet, so nothing but the world has changed.
        let Some(open) = parent.close(face) else {
            if self.tables.bond.is_passive() {
                let face = parent.orientation.to_structure(face);
                medium.unplanned(parent.role, face, docking);
            }
            return medium.switch_off(docking.site);
        };
        let orientation =
            Orientation::docked(parent.orientation, face, docking.child_face, docking.turn);
        parent.children.insert(open.child, (docking.child, face));
        parent.see(Condition::Docked(open.child));
        let waiting = parent.take_waiting();
        let capture = Capture {
            phase: PhaseId(self.phase),
            parent: parent.role,
            face: open.face,
            child: open.child,
            cell: open.cell,
        };
        medium.captured(&capture, docking);
        self.holders[open.child.0 as usize] = Some(child);
        let mut block = Block::new(open.child, orientation, Some(body));
        block.begin(Trigger::Anchored);
        self.blocks.insert(child, block);
        for message in waiting {
            self.forward(body, message, medium);
        }
        self.fire(body, medium);
        self.fire(child, medium);
    }

    /// A block dies where it is.
    pub fn kill(&mut self, body: Body) {
        if let Some(block) = self.blocks.get_mut(&body) {
            block.is_dead = true;
        }
    }

    /// A message has made a hop to the block `at`.
    pub fn receive(&mut self, at: Body, message: Message, medium: &mut impl Medium) {
        self.forward(at, message, medium);
    }

    /// Takes a message that is for the block it has come to.
    pub(super) fn hand_over(&mut self, at: Body, message: Message, medium: &mut impl Medium) {
        let Some(block) = self.blocks.get_mut(&at) else {
            return;
        };
        match (message.payload, message.target) {
            (Payload::Report(by), _) => {
                self.reports += 1;
                medium.reported(by);
            }
            (Payload::Tell(_), Target::Role(role)) if role != block.role => block.keep(message),
            (Payload::Tell(news), _) => {
                block.see(Condition::Heard(news));
                self.fire(at, medium);
            }
            (Payload::Ask(child), _) => {
                block.see(Condition::Asked(child));
                self.fire(at, medium);
            }
        }
    }

    /// Fires every rule of a block that is ready, in their order, until none is.
    fn fire(&mut self, body: Body, medium: &mut impl Medium) {
        let phase = PhaseId(self.phase);
        while let Some(block) = self.blocks.get_mut(&body) {
            let Some((rule, action)) = block.next_action(self.tables, phase) else {
                return;
            };
            self.act(body, rule, action, medium);
        }
    }

    fn act(&mut self, body: Body, rule: u32, action: Action, medium: &mut impl Medium) {
        let Some(block) = self.blocks.get_mut(&body) else {
            return;
        };
        let (role, trigger) = (block.role, block.trigger());
        let (target, payload) = match action {
            Action::Magnetize { face, child, cell } => {
                let own = block.orientation.to_own(face);
                let open = Open {
                    own,
                    face,
                    child,
                    cell,
                };
                block.switch_on(open);
                return medium.magnetize(Site { body, face: own }, role, &open);
            }
            Action::SwitchOff { face, child } => {
                let own = block.orientation.to_own(face);
                return self.let_go(body, own, child, medium);
            }
            Action::AskRelease => match block.parent {
                Some(parent) => (Target::Block(parent), Payload::Ask(role)),
                None => return,
            },
            Action::Tell { to, news } => (Target::Role(to), Payload::Tell(news)),
            Action::Report => {
                let by = Reporter {
                    role,
                    trigger,
                    rule,
                };
                (Target::Plate, Payload::Report(by))
            }
        };
        self.forward(body, Message { target, payload }, medium);
    }

    /// Switches the face off that holds a child.
    ///
    /// Before it does, the two settle what is between them: what is under way to either of them,
    /// what waits at the child and what it has heard stays with the parent, for those who take the
    /// roles next.
    fn let_go(
        &mut self,
        body: Body,
        own: stochc_ir::Face,
        child: RoleId,
        medium: &mut impl Medium,
    ) {
        let Some(block) = self.blocks.get_mut(&body) else {
            return;
        };
        let by = block.role;
        block.close(own);
        let gone = block.children.remove(&child);
        block.see(Condition::Released(child));
        medium.switch_off(Site { body, face: own });
        let Some((gone, _)) = gone else { return };
        for message in self.forget(by, gone, medium) {
            self.forward(body, message, medium);
        }
    }

    /// A block, and all that hangs on it, has drifted away; with what it leaves behind.
    fn forget(&mut self, by: RoleId, id: u32, medium: &mut impl Medium) -> Vec<Message> {
        let body = Body::Free(id);
        let Some(block) = self.blocks.remove(&body) else {
            return Vec::new();
        };
        let holder = &mut self.holders[block.role.0 as usize];
        if *holder == Some(body) {
            *holder = None;
        }
        medium.released(by, block.role, body, block.children.len());
        let mut left = block.legacy();
        let recalled = medium.recall(body);
        left.extend(recalled.to);
        // The dead cannot send again what may have been lost.
        left.extend(recalled.from.into_iter().filter(|_| !block.is_dead));
        for (child, _) in block.children.into_values() {
            left.extend(self.forget(block.role, child, medium));
        }
        left
    }
}

impl PartialEq for Structure<'_> {
    fn eq(&self, other: &Structure<'_>) -> bool {
        let key = |s: &Structure<'_>| (s.phase, s.reports);
        key(self) == key(other) && self.blocks == other.blocks && self.holders == other.holders
    }
}

impl Eq for Structure<'_> {}

impl std::hash::Hash for Structure<'_> {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        (self.phase, self.reports).hash(state);
        self.blocks.hash(state);
        self.holders.hash(state);
    }
}
