//! The distributed control: every anchored block runs its own part of the event tables.
//!
//! A block sees only itself: what docked on its faces and what it was told. What crosses from one
//! block to another crosses as a message, hop by hop along parents and children. Nothing here
//! knows how blocks move; any [`World`] will do.
//!
//! Times are boundaries between steps of the world: tick t is when t steps have been made. A phase
//! whose last report arrives at tick t ends at t, and what the next one switches on acts from the
//! very next step on. That a phase begins is told to all blocks at once and is not counted.
mod block;
mod post;

use std::collections::BTreeMap;

use stochc_compiler::Cell;
use stochc_compiler::scene::Messages;
use stochc_compiler::table::{Action, Condition, PhaseId, RoleId, Tables, Trigger};

use crate::orientation::Orientation;
use crate::record::{BondRecord, Origin};
use crate::world::{Body, Docking, Site, World};
use block::{Block, Open};
use post::{Message, Payload, Post, Target};

/// Runs event tables in a world.
#[derive(Debug)]
pub struct Controller<'t> {
    tables: &'t Tables,
    tick: u64,
    phase: u32,
    phase_began: u64,
    reports: u32,
    /// The anchored blocks that have a role.
    blocks: BTreeMap<Body, Block>,
    /// Which block has a role now; one entry per role.
    holders: Vec<Option<Body>>,
    post: Post,
    /// Where released blocks come from.
    released: BTreeMap<u32, Origin>,
    phase_ticks: Vec<u64>,
    bonds: Vec<BondRecord>,
}

impl<'t> Controller<'t> {
    /// A structure of seeds only, before the first phase.
    ///
    /// `messages` is what the scene says that they cost; `None`: nothing.
    pub fn new(tables: &'t Tables, messages: Option<&Messages>) -> Controller<'t> {
        let mut holders = vec![None; tables.roles.len()];
        let mut blocks = BTreeMap::new();
        for (role, cell) in tables.seeds() {
            let body = Body::Seed(cell);
            holders[role.0 as usize] = Some(body);
            blocks.insert(body, Block::new(role, Orientation::IDENTITY, None));
        }
        Controller {
            tables,
            tick: 0,
            phase: 0,
            phase_began: 0,
            reports: 0,
            blocks,
            holders,
            post: Post::new(messages.map_or(0, |messages| u64::from(messages.hop))),
            released: BTreeMap::new(),
            phase_ticks: Vec::new(),
            bonds: Vec::new(),
        }
    }

    /// Begins the first phase.
    pub fn start(&mut self, world: &mut impl World) {
        self.tick = world.tick();
        self.begin_phase(world);
        self.settle(world);
    }

    /// Takes in what docked in the world's last step, and does all that this tick brings.
    pub fn advance(&mut self, dockings: &[Docking], world: &mut impl World) {
        self.tick = world.tick();
        for docking in dockings {
            self.dock(docking, world);
        }
        self.settle(world);
    }

    /// The phase that is running; `None`: all are complete.
    pub fn phase(&self) -> Option<PhaseId> {
        ((self.phase as usize) < self.tables.phases.len()).then_some(PhaseId(self.phase))
    }

    /// Whether the running phase has used up its time.
    pub fn timed_out(&self) -> bool {
        let timeout = self
            .phase()
            .and_then(|phase| self.tables.phases[phase.0 as usize].timeout);
        timeout.is_some_and(|timeout| self.tick - self.phase_began >= timeout)
    }

    /// Ticks that each completed phase took.
    pub fn phase_ticks(&self) -> &[u64] {
        &self.phase_ticks
    }

    /// Every capture so far, in the order of docking.
    pub fn bonds(&self) -> &[BondRecord] {
        &self.bonds
    }

    /// Hops that messages have made so far.
    pub fn hops(&self) -> u64 {
        self.post.hops
    }

    /// Where each role is held now, as (role, block, orientation), by role.
    pub fn structure(&self) -> impl Iterator<Item = (RoleId, Body, Orientation)> + '_ {
        self.holders.iter().enumerate().filter_map(|(role, body)| {
            let body = (*body)?;
            Some((RoleId(role as u32), body, self.blocks[&body].orientation))
        })
    }

    /// Delivers all messages that are due, and moves on to the phases that are.
    fn settle(&mut self, world: &mut impl World) {
        loop {
            while let Some(message) = self.post.due(self.tick) {
                self.deliver(message, world);
            }
            let Some(phase) = self.phase() else { return };
            if self.reports < self.tables.phases[phase.0 as usize].reports {
                return;
            }
            self.phase_ticks.push(self.tick - self.phase_began);
            self.phase += 1;
            self.begin_phase(world);
        }
    }

    fn begin_phase(&mut self, world: &mut impl World) {
        self.phase_began = self.tick;
        self.reports = 0;
        // What was said in a phase is of no use in the next.
        self.post.clear();
        for block in self.blocks.values_mut() {
            block.begin(Trigger::Start);
        }
        let anchored: Vec<Body> = self.blocks.keys().copied().collect();
        for body in anchored {
            self.fire(body, world);
        }
    }

    fn dock(&mut self, docking: &Docking, world: &mut impl World) {
        let Site { body, face } = docking.site;
        let child = Body::Free(docking.child);
        // In the same tick an earlier docking may have had the parent let go, or the face switched
        // off; then the world has let the child go too.
        let Some(parent) = self.blocks.get_mut(&body) else {
            return;
        };
        let Some(open) = parent.close(face) else {
            return;
        };
        let orientation =
            Orientation::docked(parent.orientation, face, docking.child_face, docking.turn);
        parent.children.insert(open.child, (docking.child, face));
        parent.see(Condition::Docked(open.child));
        let waiting = std::mem::take(&mut parent.waiting);
        self.bonds.push(BondRecord {
            phase: PhaseId(self.phase),
            parent: parent.role,
            face: open.face,
            child: open.child,
            cell: open.cell,
            magnetized: open.since,
            docked: self.tick,
            entries: docking.entries,
            docking: self.tick - docking.entered,
            body: docking.child,
            origin: self
                .released
                .get(&docking.child)
                .cloned()
                .unwrap_or(Origin::Free),
        });
        self.holders[open.child.0 as usize] = Some(child);
        let mut block = Block::new(open.child, orientation, Some(body));
        block.begin(Trigger::Anchored);
        self.blocks.insert(child, block);
        for message in waiting {
            self.forward(body, message, world);
        }
        self.fire(body, world);
        self.fire(child, world);
    }

    /// Fires every rule of a block that is ready, in their order, until none is.
    fn fire(&mut self, body: Body, world: &mut impl World) {
        let phase = PhaseId(self.phase);
        while let Some(block) = self.blocks.get_mut(&body) {
            let Some(action) = block.next_action(self.tables, phase) else {
                return;
            };
            self.act(body, action, world);
        }
    }

    fn act(&mut self, body: Body, action: Action, world: &mut impl World) {
        let Some(block) = self.blocks.get_mut(&body) else {
            return;
        };
        match action {
            Action::Magnetize { face, child, cell } => {
                let own = block.orientation.to_own(face);
                block.open.push(Open {
                    own,
                    face,
                    child,
                    cell,
                    since: self.tick,
                });
                world.magnetize(Site { body, face: own });
            }
            Action::SwitchOff { face, child } => {
                let own = block.orientation.to_own(face);
                block.close(own);
                let gone = block.children.remove(&child);
                block.see(Condition::Released(child));
                world.switch_off(Site { body, face: own });
                if let Some((gone, _)) = gone {
                    for message in self.forget(gone) {
                        self.forward(body, message, world);
                    }
                }
            }
            Action::AskRelease => {
                let payload = Payload::Ask(block.role);
                if let Some(parent) = block.parent {
                    self.send(body, Target::Block(parent), payload, world);
                }
            }
            Action::Tell { to, news } => {
                self.send(body, Target::Role(to), Payload::Tell(news), world);
            }
            Action::Report => self.send(body, Target::Plate, Payload::Report, world),
        }
    }

    /// A block, and all that hangs on it, has drifted away.
    ///
    /// What is left behind is the news that it had heard, for those who take the roles next.
    fn forget(&mut self, id: u32) -> Vec<Message> {
        let body = Body::Free(id);
        let Some(block) = self.blocks.remove(&body) else {
            return Vec::new();
        };
        let holder = &mut self.holders[block.role.0 as usize];
        if *holder == Some(body) {
            *holder = None;
        }
        let origin = Origin::Released {
            role: block.role,
            tick: self.tick,
        };
        self.released.insert(id, origin);
        let mut left = block.legacy();
        for (child, _) in block.children.into_values() {
            left.extend(self.forget(child));
        }
        left
    }

    /// Everything that is kept, once the run has ended.
    pub(crate) fn into_parts(self) -> (Vec<u64>, u64, Vec<BondRecord>) {
        (self.phase_ticks, self.post.hops, self.bonds)
    }

    /// The cell that a role's block is meant to sit in, for tools and tests.
    pub fn cell(&self, role: RoleId) -> Option<Cell> {
        match self.holders[role.0 as usize]? {
            Body::Seed(cell) => Some(cell),
            Body::Free(id) => self
                .bonds
                .iter()
                .rev()
                .find(|bond| bond.body == id)
                .map(|bond| bond.cell),
        }
    }
}
