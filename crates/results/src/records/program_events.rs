//! Events of a program, to validate records.
use std::collections::HashMap;

use stochc_ir::Cell;
use stochc_ir::graph::{Dependency, Edge, EventAction, EventGraph, EventId};
use stochc_ir::record::{AbortRecord, BondRecord, ReleaseRecord, RunRecord, WaitRecord};
use stochc_ir::table::{PhaseId, RoleId};

use crate::EnsembleProgram;

/// Events of a program, sorted for lookups.
pub(crate) struct ProgramEvents<'m> {
    graph: &'m EventGraph,
    /// Events sorted by phase and action. Equal ones stay in source order.
    sorted: Vec<EventId>,
}

/// Times of an event, taken from a record.
#[derive(Clone, Copy)]
pub(crate) struct EventTimes {
    /// Tick when all predecessors of the event had happened.
    pub ready: u64,
    /// Tick of the event. `None` if it had not happened at the end of the run.
    pub done: Option<u64>,
}

pub(crate) type Checked<T = ()> = Result<T, &'static str>;

impl<'m> ProgramEvents<'m> {
    pub fn new(program: &'m EnsembleProgram) -> ProgramEvents<'m> {
        let graph = &program.compiled.graph;
        let mut sorted: Vec<EventId> = (0..graph.events.len() as u32).map(EventId).collect();
        sorted.sort_by_key(|&id| key(graph, id));
        ProgramEvents { graph, sorted }
    }

    /// Checks that the program has every event of a record, and that each event follows its
    /// predecessors.
    pub fn check(&self, record: &RunRecord) -> Checked {
        let times = self.times(record)?;
        self.check_phases(&times)?;
        self.check_order(&times, PhaseId(0))?;
        let mut aborts = record.aborts.iter();
        aborts.try_for_each(|abort| self.check_abort(abort, &times))
    }

    /// Returns the times of each event of the program, without aborted attempts. `None` for an
    /// event that is not in the record.
    pub fn times(&self, record: &RunRecord) -> Checked<Vec<Option<EventTimes>>> {
        let mut times = vec![None; self.graph.events.len()];
        self.add_captures(&record.bonds, &record.waiting, &mut times)?;
        for release in &record.releases {
            let action = EventAction::Release {
                child: release.child,
            };
            let id = self.next(&times, release.phase, action, None)?;
            times[id] = Some(EventTimes {
                ready: release.tick,
                done: Some(release.tick),
            });
        }
        Ok(times)
    }

    /// Checks that the events in phase `since` and in later phases follow their predecessors.
    fn check_order(&self, times: &[Option<EventTimes>], since: PhaseId) -> Checked {
        let events = self.graph.events.partition_point(|it| it.phase < since);
        for (id, of) in times.iter().enumerate().skip(events) {
            let Some(of) = of else { continue };
            let waits_for = self.graph.waits_for(EventId(id as u32));
            if !(waits_for.iter()).all(|edge| is_satisfied(edge, *of, times)) {
                return Err("an event comes before one that it waits for");
            }
        }
        Ok(())
    }

    /// Checks an aborted attempt. `times` are those of the events that were not undone.
    fn check_abort(&self, abort: &AbortRecord, times: &[Option<EventTimes>]) -> Checked {
        let end = abort.retried.unwrap_or(u64::MAX);
        let is_within =
            |from: u64, to: u64| (abort.began..=abort.tick).contains(&from) && from <= to;
        let bonds = abort.bonds.iter();
        let is_ordered = (abort.began <= abort.tick && abort.tick <= end)
            && bonds
                .clone()
                .all(|it| is_within(it.magnetized, it.docked) && it.docked <= abort.tick)
            && (abort.waiting.iter()).all(|it| is_within(it.magnetized, abort.tick))
            && (abort.releases.iter()).all(|it| (abort.tick..=end).contains(&it.tick));
        if !is_ordered {
            return Err("an event of an aborted attempt is outside of the attempt");
        }
        let phases = (bonds.clone().map(|it| it.phase))
            .chain(abort.waiting.iter().map(|it| it.phase))
            .chain(abort.releases.iter().map(|it| it.phase));
        if phases.clone().any(|phase| phase != abort.phase) {
            return Err("an event of an aborted attempt is in another phase");
        }
        let captured: HashMap<u32, (RoleId, RoleId)> =
            bonds.map(|it| (it.body, (it.parent, it.child))).collect();
        let is_captured =
            |it: &ReleaseRecord| captured.get(&it.body) == Some(&(it.parent, it.child));
        if !abort.releases.iter().all(is_captured) {
            return Err("an aborted attempt releases a block that it has not captured");
        }
        // Later events happened after the attempt.
        let events = self
            .graph
            .events
            .partition_point(|it| it.phase < abort.phase);
        let mut times = times[..events].to_vec();
        times.resize(self.graph.events.len(), None);
        self.add_captures(&abort.bonds, &abort.waiting, &mut times)?;
        self.check_order(&times, abort.phase)
    }

    /// Adds the times of captures and waits to the times of each event of the program.
    fn add_captures(
        &self,
        bonds: &[BondRecord],
        waiting: &[WaitRecord],
        times: &mut [Option<EventTimes>],
    ) -> Checked {
        for bond in bonds {
            let action = EventAction::Capture {
                parent: bond.parent,
                face: bond.face,
                child: bond.child,
            };
            let id = self.next(times, bond.phase, action, Some(bond.cell))?;
            times[id] = Some(EventTimes {
                ready: bond.magnetized,
                done: Some(bond.docked),
            });
        }
        for wait in waiting {
            let action = EventAction::Capture {
                parent: wait.parent,
                face: wait.face,
                child: wait.child,
            };
            let id = self.next(times, wait.phase, action, Some(wait.cell))?;
            times[id] = Some(EventTimes {
                ready: wait.magnetized,
                done: None,
            });
        }
        Ok(())
    }

    /// Returns the index of the first event with `phase` and `action` that has no entry in `times`
    /// yet. If `cell` is given, the event must be in this cell.
    fn next(
        &self,
        times: &[Option<EventTimes>],
        phase: PhaseId,
        action: EventAction,
        cell: Option<Cell>,
    ) -> Checked<usize> {
        let is_next = |id: &EventId| {
            times[id.0 as usize].is_none() && (cell.is_none() || self.graph.event(*id).cell == cell)
        };
        let found = self.of(phase, action).find(is_next);
        let found = found.map(|id| id.0 as usize);
        found.ok_or("its program has no such event")
    }

    /// Returns the events with `phase` and `action`, in source order.
    pub fn of(&self, phase: PhaseId, action: EventAction) -> impl Iterator<Item = EventId> {
        let searched = (phase, action);
        let begin = (self.sorted).partition_point(|&id| key(self.graph, id) < searched);
        let same = self.sorted[begin..].iter().copied();
        same.take_while(move |&id| key(self.graph, id) == searched)
    }

    /// Checks that no phase begins before the previous one has ended.
    fn check_phases(&self, times: &[Option<EventTimes>]) -> Checked {
        // Number of events in ended phases, and the tick of the last one.
        let mut ended = 0;
        let mut last = 0;
        let mut begin = 0;
        for events in self.graph.events.chunk_by(|a, b| a.phase == b.phase) {
            let end = begin + events.len();
            let own = times[begin..end].iter().flatten();
            if own.clone().next().is_some() && ended < begin {
                return Err("a phase begins before the one before it has ended");
            }
            if own.clone().any(|of| of.ready < last) {
                return Err("an event comes before its phase begins");
            }
            let done = own.filter_map(|of| of.done);
            ended += done.clone().count();
            last = done.max().unwrap_or(0).max(last);
            begin = end;
        }
        Ok(())
    }
}

fn key(graph: &EventGraph, id: EventId) -> (PhaseId, EventAction) {
    let event = graph.event(id);
    (event.phase, event.action)
}

/// Returns whether the times in a record fulfil a dependency. `then` are the times of the dependent
/// event. Does not check dependencies that the compiler chose freely.
fn is_satisfied(edge: &Edge, then: EventTimes, times: &[Option<EventTimes>]) -> bool {
    if edge.unneeded || edge.why.is_choice() {
        return true;
    }
    let needed_by = match edge.why {
        // A face may be switched on while its cell is still occupied. Only the capture must wait.
        Dependency::Vacated => then.done.unwrap_or(u64::MAX),
        _ => then.ready,
    };
    let first = times[edge.first.0 as usize].and_then(|first| first.done);
    match first {
        Some(first) => first <= needed_by,
        None => edge.why == Dependency::Vacated && then.done.is_none(),
    }
}
