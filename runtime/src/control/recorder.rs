//! Recorder of a run: clock, messages, and events with their times.
use rustc_hash::{FxBuildHasher, FxHashMap};
use stochc_control::{
    BlockFace, Body, Docking, Environment, Message, PlannedCapture, Recalled, Reporter,
};
use stochc_ir::Face;
use stochc_ir::record::{
    AbortRecord, BondRecord, FaultKind, FaultRecord, Origin, ReleaseRecord, UnplannedRecord,
    WaitRecord,
};
use stochc_ir::scene::bond_load::StructureLoads;
use stochc_ir::table::{PhaseId, RoleId, Tables};

use super::network::Network;
use crate::observe::{Log, ObservedEvent};
use crate::world::World;

/// State of a run apart from its structure: clock, messages in transit, and the record so far.
#[derive(Debug)]
pub(super) struct RunRecorder {
    pub tick: u64,
    /// Running phase, or the last phase if all phases are complete.
    phase: PhaseId,
    pub network: Network,
    /// Whether captures of this tick remain to be processed.
    pub has_more: bool,
    /// Origin of each released block: its former role and the tick of its release.
    released: FxHashMap<u32, Origin>,
    pub bonds: Vec<BondRecord>,
    /// Number of captures before the running phase.
    earlier_bonds: usize,
    /// Start of the running attempt at the phase \[ticks\].
    attempt_began: u64,
    pub aborts: Vec<AbortRecord>,
    pub releases: Vec<ReleaseRecord>,
    /// Blocks captured at faces that expected none.
    pub unplanned: Vec<UnplannedRecord>,
    /// Captures that a hardware fault prevented.
    pub faults: Vec<FaultRecord>,
    /// Loads of the structure's bonds. `None` if bonds do not break.
    pub loads: Option<StructureLoads>,
    pub log: Log,
}

stochc_ir::state! {
    () RunRecorder;
    values: tick, phase, released, bonds, earlier_bonds, attempt_began, aborts, releases, unplanned,
        faults;
    parts: network, loads;
    // Not part of the state: both have their initial values between ticks.
    same: log, has_more
}

impl RunRecorder {
    pub fn new(network: Network, tables: &Tables) -> RunRecorder {
        let releases = tables.releases();
        RunRecorder {
            tick: 0,
            phase: PhaseId(0),
            network,
            has_more: false,
            released: FxHashMap::with_capacity_and_hasher(releases, FxBuildHasher),
            bonds: Vec::with_capacity(tables.captures()),
            earlier_bonds: 0,
            attempt_began: 0,
            aborts: Vec::new(),
            releases: Vec::with_capacity(releases),
            unplanned: Vec::new(),
            faults: Vec::new(),
            loads: None,
            log: Log::default(),
        }
    }

    /// Removes the next message that has arrived. Returns its last sender, its receiver and the
    /// message.
    #[inline]
    pub fn due(&mut self) -> Option<(Body, Body, Message)> {
        self.network.due(self.tick, &mut self.log)
    }

    /// Records that a phase begins, or with `None` that the last one has ended.
    pub fn note_phase(&mut self, phase: Option<PhaseId>) {
        if let Some(phase) = phase {
            self.phase = phase;
            self.earlier_bonds = self.bonds.len();
            self.attempt_began = self.tick;
            self.log.note(|| ObservedEvent::Phase(phase));
        }
    }

    /// Records that the running phase is aborted. `waiting` are its open faces.
    pub fn note_abort(&mut self, waiting: Vec<WaitRecord>) {
        self.aborts.push(AbortRecord {
            phase: self.phase,
            began: self.attempt_began,
            tick: self.tick,
            retried: None,
            bonds: self.bonds.split_off(self.earlier_bonds),
            waiting,
            releases: Vec::new(),
        });
    }

    /// Records that the aborted phase begins again.
    pub fn note_retry(&mut self) {
        if let Some(abort) = self.aborts.last_mut() {
            abort.retried = Some(self.tick);
        }
        self.note_phase(Some(self.phase));
    }

    /// Records that a hardware fault has prevented a capture.
    pub fn note_fault(&mut self, child: RoleId, body: u32, kind: FaultKind) {
        self.faults.push(FaultRecord {
            phase: self.phase,
            child,
            tick: self.tick,
            body,
            kind,
        });
    }

    /// Returns the list of releases of the running attempt.
    fn releases(&mut self) -> &mut Vec<ReleaseRecord> {
        match self.aborts.last_mut() {
            Some(abort) if abort.retried.is_none() => &mut abort.releases,
            _ => &mut self.releases,
        }
    }

    /// Returns an environment that passes calls to `world` and records them.
    pub fn in_world<'a, W: World>(&'a mut self, world: &'a mut W) -> RecordedWorld<'a, W> {
        RecordedWorld {
            recorder: self,
            world,
        }
    }
}

/// Environment that carries out the structure's decisions in a world and records them.
pub(super) struct RecordedWorld<'a, W> {
    recorder: &'a mut RunRecorder,
    world: &'a mut W,
}

impl<W: World> Environment for RecordedWorld<'_, W> {
    /// Tick when a face was switched on.
    type Mark = u64;

    fn magnetize(&mut self, block_face: BlockFace, capture: &PlannedCapture) -> u64 {
        self.recorder.log.note(|| ObservedEvent::Magnetized {
            body: block_face.body,
            by: capture.parent,
            face: capture.face,
            child: capture.child,
            cell: capture.cell,
        });
        self.world.magnetize(block_face);
        self.recorder.tick
    }

    fn switch_off(&mut self, block_face: BlockFace) {
        self.world.switch_off(block_face);
    }

    fn send(&mut self, from: Body, to: Body, message: Message) {
        let RunRecorder {
            tick, network, log, ..
        } = self.recorder;
        network.send(*tick, from, to, message, log);
    }

    fn send_later(&mut self, from: Body, to: Body, message: Message, ticks: u32) {
        let RunRecorder { tick, network, .. } = self.recorder;
        network.send_later(*tick, from, to, message, ticks);
    }

    fn carry_to_plate(&mut self, hops: u32) -> bool {
        let RunRecorder { network, log, .. } = self.recorder;
        !self.recorder.has_more && !log.is_recording() && network.carry(hops)
    }

    fn recall(&mut self, left: Body, unreceived: u32) -> Recalled {
        self.recorder.network.recall(left, unreceived)
    }

    fn clear_messages(&mut self) {
        self.recorder.network.clear();
    }

    fn captured(&mut self, capture: &PlannedCapture, docking: &Docking, magnetized: u64) {
        let RunRecorder {
            tick,
            released,
            bonds,
            loads,
            log,
            ..
        } = self.recorder;
        if let Some(loads) = loads {
            loads.capture(capture.parent, capture.face, capture.child, capture.cell);
        }
        log.note(|| ObservedEvent::Captured {
            body: docking.child,
            on: docking.block_face.body,
            face: capture.face,
            role: capture.child,
            cell: capture.cell,
        });
        bonds.push(BondRecord {
            phase: capture.phase,
            parent: capture.parent,
            face: capture.face,
            child: capture.child,
            cell: capture.cell,
            magnetized,
            docked: *tick,
            entries: docking.entries,
            docking: *tick - docking.entered,
            body: docking.child,
            origin: (released.get(&docking.child).cloned()).unwrap_or(Origin::Free),
        });
    }

    fn unplanned(&mut self, by: RoleId, face: Face, docking: &Docking) {
        self.recorder.unplanned.push(UnplannedRecord {
            phase: self.recorder.phase,
            parent: by,
            face,
            tick: self.recorder.tick,
            body: docking.child,
        });
        self.recorder.log.note(|| ObservedEvent::Unplanned {
            body: docking.child,
            on: docking.block_face.body,
            face,
            by,
        });
    }

    fn released(&mut self, by: RoleId, role: RoleId, body: Body, _orphans: usize) {
        if let Some(loads) = &mut self.recorder.loads {
            loads.release(role);
        }
        if let Body::Free(body) = body {
            self.recorder
                .log
                .note(|| ObservedEvent::Released { body, role, by });
            let tick = self.recorder.tick;
            let phase = self.recorder.phase;
            self.recorder.releases().push(ReleaseRecord {
                phase,
                parent: by,
                child: role,
                tick,
                body,
            });
            let origin = Origin::Released { role, tick };
            self.recorder.released.insert(body, origin);
        }
    }

    fn reported(&mut self, by: Reporter) {
        self.recorder
            .log
            .note(|| ObservedEvent::Reported { by: by.role });
    }
}
