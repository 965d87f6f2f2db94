//! Captures and releases of a program, in the order of its dependency graph.
use stochc_ir::graph::{Dependency, EventAction, EventGraph, EventId};
use stochc_ir::record::{BondRecord, WaitRecord};
use stochc_ir::table::PhaseId;
use stochc_results::EnsembleProgram;

/// All events of a program except the attachment of pre-attached blocks, which never waits.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Events {
    /// All events, sorted by phase. Each event comes after its dependencies, if possible directly
    /// after the last one.
    pub events: Vec<OrderedEvent>,
    /// Shortest duration of each phase \[ticks\].
    pub waits: Vec<u64>,
}

/// Capture or release, with its dependencies.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OrderedEvent {
    pub phase: PhaseId,
    pub action: EventAction,
    /// Event index and kind of each dependency. Events of a [choice](Dependency::Face) may follow
    /// this event in the list. All others precede this event.
    pub waits_for: Vec<(usize, Dependency)>,
}

impl OrderedEvent {
    /// Returns the event in the notation of the program, such as `M.up -> N`.
    pub fn text(&self, program: &EnsembleProgram) -> String {
        self.action.describe(|role| program.role(role).to_owned())
    }
}

/// Returns the event action that a recorded capture belongs to.
pub(crate) fn captured(bond: &BondRecord) -> EventAction {
    EventAction::Capture {
        parent: bond.parent,
        face: bond.face,
        child: bond.child,
    }
}

/// Returns the event action that a pending capture belongs to.
pub(crate) fn awaited(wait: &WaitRecord) -> EventAction {
    EventAction::Capture {
        parent: wait.parent,
        face: wait.face,
        child: wait.child,
    }
}

impl Events {
    /// Returns the events of a program, sorted.
    pub fn new(program: &EnsembleProgram) -> Events {
        let graph = &program.compiled.graph;
        let mut order = side_by_side(graph);
        order.retain(|&id| !program.is_pre_attached(graph.event(EventId(id)).phase));
        let mut place = vec![0; graph.events.len()];
        for (i, &id) in order.iter().enumerate() {
            place[id as usize] = i;
        }
        let events = order.iter().map(|&id| {
            let event = graph.event(EventId(id));
            let waits_for = graph.waits_for(EventId(id)).iter();
            OrderedEvent {
                phase: event.phase,
                action: event.action,
                waits_for: waits_for
                    .map(|edge| (place[edge.first.0 as usize], edge.why))
                    .collect(),
            }
        });
        Events {
            events: events.collect(),
            waits: (program.compiled.tables.phases.iter())
                .map(|phase| phase.wait)
                .collect(),
        }
    }

    /// Returns the events of a phase with their indices.
    pub fn of_phase(
        &self,
        phase: usize,
    ) -> impl DoubleEndedIterator<Item = (usize, &OrderedEvent)> {
        let number = |event: &OrderedEvent| event.phase.0 as usize;
        let begin = self.events.partition_point(|event| number(event) < phase);
        let end = self.events.partition_point(|event| number(event) <= phase);
        (begin..end).zip(&self.events[begin..end])
    }
}

/// Returns a topological order. Each event comes directly after its last dependency if possible, so
/// that chains stay together.
///
/// Otherwise, events are in the order of their indices. The events of one phase always stay
/// together.
fn side_by_side(graph: &EventGraph) -> Vec<u32> {
    let count = graph.events.len();
    let mut missing = vec![0; count];
    let mut next: Vec<Vec<u32>> = vec![Vec::new(); count];
    for edge in graph.edges().iter().filter(|edge| !edge.unneeded) {
        missing[edge.then.0 as usize] += 1;
        next[edge.first.0 as usize].push(edge.then.0);
    }
    let mut order = Vec::with_capacity(count);
    let mut stack: Vec<u32> = (0..count as u32)
        .rev()
        .filter(|&id| missing[id as usize] == 0)
        .collect();
    while let Some(id) = stack.pop() {
        order.push(id);
        for &waiting in next[id as usize].iter().rev() {
            missing[waiting as usize] -= 1;
            if missing[waiting as usize] == 0 {
                stack.push(waiting);
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use stochc_ir::graph::{self, Edge};
    use stochc_ir::table::RoleId;

    use super::*;

    #[test]
    fn chains_stay_together() {
        // Events 0 and 1 start the chains 0, 2, 4 and 1, 3. Event 5 waits for the last events of
        // both chains.
        let waits: [&[u32]; 6] = [&[], &[], &[0], &[1], &[2], &[3, 4]];
        let event = graph::GraphEvent {
            phase: PhaseId(0),
            action: EventAction::Release { child: RoleId(0) },
            cell: None,
            delay: 0,
        };
        let edges = (0..).zip(waits).flat_map(|(then, waits)| {
            waits.iter().map(move |&first| Edge {
                first: EventId(first),
                then: EventId(then),
                why: Dependency::After,
                unneeded: false,
            })
        });
        let graph = EventGraph::new(vec![event; 6], edges.collect(), vec![Vec::new()]);
        assert_eq!(side_by_side(&graph), [0, 2, 4, 1, 3, 5]);
    }
}
