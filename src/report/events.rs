//! The captures and releases of a program, in the order of its dependency graph.
use std::collections::{BTreeMap, HashMap};

use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef as _;
use stochc_compiler::graph::Dependency;
use stochc_compiler::plan::{self, EventId};
use stochc_compiler::{Checked, Levels, emit};
use stochc_ir::Face;
use stochc_ir::record::{BondRecord, RunRecord, WaitRecord};
use stochc_ir::table::{PhaseId, RoleId};

use crate::ensemble::Program;

/// All events of a program.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Events {
    /// Phase by phase; what waits stands behind what it waits for, and next to it where it can.
    pub events: Vec<Event>,
    /// The program as its blocks hold it, to tell whether two are the same; `None`: its sources no
    /// longer compile, the events are those that were seen, and nothing is known of their order.
    pub tables: Option<String>,
}

/// A capture or a release.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Event {
    pub phase: PhaseId,
    pub deed: Deed,
    /// Events, and why it waits for them. Those of a [choice](Why::Face) may stand behind it, the others before.
    pub waits_for: Vec<(usize, Why)>,
}

/// What an event does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Deed {
    Capture {
        parent: RoleId,
        face: Face,
        child: RoleId,
    },
    Release {
        role: RoleId,
    },
}

/// Why an event waits for another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Why {
    Anchored,
    /// Of all these, so many are enough.
    Face {
        needed: u8,
    },
    After,
    Emptied,
    Vacated,
    Freed,
}

impl From<&BondRecord> for Deed {
    fn from(bond: &BondRecord) -> Deed {
        Deed::Capture {
            parent: bond.parent,
            face: bond.face,
            child: bond.child,
        }
    }
}

impl From<&WaitRecord> for Deed {
    fn from(wait: &WaitRecord) -> Deed {
        Deed::Capture {
            parent: wait.parent,
            face: wait.face,
            child: wait.child,
        }
    }
}

impl Deed {
    /// As the program writes it: `M.up -> N`.
    pub fn text(self, program: &Program) -> String {
        match self {
            Deed::Capture {
                parent,
                face,
                child,
            } => format!("{}.{face} -> {}", program.role(parent), program.role(child)),
            Deed::Release { role } => format!("release {}", program.role(role)),
        }
    }

    pub fn is_capture(self) -> bool {
        matches!(self, Deed::Capture { .. })
    }
}

impl Events {
    /// The events of a program of a manifest: compiled from its sources, or, where those no longer
    /// compile, those of its runs.
    pub fn of(program: &Program, runs: &[RunRecord]) -> Events {
        compiled(program).unwrap_or_else(|| Events {
            events: seen(runs),
            tables: None,
        })
    }

    /// The events of a phase with their numbers.
    pub fn of_phase(&self, phase: usize) -> impl DoubleEndedIterator<Item = (usize, &Event)> {
        let number = |event: &Event| event.phase.0 as usize;
        let begin = self.events.partition_point(|event| number(event) < phase);
        let end = self.events.partition_point(|event| number(event) <= phase);
        (begin..end).zip(&self.events[begin..end])
    }
}

/// `None` where the sources do not give the manifest's program any more.
fn compiled(entry: &Program) -> Option<Events> {
    let (_, checked) = entry.recompile(&Levels::default());
    if checked.has_errors() {
        return None;
    }
    let found = checked.programs.iter().position(|program| {
        let compiled = program.tables.as_ref().zip(program.scene.as_ref());
        compiled.is_some_and(|(tables, scene)| entry.describes(tables, scene))
    })?;
    from_graph(&checked, found, entry)
}

fn from_graph(checked: &Checked, found: usize, entry: &Program) -> Option<Events> {
    let program = &checked.programs[found];
    let (plan, graph) = (&program.plan, &program.graph);
    let numbers: HashMap<&str, u32> = (entry.roles.iter())
        .zip(0..)
        .map(|(name, number)| (name.as_str(), number))
        .collect();
    let role = |role| {
        let name = plan.roles.name(role, &checked.symbols);
        numbers.get(name.as_str()).copied().map(RoleId)
    };
    let waits = |id: EventId| {
        let edges = graph.edges_directed(NodeIndex::new(id.0 as usize), Incoming);
        let edges = edges.map(|edge| (graph[edge.source()], *edge.weight()));
        let mut waits: Vec<(EventId, Dependency)> = edges.collect();
        waits.sort_by_key(|&(first, _)| first);
        waits
    };
    let unneeded = &program.order.as_ref()?.unneeded;
    let mut order = side_by_side(plan.events.len(), |id| {
        let edges = graph.edges_directed(NodeIndex::new(id as usize), Incoming);
        let edges = edges.filter(|edge| !unneeded.contains(&edge.id()));
        let mut first: Vec<u32> = edges.map(|edge| graph[edge.source()].0).collect();
        first.sort_unstable();
        first.into_iter()
    });
    // What is attached by hand never waited.
    let by_hand = plan.phases.iter().filter(|phase| phase.planted);
    let by_hand: Vec<_> = by_hand.map(|phase| phase.events.clone()).collect();
    order.retain(|id| !by_hand.iter().any(|events| events.contains(id)));
    let mut place = vec![0; plan.events.len()];
    for (i, &id) in order.iter().enumerate() {
        place[id as usize] = i;
    }
    let mut phases = vec![PhaseId(0); plan.events.len()];
    for (number, phase) in (0..).zip(&plan.phases) {
        for id in plan.events_of(phase) {
            phases[id.0 as usize] = PhaseId(number);
        }
    }
    let events = order.iter().map(|&id| {
        let event = plan.event(EventId(id));
        let deed = match event.deed {
            plan::Deed::Capture { parent, face } => Deed::Capture {
                parent: role(parent)?,
                face,
                child: role(event.role)?,
            },
            plan::Deed::Release => Deed::Release {
                role: role(event.role)?,
            },
        };
        let waits_for = waits(EventId(id)).into_iter();
        let waits_for = waits_for.map(|(first, why)| (place[first.0 as usize], Why::of(why)));
        Some(Event {
            phase: phases[id as usize],
            deed,
            waits_for: waits_for.collect(),
        })
    });
    let events: Option<Vec<Event>> = events.collect();
    Some(Events {
        events: events?,
        tables: (program.tables.as_ref()).map(|tables| emit::table_text(tables).to_string()),
    })
}

/// An order in which everything stands behind what it waits for, and right behind the last of
/// those if nothing speaks against it, so that chains stay together.
///
/// In the order of the numbers else; they are phase by phase, and so is the result.
fn side_by_side<I: Iterator<Item = u32>>(count: usize, waits: impl Fn(u32) -> I) -> Vec<u32> {
    let mut missing = vec![0; count];
    let mut next: Vec<Vec<u32>> = vec![Vec::new(); count];
    for id in 0..count as u32 {
        for first in waits(id) {
            missing[id as usize] += 1;
            next[first as usize].push(id);
        }
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

/// What was captured or waited for in any run: by phase, earlier ones first on average.
fn seen(runs: &[RunRecord]) -> Vec<Event> {
    let mut found: BTreeMap<(PhaseId, Deed), (u64, u64)> = BTreeMap::new();
    let docked = |run: &RunRecord| {
        let docked = run.bonds.iter();
        let docked = docked.map(|bond| ((bond.phase, Deed::from(bond)), bond.docked));
        let waiting = run.waiting.iter();
        let waiting = waiting.map(|wait| ((wait.phase, Deed::from(wait)), run.ticks));
        docked.chain(waiting).collect::<Vec<_>>()
    };
    for (what, tick) in runs.iter().flat_map(docked) {
        let (count, ticks) = found.entry(what).or_default();
        *count += 1;
        *ticks = ticks.saturating_add(tick);
    }
    let mut found: Vec<_> = found.into_iter().collect();
    found.sort_by_key(|&((phase, _), (count, ticks))| (phase, ticks / count));
    let event = |((phase, deed), _)| Event {
        phase,
        deed,
        waits_for: Vec::new(),
    };
    found.into_iter().map(event).collect()
}

impl Why {
    fn of(dependency: Dependency) -> Why {
        match dependency {
            Dependency::Anchored => Why::Anchored,
            Dependency::Face { needed, .. } => Why::Face { needed },
            Dependency::After(_) => Why::After,
            Dependency::Emptied => Why::Emptied,
            Dependency::Vacated => Why::Vacated,
            Dependency::Freed => Why::Freed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_stay_together() {
        // 0 and 1 begin chains 0, 2, 4 and 1, 3; 5 waits for the ends of both.
        let waits: [&[u32]; 6] = [&[], &[], &[0], &[1], &[2], &[3, 4]];
        let order = side_by_side(6, |id| waits[id as usize].iter().copied());
        assert_eq!(order, [0, 2, 4, 1, 3, 5]);
    }
}
