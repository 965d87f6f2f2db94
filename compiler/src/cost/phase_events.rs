//! What happens in the cells of a phase.
use stochc_ir::{Cell, Face};

use crate::Program;
use crate::plan::{EventId, EventKind, PlanPhase};

/// An event whose cell is known.
#[derive(Clone, Copy, Debug)]
pub struct PhaseEvent {
    pub id: EventId,
    /// The cell that is filled or emptied.
    pub cell: Cell,
    /// Captures of the longest chain of the phase that ends here.
    pub level: u32,
    /// Of a capture: the way from the block that captures to the cell.
    pub way: Option<Face>,
    /// Of a release: the level of the phase from which on the block sat there, 0 if it did before.
    pub releases_since: Option<u32>,
    kind: EventKind,
}

impl PhaseEvent {
    /// Whether it empties its cell.
    pub fn is_release(&self) -> bool {
        self.kind == EventKind::Release
    }
}

/// How many blocks fewer are free after an event.
pub fn taken_by(kind: EventKind) -> i64 {
    if kind == EventKind::Release { -1 } else { 1 }
}

/// The events of a phase, in source order; `levels` of all events.
pub fn phase_events(program: &Program, phase: &PlanPhase, levels: &[u32]) -> Vec<PhaseEvent> {
    let (plan, layout) = (&program.plan, &program.layout);
    let events = plan.events_of(phase).filter_map(|id| {
        let cell = layout.cells[id.0 as usize]?;
        let (kind, parent) = (plan.event(id).kind, layout.parents[id.0 as usize]);
        let is_release = kind == EventKind::Release;
        let since = |capture: EventId| {
            if phase.events.contains(&capture.0) {
                levels[capture.0 as usize]
            } else {
                0
            }
        };
        Some(PhaseEvent {
            id,
            cell,
            level: levels[id.0 as usize],
            way: parent.filter(|_| !is_release).map(|parent| parent.face),
            releases_since: parent
                .filter(|_| is_release)
                .map(|parent| since(parent.capture)),
            kind,
        })
    });
    events.collect()
}

/// How many blocks are not free when the captures of each level begin, and at the end of the phase; `before`: at its beginning.
pub fn bound(before: i64, events: &[PhaseEvent]) -> Vec<i64> {
    let levels = events.iter().map(|event| event.level).max();
    let mut bound = vec![0; levels.map_or(1, |levels| levels as usize + 2)];
    bound[0] = before;
    for event in events {
        bound[event.level as usize + 1] += taken_by(event.kind);
    }
    let mut sum = 0;
    for bound in &mut bound {
        sum += *bound;
        *bound = sum;
    }
    bound
}
