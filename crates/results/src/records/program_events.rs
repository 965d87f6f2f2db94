//! Events of a program, to validate records.
use stochc_ir::Cell;
use stochc_ir::graph::{Dependency, Edge, EventAction, EventGraph, EventId};
use stochc_ir::record::RunRecord;
use stochc_ir::table::PhaseId;

use crate::EnsembleProgram;

/// Events of a program, sorted for lookups.
pub(crate) struct ProgramEvents<'m> {
    graph: &'m EventGraph,
    /// Events sorted by phase and action. Equal ones stay in source order.
    sorted: Vec<EventId>,
}

/// Times of an event, taken from a record.
#[derive(Clone, Copy)]
struct EventTimes {
    /// Tick when all predecessors of the event had happened.
    ready: u64,
    /// Tick of the event. `None` if it had not happened at the end of the run.
    done: Option<u64>,
}

type Checked<T = ()> = Result<T, &'static str>;

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
        for (id, of) in times.iter().enumerate() {
            let Some(of) = of else { continue };
            let waits_for = self.graph.waits_for(EventId(id as u32));
            if !(waits_for.iter()).all(|edge| is_satisfied(edge, *of, &times)) {
                return Err("an event comes before one that it waits for");
            }
        }
        Ok(())
    }

    /// Returns the times of each event of the program, taken from the captures, waits and releases
    /// of a record.
    fn times(&self, record: &RunRecord) -> Checked<Vec<Option<EventTimes>>> {
        let mut times = vec![None; self.graph.events.len()];
        for bond in &record.bonds {
            let action = EventAction::Capture {
                parent: bond.parent,
                face: bond.face,
                child: bond.child,
            };
            let id = self.next(&times, bond.phase, action, Some(bond.cell))?;
            times[id] = Some(EventTimes {
                ready: bond.magnetized,
                done: Some(bond.docked),
            });
        }
        for wait in &record.waiting {
            let action = EventAction::Capture {
                parent: wait.parent,
                face: wait.face,
                child: wait.child,
            };
            let id = self.next(&times, wait.phase, action, Some(wait.cell))?;
            times[id] = Some(EventTimes {
                ready: wait.magnetized,
                done: None,
            });
        }
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

    /// Returns the index of the first event with `phase` and `action` that has no entry in `times`
    /// yet. If `cell` is given, the event must be in this cell.
    fn next(
        &self,
        times: &[Option<EventTimes>],
        phase: PhaseId,
        action: EventAction,
        cell: Option<Cell>,
    ) -> Checked<usize> {
        let searched = (phase, action);
        let begin = (self.sorted).partition_point(|&id| key(self.graph, id) < searched);
        let same = self.sorted[begin..].iter();
        let mut same = same.take_while(|&&id| key(self.graph, id) == searched);
        let is_next = |id: &&EventId| {
            times[id.0 as usize].is_none()
                && (cell.is_none() || self.graph.event(**id).cell == cell)
        };
        let found = same.find(is_next).map(|id| id.0 as usize);
        found.ok_or("its program has no such event")
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
