//! Builds the record of a run from the rows of a log.
use std::collections::{HashMap, HashSet};

use stochc_ir::Face;
use stochc_ir::graph::{EventAction, EventId};
use stochc_ir::record::{
    AbortRecord, BondRecord, Limit, Origin, Outcome, ReleaseRecord, RunRecord, UnplannedRecord,
    WaitRecord,
};
use stochc_ir::table::{Phase, PhaseId, RoleId};

use super::error::RowError;
use super::logged_program::LoggedProgram;
use super::rows::{LogEvent, Row};

/// State of a run after some rows of its log.
pub(super) struct RunBuilder<'l> {
    log: &'l LoggedProgram<'l>,
    record: RunRecord,
    /// Tick and line of each event that has happened.
    happened: Vec<Option<Happened>>,
    /// Tick when the face of each capture was switched on, if the log contains it.
    opened: Vec<Option<u64>>,
    /// Running phase. If all phases are complete, the last one.
    phase: PhaseId,
    /// Number of events of the running phase that have not happened.
    left: usize,
    /// Start of the running phase \[ticks\].
    began: u64,
    /// Start of the running attempt at the phase \[ticks\].
    attempt_began: u64,
    /// Tick of the last event of the attempt, or of its start.
    last_event: u64,
    /// Number of captures before the running phase.
    earlier_bonds: usize,
    /// Whether the attempt has timed out and the next one has not begun.
    is_aborting: bool,
    /// Block and parent of each captured role.
    holders: HashMap<RoleId, Holder>,
    attached: HashSet<u32>,
    /// Origin of each block that was released.
    released: HashMap<u32, Origin>,
    /// Smallest number that no block has got yet.
    next_body: u32,
    /// Time of a first row `phase` \[ticks\]. The times of the run count from it.
    origin: f64,
    /// Whether the run has a row for each phase.
    has_phases: bool,
    /// Whether the run has rows of faces that open.
    has_opened: bool,
    /// Line of the row that ended the run: `end`, or the timeout of the last attempt.
    ended: Option<u64>,
    /// Whether a timeout ended the run.
    is_timed_out: bool,
    /// Line of the last row. `None` before the first row.
    line: Option<u64>,
    tick: u64,
}

#[derive(Clone, Copy)]
struct Happened {
    tick: u64,
    line: u64,
}

#[derive(Clone, Copy)]
struct Holder {
    body: u32,
    parent: RoleId,
}

impl<'l> RunBuilder<'l> {
    pub fn new(log: &'l LoggedProgram<'l>, run: u64) -> RunBuilder<'l> {
        let start = &log.start;
        let bonds = start.bonds.iter();
        let holder = |bond: &BondRecord| Holder {
            body: bond.body,
            parent: bond.parent,
        };
        let phases = &log.tables.phases;
        let seeds = phases.iter().take_while(|phase| phase.pre_attached).count();
        let phase = PhaseId(seeds.min(phases.len() - 1) as u32);
        let is_planted = |id: usize| log.graph.events[id].phase.0 < seeds as u32;
        let events = log.graph.events.len();
        let planted = Happened { tick: 0, line: 0 };
        RunBuilder {
            log,
            happened: (0..events)
                .map(|id| is_planted(id).then_some(planted))
                .collect(),
            opened: vec![None; events],
            phase,
            left: log
                .graph
                .events_of(phase)
                .filter(|id| !is_planted(id.0 as usize))
                .count(),
            began: 0,
            attempt_began: 0,
            last_event: 0,
            earlier_bonds: start.bonds.len(),
            is_aborting: false,
            holders: bonds
                .clone()
                .map(|bond| (bond.child, holder(bond)))
                .collect(),
            attached: bonds.map(|bond| bond.body).collect(),
            released: HashMap::new(),
            next_body: 0,
            origin: 0.0,
            has_phases: false,
            has_opened: false,
            ended: None,
            is_timed_out: false,
            line: None,
            tick: 0,
            record: RunRecord {
                run,
                waiting: Vec::new(),
                ..start.clone()
            },
        }
    }

    pub fn run(&self) -> u64 {
        self.record.run
    }

    /// Adds the next row of the run.
    pub fn add(&mut self, row: &Row) -> Result<(), RowError> {
        if let Some(line) = self.ended {
            return Err(RowError::Ended(line));
        }
        if self.line.is_none() && row.event == LogEvent::Phase {
            self.origin = row.ticks;
            self.has_phases = true;
        }
        let ticks = row.ticks - self.origin;
        if let Some(line) = self
            .line
            .filter(|_| (ticks.round() as u64) < self.tick || ticks < 0.0)
        {
            return Err(RowError::Backwards(line));
        }
        self.tick = ticks.round() as u64;
        self.line = Some(row.line);
        match row.event {
            LogEvent::Phase => self.begin_phase(row),
            LogEvent::Opened => self.open(row),
            LogEvent::Captured => self.capture(row),
            LogEvent::Released => self.release(row),
            LogEvent::Rejected => self.reject(row),
            LogEvent::Timeout => self.abort(row),
            LogEvent::End => {
                self.ended = Some(row.line);
                Ok(())
            }
        }
    }

    /// Returns the record. A run that is not complete is right-censored at its last row.
    pub fn finish(mut self) -> RunRecord {
        self.pass_phases();
        let is_last = self.next_phase().is_none();
        let end = self.phase_end().filter(|_| is_last && !self.is_timed_out);
        if let Some(end) = end.filter(|end| *end <= self.tick) {
            let end = if self.has_phases { self.tick } else { end };
            if !self.phase().pre_attached {
                self.record.phase_ticks.push(end - self.began);
            }
            (self.record.ticks, self.record.outcome) = (end, Outcome::Completed);
        } else {
            let limit = self.phase().timeout.filter(|_| !self.is_aborting);
            let is_late =
                limit.is_some_and(|limit| self.tick >= self.attempt_began.saturating_add(limit));
            let is_late = is_late || self.is_timed_out;
            self.record.ticks = self.tick;
            self.record.waiting = self.waiting();
            self.record.outcome = Outcome::TimedOut {
                phase: self.phase,
                by: if is_late {
                    Limit::Timeout
                } else {
                    Limit::MaxTicks
                },
            };
        }
        let released = self
            .released
            .keys()
            .filter(|body| !self.attached.contains(body));
        self.record.blocks_used = (self.attached.len() + released.count()) as u32;
        self.record
    }

    fn phase(&self) -> &'l Phase {
        &self.log.tables.phases[self.phase.0 as usize]
    }

    /// Returns the end of the running phase \[ticks\]. Returns `None` if events are missing.
    fn phase_end(&self) -> Option<u64> {
        let wait = self.attempt_began.saturating_add(self.phase().wait);
        (self.left == 0).then(|| self.last_event.max(wait))
    }

    /// Begins the next phases whose previous phase has ended, unless the log has rows for phases.
    fn pass_phases(&mut self) {
        while !self.has_phases
            && let Some(end) = self.phase_end().filter(|end| *end <= self.tick)
            && self.next_phase().is_some()
        {
            self.enter_phase(end);
        }
    }

    fn next_phase(&self) -> Option<PhaseId> {
        let next = PhaseId(self.phase.0 + 1);
        ((next.0 as usize) < self.log.tables.phases.len()).then_some(next)
    }

    fn enter_phase(&mut self, tick: u64) {
        self.record.phase_ticks.push(tick - self.began);
        self.phase.0 += 1;
        self.left = self.log.graph.events_of(self.phase).count();
        self.earlier_bonds = self.record.bonds.len();
        self.began = tick;
        self.begin_attempt(tick);
    }

    fn begin_attempt(&mut self, tick: u64) {
        self.attempt_began = tick;
        self.last_event = tick;
    }

    fn begin_phase(&mut self, row: &Row) -> Result<(), RowError> {
        let running = self.log.phase(self.phase);
        if self.is_aborting {
            return self.retry(&row.block);
        }
        let is_first = self.record.bonds.len() == self.log.start.bonds.len()
            && self.record.releases.is_empty()
            && self.tick == 0;
        if row.block == running && is_first {
            return Ok(());
        }
        if self.left > 0 {
            return Err(RowError::Phase(format!(
                "phase `{}` cannot begin: {}",
                row.block,
                self.missing()
            )));
        }
        match self.next_phase() {
            Some(next) if self.log.phase(next) == row.block => {
                self.enter_phase(self.tick);
                Ok(())
            }
            Some(next) => Err(RowError::Phase(format!(
                "phase `{}` does not follow phase `{running}`; the next phase is `{}`",
                row.block,
                self.log.phase(next)
            ))),
            None => Err(RowError::Phase(format!(
                "phase `{}` does not follow phase `{running}`, which is the last phase",
                row.block
            ))),
        }
    }

    fn retry(&mut self, name: &str) -> Result<(), RowError> {
        let running = self.log.phase(self.phase);
        let Some(abort) = self.record.aborts.last_mut() else {
            return Ok(());
        };
        if name != running {
            return Err(RowError::Phase(format!(
                "phase `{name}` cannot begin: phase `{running}` has timed out and begins again"
            )));
        }
        if abort.releases.len() < abort.bonds.len() {
            return Err(RowError::Phase(format!(
                "phase `{running}` cannot begin again: {} of its {} captures have been released",
                abort.releases.len(),
                abort.bonds.len()
            )));
        }
        abort.retried = Some(self.tick);
        self.is_aborting = false;
        self.begin_attempt(self.tick);
        Ok(())
    }

    fn abort(&mut self, row: &Row) -> Result<(), RowError> {
        self.pass_phases();
        let running = self.log.phase(self.phase);
        if row.block != running || self.is_aborting {
            return Err(RowError::Phase(format!(
                "phase `{}` cannot time out: phase `{running}` {}",
                row.block,
                if self.is_aborting {
                    "has timed out already"
                } else {
                    "is running"
                }
            )));
        }
        let retries = self.phase().recovery.map_or(0, |recovery| recovery.retries);
        if self.record.retries(self.phase) >= u64::from(retries) {
            self.is_timed_out = true;
            self.ended = Some(row.line);
            return Ok(());
        }
        self.record.aborts.push(AbortRecord {
            phase: self.phase,
            began: self.attempt_began,
            tick: self.tick,
            retried: None,
            bonds: self.record.bonds.split_off(self.earlier_bonds),
            waiting: self.waiting(),
            releases: Vec::new(),
        });
        self.is_aborting = true;
        self.left = 0;
        for id in self.log.graph.events_of(self.phase) {
            self.happened[id.0 as usize] = None;
            self.opened[id.0 as usize] = None;
            self.left += 1;
        }
        Ok(())
    }

    fn open(&mut self, row: &Row) -> Result<(), RowError> {
        let id = self.expected(self.capture_of(row)?)?;
        self.ready(id, false)?;
        self.has_opened = true;
        self.opened[id.0 as usize] = Some(self.tick);
        Ok(())
    }

    fn capture(&mut self, row: &Row) -> Result<(), RowError> {
        let action = self.capture_of(row)?;
        let id = self.expected(action)?;
        self.ready(id, true)?;
        let opened = self.opened[id.0 as usize];
        let magnetized = match opened {
            Some(tick) => tick,
            None => self.ready(id, false)?,
        };
        let body = self.take_body(row.body)?;
        let event = self.log.graph.event(id);
        let (parent, child) = (action.actor(), action.child());
        let Some(face) = action.face() else {
            return Ok(());
        };
        self.record.bonds.push(BondRecord {
            phase: self.phase,
            parent,
            face,
            child,
            cell: event.cell.unwrap_or_default(),
            magnetized,
            docked: self.tick,
            entries: 0,
            docking: 0,
            body,
            origin: self.released.get(&body).cloned().unwrap_or(Origin::Free),
        });
        self.holders.insert(child, Holder { body, parent });
        self.happen(id);
        Ok(())
    }

    fn release(&mut self, row: &Row) -> Result<(), RowError> {
        let child = self.log.role(&row.block)?;
        let action = EventAction::Release { child };
        let id = if self.is_aborting {
            None
        } else {
            Some(self.expected(action)?)
        };
        if let Some(id) = id {
            self.ready(id, true)?;
        }
        let captured_in = |abort: &AbortRecord| abort.bonds.iter().any(|bond| bond.child == child);
        let is_undone = self.record.aborts.last().is_some_and(captured_in);
        let holder = self.holders.get(&child).copied();
        let Some(Holder { body, parent }) = holder.filter(|_| id.is_some() || is_undone) else {
            return Err(RowError::NoEvent {
                event: self.log.describe(action),
                instead: None,
            });
        };
        self.check_parent(row, parent)?;
        let release = ReleaseRecord {
            phase: self.phase,
            parent,
            child,
            tick: self.tick,
            body,
        };
        match (id, self.record.aborts.last_mut()) {
            (None, Some(abort)) => abort.releases.push(release),
            _ => self.record.releases.push(release),
        }
        self.holders.remove(&child);
        self.attached.remove(&body);
        let origin = Origin::Released {
            role: child,
            tick: self.tick,
        };
        self.released.insert(body, origin);
        if let Some(id) = id {
            self.happen(id);
        }
        Ok(())
    }

    /// Checks that a row names no other parent. The name may be followed by a face.
    fn check_parent(&self, row: &Row, parent: RoleId) -> Result<(), RowError> {
        let found = match self.log.face(&row.by) {
            _ if row.by.is_empty() => return Ok(()),
            Ok((role, _)) => role,
            Err(_) => self.log.role(&row.by)?,
        };
        if found == parent {
            return Ok(());
        }
        Err(RowError::Parent {
            child: row.block.clone(),
            parent: self.log.tables.name(parent).to_owned(),
            found: row.by.clone(),
        })
    }

    fn reject(&mut self, row: &Row) -> Result<(), RowError> {
        self.pass_phases();
        let (parent, face) = self.face_of(row)?;
        let body = self.take_body(row.body)?;
        self.attached.remove(&body);
        self.record.unplanned += 1;
        self.record.unplanned_bonds.push(UnplannedRecord {
            phase: self.phase,
            parent,
            face,
            tick: self.tick,
            body,
        });
        Ok(())
    }

    fn face_of(&self, row: &Row) -> Result<(RoleId, Face), RowError> {
        match row.by.as_str() {
            "" => Err(RowError::Missing("by")),
            by => self.log.face(by),
        }
    }

    /// Returns the capture that a row describes.
    fn capture_of(&self, row: &Row) -> Result<EventAction, RowError> {
        let (parent, face) = self.face_of(row)?;
        let child = match row.block.as_str() {
            "" => return Err(RowError::Missing("block")),
            block => self.log.role(block)?,
        };
        Ok(EventAction::Capture {
            parent,
            face,
            child,
        })
    }

    /// Returns the next event of the running phase with an action.
    fn expected(&mut self, action: EventAction) -> Result<EventId, RowError> {
        self.pass_phases();
        let mut events = self.log.events(self.phase, action);
        let is_next = |id: &EventId| !self.is_aborting && self.happened[id.0 as usize].is_none();
        if let Some(id) = events.find(is_next) {
            return Ok(id);
        }
        let mut phases = self.log.phases_with(action);
        let later = phases.find(|phase| *phase > self.phase);
        let event = self.log.describe(action);
        Err(match (later, self.line_of(action)) {
            (Some(phase), _) => RowError::OtherPhase {
                event,
                phase: self.log.phase(phase).to_owned(),
                running: self.log.phase(self.phase).to_owned(),
                reason: self.missing(),
            },
            (None, Some(0)) => RowError::PreAttached(event),
            (None, Some(line)) => RowError::Repeated { event, line },
            (None, None) if self.is_aborting => RowError::Aborted(event),
            (None, None) => RowError::NoEvent {
                event,
                instead: self.log.alternative(self.phase, action),
            },
        })
    }

    /// Returns the line of the last event with an action. Returns 0 for pre-attached blocks.
    fn line_of(&self, action: EventAction) -> Option<u64> {
        let phases = self.log.phases_with(action);
        let events = phases.flat_map(|phase| self.log.events(phase, action));
        let lines = events.filter_map(|id| Some(self.happened[id.0 as usize]?.line));
        lines.last()
    }

    /// Returns the reason why the running phase has not ended.
    fn missing(&self) -> String {
        let mut events = self.log.graph.events_of(self.phase);
        let missing = events.find(|id| self.happened[id.0 as usize].is_none());
        match missing {
            _ if self.is_aborting => {
                "it has timed out, and its next attempt has no row `phase`".to_owned()
            }
            Some(id) => {
                let event = self.log.graph.event(id).action;
                format!("`{}` has not happened", self.log.describe(event))
            }
            None if self.has_phases => "add a row `phase` where the next phase begins".to_owned(),
            None => format!(
                "its `wait` lasts until tick {}; add a row `phase` if the next phase begins earlier",
                self.phase_end().unwrap_or(self.tick)
            ),
        }
    }

    /// Returns the tick from which an event is possible.
    fn ready(&self, id: EventId, is_docking: bool) -> Result<u64, RowError> {
        let done = |id: EventId| Some(self.happened[id.0 as usize]?.tick);
        let ready = self.log.ready(id, is_docking, done);
        let ready = ready.map_err(|first| RowError::TooEarly {
            event: self.log.describe(self.log.graph.event(id).action),
            first: self.log.describe(self.log.graph.event(first).action),
        });
        Ok(ready?.max(self.attempt_began))
    }

    fn happen(&mut self, id: EventId) {
        let (tick, line) = (self.tick, self.line.unwrap_or(0));
        self.happened[id.0 as usize] = Some(Happened { tick, line });
        self.left -= 1;
        self.last_event = tick;
    }

    /// Returns the number of a captured block. Without a number in the log, prefers blocks that have
    /// never been captured.
    fn take_body(&mut self, given: Option<u32>) -> Result<u32, RowError> {
        let blocks = self.log.blocks;
        let is_known =
            |body: &u32| self.attached.contains(body) || self.released.contains_key(body);
        let body = match given {
            Some(body) => body,
            None => {
                while self.next_body < blocks && is_known(&self.next_body) {
                    self.next_body += 1;
                }
                let released = self
                    .released
                    .keys()
                    .filter(|body| !self.attached.contains(body));
                let released = released.min().copied();
                let unused = (self.next_body < blocks).then_some(self.next_body);
                (unused.or(released)).ok_or(RowError::NoFreeBlock(blocks))?
            }
        };
        if body >= blocks {
            return Err(RowError::NoSuchBody { body, blocks });
        }
        if !self.attached.insert(body) {
            return Err(RowError::Attached(body));
        }
        Ok(body)
    }

    /// Returns the open faces, each with the tick when it was switched on.
    fn waiting(&self) -> Vec<WaitRecord> {
        if self.is_aborting {
            return Vec::new();
        }
        let mut waiting = Vec::new();
        for id in self.log.graph.events_of(self.phase) {
            let event = self.log.graph.event(id);
            let EventAction::Capture {
                parent,
                face,
                child,
            } = event.action
            else {
                continue;
            };
            let opened = if self.has_opened {
                self.opened[id.0 as usize]
            } else {
                self.ready(id, false).ok()
            };
            if let Some(magnetized) = opened.filter(|_| self.happened[id.0 as usize].is_none()) {
                waiting.push(WaitRecord {
                    phase: self.phase,
                    parent,
                    face,
                    child,
                    cell: event.cell.unwrap_or_default(),
                    magnetized,
                    entries: 0,
                });
            }
        }
        waiting.sort_by_key(|wait| (wait.magnetized, wait.parent, wait.child));
        waiting
    }
}
