//! Collects the events of each step for an observer.
use std::collections::BTreeMap;

use stochc_control::Body;
use stochc_ir::Face;
use stochc_ir::state::{State, StateError, StateReader, StateWriter};

use super::observer::{ObservedEvent, Observer};
use crate::world::view::in_structure;
use crate::world::{FreeBond, SpatialWorld};

/// Log of events. `None` if there is no observer.
#[derive(Debug, Default)]
pub(crate) struct Log(Option<Vec<ObservedEvent>>);

impl Log {
    pub fn recording() -> Log {
        Log(Some(Vec::new()))
    }

    pub fn is_recording(&self) -> bool {
        self.0.is_some()
    }

    /// Records an event if this log records events.
    pub fn note(&mut self, event: impl FnOnce() -> ObservedEvent) {
        if let Some(events) = &mut self.0 {
            events.push(event());
        }
    }

    pub fn take(&mut self) -> Vec<ObservedEvent> {
        self.0.as_mut().map(std::mem::take).unwrap_or_default()
    }
}

/// Internal observer, called at every tick.
pub(crate) trait StepObserver<W>: State {
    /// Receives the world and the structure's events since the last call.
    fn observe(&mut self, world: &W, log: Vec<ObservedEvent>);
}

impl<W> StepObserver<W> for () {
    fn observe(&mut self, _world: &W, _log: Vec<ObservedEvent>) {}
}

/// Adapter from runs to an [`Observer`]. Tracks which blocks are within reach of faces, and bonds
/// of free blocks.
pub(crate) struct EventObservation<'o, O> {
    pub(super) observer: &'o mut O,
    /// Blocks within reach of a face: block, owner of the face, face, and tick of entry. Sorted.
    inside: Vec<(u32, Body, Face, u64)>,
    /// Bonds between free blocks, sorted.
    bonds: Vec<FreeBond>,
}

impl<'o, O: Observer> EventObservation<'o, O> {
    pub fn new(observer: &'o mut O) -> EventObservation<'o, O> {
        EventObservation {
            observer,
            inside: Vec::new(),
            bonds: Vec::new(),
        }
    }
}

impl<O: Observer> State for EventObservation<'_, O> {
    fn save(&self, to: &mut StateWriter<'_>) -> Result<(), StateError> {
        to.put(&self.inside)?;
        to.put(&self.bonds)?;
        self.observer.save(to)
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.inside = from.take()?;
        self.bonds = from.take()?;
        self.observer.restore(from)
    }
}

impl<A: SpatialWorld, O: Observer> StepObserver<A> for EventObservation<'_, O> {
    fn observe(&mut self, arena: &A, log: Vec<ObservedEvent>) {
        let mut inside: Vec<_> = (arena.in_reach().into_iter())
            .filter_map(|(block_face, body, entered)| {
                let (of, face) = in_structure(arena, block_face)?;
                Some((body, of, face, entered))
            })
            .collect();
        inside.sort_unstable();
        let was_captured = |id: u32| {
            (log.iter())
                .any(|event| matches!(event, ObservedEvent::Captured { body, .. } if *body == id))
        };
        // Events of the world in a step come before the structure's reactions.
        let mut events = Vec::with_capacity(log.len());
        for &(body, of, face, entered) in &self.inside {
            let stays = inside.binary_search(&(body, of, face, entered)).is_ok();
            if !stays && !was_captured(body) {
                events.push(ObservedEvent::Left { body, of, face });
            }
        }
        for &(body, of, face, entered) in &inside {
            if self
                .inside
                .binary_search(&(body, of, face, entered))
                .is_err()
            {
                events.push(ObservedEvent::Entered { body, of, face });
            }
        }
        let bonds = arena.free_bonds();
        events.extend(changes(&self.bonds, &bonds, arena));
        self.bonds = bonds;
        events.extend(log);
        self.inside = inside;
        self.observer.look(arena, &events);
    }
}

/// Returns the changes of bonds between free blocks: broken ones first, then new ones.
fn changes(before: &[FreeBond], now: &[FreeBond], arena: &impl SpatialWorld) -> Vec<ObservedEvent> {
    if before == now {
        return Vec::new();
    }
    let sizes: BTreeMap<u32, u32> = (arena.groups().into_iter())
        .flat_map(|group| {
            let size = group.len() as u32;
            group.into_iter().map(move |id| (id, size))
        })
        .collect();
    let size = |id: u32| sizes.get(&id).copied().unwrap_or(1);
    let missing_in = |other: &[FreeBond], bond: &FreeBond| other.binary_search(bond).is_err();
    let removed = before.iter().filter(|bond| missing_in(now, bond));
    let removed = removed.map(|&bond| ObservedEvent::Unbonded {
        bond,
        sizes: bond.bodies.map(size),
    });
    let new = now.iter().filter(|bond| missing_in(before, bond));
    let new = new.map(|&bond| ObservedEvent::Bonded {
        bond,
        size: size(bond.bodies[0]),
    });
    removed.chain(new).collect()
}
