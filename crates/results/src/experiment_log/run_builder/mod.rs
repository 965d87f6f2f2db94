//! Builds the record of a run from the rows of a log.
mod events;
mod phases;

use std::collections::{HashMap, HashSet};

use stochc_ir::graph::{EventAction, EventId};
use stochc_ir::record::{BondRecord, Limit, Origin, Outcome, RunRecord, WaitRecord};
use stochc_ir::table::{PhaseId, RoleId};

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
        let phase = PhaseId(seeds as u32);
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
            left: log.graph.events_of(phase).count(),
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
            self.record.phase_ticks.push(end - self.began);
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

    /// Returns the earliest possible tick of an event.
    fn ready(&self, id: EventId, is_docking: bool) -> Result<u64, RowError> {
        let done = |id: EventId| Some(self.happened[id.0 as usize]?.tick);
        let ready = self.log.ready(id, is_docking, done);
        let ready = ready.map_err(|first| RowError::TooEarly {
            event: self.log.describe(self.log.graph.event(id).action),
            first: self.log.describe(self.log.graph.event(first).action),
        });
        Ok(ready?.max(self.attempt_began))
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
