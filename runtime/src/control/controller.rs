//! Drives a run: the state machines of all blocks, their messages and the record.
use stochc_control::{BlockFace, Body, Docking, Orientation, Structure, StructureBlock};
use stochc_ir::Cell;
use stochc_ir::record::{BondRecord, FaultKind, Outcome, RunRecord, WaitRecord};
use stochc_ir::scene::bond_load::StructureLoads;
use stochc_ir::scene::{Messages, Scene};
use stochc_ir::table::{PhaseId, RoleId, Tables};

use super::hardware::HardwareFaults;
use super::network::Network;
use super::recorder::RunRecorder;
use crate::observe::{Log, ObservedEvent};
use crate::world::World;

/// Executor of event tables in a world.
#[derive(Debug)]
pub struct Controller<'t> {
    pub(super) tables: &'t Tables,
    pub(super) structure: Structure<'t, u64>,
    pub(super) recorder: RunRecorder,
    phase_began: u64,
    /// Tick of the phase's timeout. `None` if it has no timeout.
    phase_ends: Option<u64>,
    /// Tick before which the phase does not end. `None` if it may end.
    phase_waits: Option<u64>,
    phase_ticks: Vec<u64>,
    /// Next start of an aborted phase \[ticks\]. `None` before all its captures are released.
    phase_restarts: Option<u64>,
    /// Reason why the run cannot continue.
    fault: Option<String>,
    /// Hardware faults of the scene. `None` if there are none.
    hardware: Option<HardwareFaults>,
}

stochc_ir::state! {
    () Controller<'_>;
    values: phase_began, phase_ends, phase_waits, phase_ticks, phase_restarts, fault;
    parts: structure, recorder;
    same: tables, hardware
}

impl<'t> Controller<'t> {
    /// Returns a controller for a structure of seeds only, before the first phase.
    ///
    /// `messages` are the scene's message parameters. If they are `None`, messages take no time and
    /// none is lost. `seed` and `run` are the key of every random draw in a run.
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
            phase_waits: None,
            phase_ticks: Vec::new(),
            phase_restarts: None,
            fault: None,
            hardware: None,
        }
    }

    /// Returns a controller like [`Controller::new`], with the messages, the hardware faults and
    /// the breaking bonds of a scene.
    pub fn in_scene(tables: &'t Tables, scene: &Scene, seed: u64, run: u64) -> Controller<'t> {
        let hardware = scene.faults.as_ref();
        let mut controller = Controller {
            hardware: hardware.map(|faults| HardwareFaults::new(faults, seed, run)),
            ..Controller::new(tables, scene.messages.as_ref(), seed, run)
        };
        controller.recorder.loads = StructureLoads::new(scene);
        controller
    }

    /// Starts recording events for [`Controller::take_log`].
    pub(crate) fn keep_log(&mut self) {
        self.recorder.log = Log::recording();
    }

    pub(crate) fn take_log(&mut self) -> Vec<ObservedEvent> {
        self.recorder.log.take()
    }

    /// Attaches the pre-attached blocks, then begins the first phase.
    ///
    /// If the world has too few free blocks, [`Controller::fault`] is set.
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

    /// Returns whether a bond of the structure has broken, and sets [`Controller::fault`] if so.
    fn has_broken(&mut self) -> bool {
        let loads = self.recorder.loads.as_ref();
        let Some((role, load)) = loads.and_then(StructureLoads::broken) else {
            return false;
        };
        let name = self.tables.name(role);
        self.fault = Some(format!("the bond of `{name}` broke under its load: {load}"));
        true
    }

    /// Processes the captures of the world's last step, then the messages that have arrived.
    pub fn advance(&mut self, dockings: &[Docking], world: &mut impl World) {
        self.recorder.tick = world.tick();
        for (i, docking) in dockings.iter().enumerate() {
            self.recorder.has_more = i + 1 < dockings.len();
            if self.is_prevented(docking, world) {
                continue;
            }
            self.structure
                .dock(docking, &mut self.recorder.in_world(world));
        }
        self.settle(world);
    }

    /// Returns whether a hardware fault prevents a capture. A block whose latch fails is released
    /// at once, and the face stays on. A dead block stays until the face is switched off.
    fn is_prevented(&mut self, docking: &Docking, world: &mut impl World) -> bool {
        let Some(hardware) = &mut self.hardware else {
            return false;
        };
        let Some(child) = self.structure.awaited(docking.block_face) else {
            return false;
        };
        let (body, tick) = (docking.child, self.recorder.tick);
        let phases = &self.tables.phases;
        let is_early = |bond: &&BondRecord| phases[bond.phase.0 as usize].pre_attached;
        let mut pre_attached = self.recorder.bonds.iter().take_while(is_early);
        let kind = if hardware.latch_fails(body, tick) {
            world.switch_off(docking.block_face);
            world.magnetize(docking.block_face);
            FaultKind::Latch
        } else if hardware.is_dead(body) && !pre_attached.any(|bond| bond.body == body) {
            FaultKind::Dead
        } else {
            return false;
        };
        self.recorder.note_fault(child, body, kind);
        true
    }

    /// Returns the running phase, or `None` if all are complete.
    pub fn phase(&self) -> Option<PhaseId> {
        self.structure.phase()
    }

    /// Returns whether the running phase has timed out.
    pub fn timed_out(&self) -> bool {
        self.phase_ends.is_some_and(|end| self.recorder.tick >= end)
    }

    /// Returns the next tick that needs the controller: for a message, a timeout, or `max_ticks`.
    #[inline]
    pub(crate) fn next_due(&self, max_ticks: Option<u64>) -> u64 {
        let or_never = |tick: Option<u64>| tick.unwrap_or(u64::MAX);
        or_never(self.phase_ends)
            .min(or_never(self.phase_waits))
            .min(or_never(self.phase_restarts))
            .min(or_never(max_ticks))
            .min(or_never(self.recorder.network.next_due()))
    }

    /// Records that a phase begins. `None` records that the last phase has ended.
    pub(super) fn note_phase(&mut self, phase: Option<PhaseId>) {
        self.phase_began = self.recorder.tick;
        self.start_timers(phase);
        self.recorder.note_phase(phase);
    }

    fn start_timers(&mut self, phase: Option<PhaseId>) {
        let phase = phase.map(|phase| &self.tables.phases[phase.0 as usize]);
        let tick = self.recorder.tick;
        let due = |ticks: u64| tick.saturating_add(ticks);
        self.phase_ends = phase.and_then(|phase| phase.timeout).map(due);
        let wait = phase.map(|phase| phase.wait).filter(|ticks| *ticks > 0);
        self.phase_waits = wait.map(due);
    }

    /// Returns whether the phase has lasted as long as its `wait`.
    fn is_wait_over(&mut self) -> bool {
        let tick = self.recorder.tick;
        // A past tick must not be due again.
        self.phase_waits = self.phase_waits.filter(|end| tick < *end);
        self.phase_waits.is_none()
    }

    /// Returns the reason why the run cannot continue, if there is one.
    pub fn fault(&self) -> Option<&str> {
        self.fault.as_deref()
    }

    /// Returns the duration of each completed phase \[ticks\]. Phases of pre-attached blocks take
    /// 0.
    pub fn phase_ticks(&self) -> &[u64] {
        &self.phase_ticks
    }

    /// Returns every capture so far, in order.
    pub fn bonds(&self) -> &[BondRecord] {
        &self.recorder.bonds
    }

    /// Returns the number of blocks captured so far at faces that expected none.
    pub fn unplanned(&self) -> u64 {
        self.recorder.unplanned.len() as u64
    }

    /// Returns the number of message hops so far.
    pub fn hops(&self) -> u64 {
        self.recorder.network.hops
    }

    /// Returns the block in each role and its orientation, by role.
    pub fn structure(&self) -> impl Iterator<Item = (RoleId, Body, Orientation)> + '_ {
        (0..self.tables.roles.len() as u32).filter_map(|role| {
            let block = self.structure.holder(RoleId(role))?;
            Some((RoleId(role), block.body(), block.orientation()))
        })
    }

    /// Delivers all messages that are due. Begins each phase that can then start. Aborts a phase at
    /// its timeout if it can be retried.
    fn settle(&mut self, world: &mut impl World) {
        loop {
            while let Some((from, at, message)) = self.recorder.due() {
                let mut recorded = self.recorder.in_world(world);
                self.structure.receive(from, at, message, &mut recorded);
            }
            if self.has_broken() {
                return;
            }
            let is_reported = self.structure.is_phase_reported();
            let is_over = self.is_wait_over();
            if self.structure.is_aborting() {
                if !(is_reported && self.retry(world)) {
                    return;
                }
            } else if is_reported && is_over {
                self.next_phase(world);
            } else if self.timed_out() && self.structure.can_abort() {
                self.phase_ends = None;
                self.phase_waits = None;
                let waiting = self.waiting(world);
                self.recorder.note_abort(waiting);
                self.structure.abort(&mut self.recorder.in_world(world));
            } else {
                return;
            }
        }
    }

    /// Begins the aborted phase again, after its pause. Returns whether the pause is over.
    fn retry(&mut self, world: &mut impl World) -> bool {
        let phase = self.structure.phase();
        let recovery = phase.and_then(|phase| self.tables.phases[phase.0 as usize].recovery);
        let pause = recovery.map_or(0, |recovery| recovery.pause);
        let tick = self.recorder.tick;
        let restarts = *(self.phase_restarts).get_or_insert(tick.saturating_add(pause));
        if tick < restarts {
            return false;
        }
        self.phase_restarts = None;
        self.start_timers(phase);
        self.recorder.note_retry();
        self.structure.retry(&mut self.recorder.in_world(world));
        true
    }

    fn next_phase(&mut self, world: &mut impl World) {
        self.phase_ticks.push(self.recorder.tick - self.phase_began);
        let next = self.structure.phase().map(|phase| PhaseId(phase.0 + 1));
        let next = next.filter(|phase| (phase.0 as usize) < self.tables.phases.len());
        self.note_phase(next);
        self.structure
            .next_phase(&mut self.recorder.in_world(world));
    }

    /// Attaches all pre-attached blocks within the current tick. They belong to the first phases.
    fn plant(&mut self, world: &mut impl World) {
        while self.structure.is_planting() {
            while let Some((block_face, child)) = self.structure.next_to_plant() {
                let Some(docking) = world.plant(block_face) else {
                    let name = self.tables.name(child);
                    self.fault = Some(format!("no free block is left to pre-attach as {name}"));
                    return;
                };
                (self.structure).dock(&docking, &mut self.recorder.in_world(world));
            }
            if self.has_broken() {
                return;
            }
            self.next_phase(world);
        }
    }

    /// Returns the open faces, each with the tick when it was switched on.
    fn waiting(&self, world: &impl World) -> Vec<WaitRecord> {
        let Some(phase) = self.phase() else {
            return Vec::new();
        };
        let mut waiting = Vec::new();
        for block in self.structure.blocks() {
            for open in block.open() {
                let block_face = BlockFace {
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
                    entries: world.entries(block_face),
                });
            }
        }
        waiting.sort_by_key(|wait| (wait.magnetized, wait.parent, wait.child));
        waiting
    }

    pub(crate) fn into_record(self, run: u64, outcome: Outcome, world: &impl World) -> RunRecord {
        let waiting = self.waiting(world);
        let mut record = RunRecord {
            run,
            outcome,
            ticks: world.tick(),
            phase_ticks: self.phase_ticks,
            blocks_used: 0,
            hops: self.recorder.network.hops,
            unplanned: self.recorder.unplanned.len() as u64,
            bonds: self.recorder.bonds,
            waiting,
            releases: self.recorder.releases,
            aborts: self.recorder.aborts,
            faults: self.recorder.faults,
            unplanned_bonds: self.recorder.unplanned,
        };
        let bodies = || record.all_bonds().map(|bond| bond.body as usize);
        let mut is_used = vec![false; bodies().max().map_or(0, |last| last + 1)];
        bodies().for_each(|body| is_used[body] = true);
        record.blocks_used = is_used.into_iter().filter(|is_used| *is_used).count() as u32;
        record
    }

    /// Makes an anchored block fail: it no longer acts or forwards messages.
    pub fn kill(&mut self, body: Body) {
        self.structure.kill(body);
    }

    /// Returns the target cell of a role's block. For tools and tests.
    pub fn cell(&self, role: RoleId) -> Option<Cell> {
        match self.structure.holder(role).map(StructureBlock::body)? {
            Body::Seed(cell) => Some(cell),
            Body::Free(id) => (self.recorder.bonds.iter().rev())
                .find(|bond| bond.body == id)
                .map(|bond| bond.cell),
        }
    }
}
