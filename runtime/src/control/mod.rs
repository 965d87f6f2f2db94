//! The distributed control: every anchored block runs its own part of the event tables.
//!
//! A block sees only itself: what docked on its faces and what it was told. What crosses from one
//! block to another crosses as a message, hop by hop along parents and children. Nothing here
//! knows how blocks move; any [`World`] will do.
//!
//! [`Structure`] is the machine itself, without time and chance. The [`Controller`] drives it by the clock of a
//! world; [`stochc_protocol::explore`] drives the same machine through every order.
//!
//! Times are boundaries between steps of the world: tick t is when t steps have been made. A phase
//! whose last report arrives at tick t ends at t, and what the next one switches on acts from the
//! very next step on. That a phase begins is told to all blocks at once and is not counted.
mod network;
mod recorder;

use network::Network;
use recorder::RunRecorder;
use stochc_ir::Cell;
use stochc_ir::record::{BondRecord, Outcome, RunRecord, WaitRecord};
use stochc_ir::scene::Messages;
use stochc_ir::table::{PhaseId, RoleId, Tables};
use stochc_protocol::{BlockFace, Body, Docking, Orientation, Structure, StructureBlock};

use crate::observe::{Log, ObservedEvent};
use crate::world::World;

/// Runs event tables in a world.
#[derive(Debug)]
pub struct Controller<'t> {
    tables: &'t Tables,
    structure: Structure<'t, u64>,
    recorder: RunRecorder,
    phase_began: u64,
    /// When its time is over; `None`: never.
    phase_ends: Option<u64>,
    phase_ticks: Vec<u64>,
    /// Why the run cannot go on.
    fault: Option<String>,
}

stochc_ir::state! {
    () Controller<'_>;
    values: phase_began, phase_ends, phase_ticks, fault;
    parts: structure, recorder;
    same: tables
}

impl<'t> Controller<'t> {
    /// A structure of seeds only, before the first phase.
    ///
    /// `messages` is what the scene says of them; `None`: they cost nothing, and none is lost.
    /// `seed` and `run` are the key of all chance in a run.
    pub fn new(
        tables: &'t Tables,
        messages: Option<&Messages>,
        seed: u64,
        run: u64,
    ) -> Controller<'t> {
        Controller {
            tables,
            structure: Structure::new(tables),
            recorder: RunRecorder::new(Network::new(messages, seed, run), tables),
            phase_began: 0,
            phase_ends: None,
            phase_ticks: Vec::new(),
            fault: None,
        }
    }

    /// Writes down from now on what happens, for [`Controller::take_log`].
    pub(crate) fn keep_log(&mut self) {
        self.recorder.log = Log::kept();
    }

    /// Takes out what has happened since the last time.
    pub(crate) fn take_log(&mut self) -> Vec<ObservedEvent> {
        self.recorder.log.take()
    }

    /// Attaches what is planted by hand, and begins the first phase after that.
    ///
    /// A world without enough free blocks for it leaves a [`Controller::fault`].
    pub fn start(&mut self, world: &mut impl World) {
        self.recorder.tick = world.tick();
        let seeds: Vec<Cell> = self.tables.seeds().map(|(_, cell)| cell).collect();
        world.place_seeds(&seeds);
        self.note_phase(self.structure.phase());
        self.structure.start(&mut self.recorder.in_world(world));
        self.plant(world);
        if self.fault.is_none() {
            self.settle(world);
        }
    }

    /// Takes in what docked in the world's last step, and does all that this tick brings.
    pub fn advance(&mut self, dockings: &[Docking], world: &mut impl World) {
        self.recorder.tick = world.tick();
        for (i, docking) in dockings.iter().enumerate() {
            self.recorder.has_more = i + 1 < dockings.len();
            self.structure
                .dock(docking, &mut self.recorder.in_world(world));
        }
        self.settle(world);
    }

    /// The phase that is running; `None`: all are complete.
    pub fn phase(&self) -> Option<PhaseId> {
        self.structure.phase()
    }

    /// Whether the running phase has used up its time.
    pub fn timed_out(&self) -> bool {
        self.phase_ends.is_some_and(|end| self.recorder.tick >= end)
    }

    /// The first tick at which something is due, whatever the world does: a message, the end of the time of the phase, or
    /// `max_ticks`.
    #[inline]
    pub(crate) fn next_due(&self, max_ticks: Option<u64>) -> u64 {
        let or_never = |tick: Option<u64>| tick.unwrap_or(u64::MAX);
        or_never(self.phase_ends)
            .min(or_never(max_ticks))
            .min(or_never(self.recorder.network.next_due()))
    }

    /// A phase begins, if there is one left.
    fn note_phase(&mut self, phase: Option<PhaseId>) {
        self.phase_began = self.recorder.tick;
        let timeout = phase.and_then(|phase| self.tables.phases[phase.0 as usize].timeout);
        self.phase_ends = timeout.map(|ticks| self.phase_began.saturating_add(ticks));
        self.recorder.note_phase(phase);
    }

    /// Why the run cannot go on, if so.
    pub fn fault(&self) -> Option<&str> {
        self.fault.as_deref()
    }

    /// Ticks that each completed phase took; 0 for a planted one.
    pub fn phase_ticks(&self) -> &[u64] {
        &self.phase_ticks
    }

    /// Every capture so far, in the order of docking.
    pub fn bonds(&self) -> &[BondRecord] {
        &self.recorder.bonds
    }

    /// Blocks so far that docked where nobody expected them.
    pub fn unplanned(&self) -> u64 {
        self.recorder.unplanned.len() as u64
    }

    /// Hops that messages have made so far.
    pub fn hops(&self) -> u64 {
        self.recorder.network.hops
    }

    /// Where each role is held now, as (role, block, orientation), by role.
    pub fn structure(&self) -> impl Iterator<Item = (RoleId, Body, Orientation)> + '_ {
        (0..self.tables.roles.len() as u32).filter_map(|role| {
            let block = self.structure.holder(RoleId(role))?;
            Some((RoleId(role), block.body(), block.orientation()))
        })
    }

    /// Delivers all messages that are due, and moves on to the phases that are.
    fn settle(&mut self, world: &mut impl World) {
        loop {
            while let Some((from, at, message)) = self.recorder.due() {
                let mut recorded = self.recorder.in_world(world);
                self.structure.receive(from, at, message, &mut recorded);
            }
            if !self.structure.is_phase_reported() {
                return;
            }
            self.next_phase(world);
        }
    }

    fn next_phase(&mut self, world: &mut impl World) {
        self.phase_ticks.push(self.recorder.tick - self.phase_began);
        let next = self.structure.phase().map(|phase| PhaseId(phase.0 + 1));
        let next = next.filter(|phase| (phase.0 as usize) < self.tables.phases.len());
        self.note_phase(next);
        self.structure
            .next_phase(&mut self.recorder.in_world(world));
    }

    /// Attaches by hand what the planted phases at the beginning capture, in this very tick.
    fn plant(&mut self, world: &mut impl World) {
        while self.structure.is_planting() {
            while let Some((site, child)) = self.structure.next_to_plant() {
                let Some(docking) = world.plant(site) else {
                    let name = self.tables.name(child);
                    self.fault = Some(format!("no free block is left to attach as {name}"));
                    return;
                };
                (self.structure).dock(&docking, &mut self.recorder.in_world(world));
            }
            self.next_phase(world);
        }
    }

    /// The faces that are on and hold nothing, by the tick since when.
    fn waiting(&self, world: &impl World) -> Vec<WaitRecord> {
        let Some(phase) = self.phase() else {
            return Vec::new();
        };
        let mut waiting = Vec::new();
        for block in self.structure.blocks() {
            for open in block.open() {
                let site = BlockFace {
                    body: block.body(),
                    face: open.own,
                };
                waiting.push(WaitRecord {
                    phase,
                    parent: block.role(),
                    face: open.face,
                    child: open.child,
                    cell: open.cell,
                    magnetized: open.mark,
                    entries: world.entries(site),
                });
            }
        }
        waiting.sort_by_key(|wait| (wait.magnetized, wait.parent, wait.child));
        waiting
    }

    /// Everything that is kept, once the run has ended in this world.
    pub(crate) fn into_record(self, run: u64, outcome: Outcome, world: &impl World) -> RunRecord {
        let waiting = self.waiting(world);
        let bonds = self.recorder.bonds;
        let most = bonds.iter().map(|bond| bond.body as usize + 1).max();
        let mut is_used = vec![false; most.unwrap_or(0)];
        for bond in &bonds {
            is_used[bond.body as usize] = true;
        }
        RunRecord {
            run,
            outcome,
            ticks: world.tick(),
            phase_ticks: self.phase_ticks,
            blocks_used: is_used.into_iter().filter(|is_used| *is_used).count() as u32,
            hops: self.recorder.network.hops,
            unplanned: self.recorder.unplanned.len() as u64,
            bonds,
            waiting,
            releases: self.recorder.releases,
            unplanned_bonds: self.recorder.unplanned,
        }
    }

    /// A block dies where it is anchored: from now on it neither acts nor passes anything on.
    pub fn kill(&mut self, body: Body) {
        self.structure.kill(body);
    }

    /// The cell that a role's block is meant to sit in, for tools and tests.
    pub fn cell(&self, role: RoleId) -> Option<Cell> {
        match self.structure.holder(role).map(StructureBlock::body)? {
            Body::Seed(cell) => Some(cell),
            Body::Free(id) => (self.recorder.bonds.iter().rev())
                .find(|bond| bond.body == id)
                .map(|bond| bond.cell),
        }
    }
}
