//! Observation of a running simulation: block positions and the structure's events.
mod rows;

use std::collections::BTreeMap;

use stochc_control::{Body, Payload};
use stochc_ir::state::{State, StateError, StateReader, StateWriter};
use stochc_ir::table::{News, PhaseId, RoleId};
use stochc_ir::{Cell, Face};

pub use rows::{EventRows, TimedEvent};

use crate::world::view::in_structure;
use crate::world::{Arena, FreeBond};

/// Observer of a run. It cannot change the run.
pub trait Observer {
    /// Receives the state of every tick, including the first and the last, after all its events.
    ///
    /// `arena` is at that [tick](crate::world::World::tick). `events` are the events since the last
    /// call, in order, all at that tick.
    fn look(&mut self, arena: &impl Arena, events: &[ObservedEvent]);

    /// Writes the state of the observer for [`Observer::restore`]. See [`State::save`].
    ///
    /// # Errors
    ///
    /// The errors of [`State::save`].
    fn save(&self, to: &mut StateWriter<'_>) -> Result<(), StateError> {
        State::save(&Unknown, to)
    }

    /// Restores the state of the observer.
    ///
    /// # Errors
    ///
    /// The errors of [`State::restore`].
    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        State::restore(&mut Unknown, from)
    }
}

/// State of an observer that does not support checkpoints.
struct Unknown;

impl State for Unknown {}

/// Event in a structure. Faces are in the structure's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObservedEvent {
    /// A phase begins.
    Phase(PhaseId),
    /// A block switches a face on.
    Magnetized {
        /// Block that owns the face.
        body: Body,
        /// Role of the block.
        by: RoleId,
        /// Face that is switched on.
        face: Face,
        /// Role of the block to be captured.
        child: RoleId,
        /// Cell of the block to be captured.
        cell: Cell,
    },
    /// A free block comes within the reach of an open face.
    Entered {
        /// The number of the free block.
        body: u32,
        /// Block that owns the face.
        of: Body,
        /// The face.
        face: Face,
    },
    /// A free block leaves the reach of a face, or the face is switched off or captures another
    /// block.
    Left {
        /// The number of the free block.
        body: u32,
        /// Block that owns the face.
        of: Body,
        /// The face.
        face: Face,
    },
    /// A block is captured.
    Captured {
        /// The number of the block.
        body: u32,
        /// New parent of the block.
        on: Body,
        /// Face of the parent.
        face: Face,
        /// Role of the captured block.
        role: RoleId,
        /// Cell of the captured block.
        cell: Cell,
    },
    /// A block is captured at a face that expects none, and is rejected at once.
    Unplanned {
        /// The number of the block.
        body: u32,
        /// Capturing block.
        on: Body,
        /// Capturing face.
        face: Face,
        /// Role of the block that captured it.
        by: RoleId,
    },
    /// Two free blocks bond.
    Bonded {
        /// The bond, with both faces.
        bond: FreeBond,
        /// Number of blocks in their group at the end of the tick.
        size: u32,
    },
    /// A bond between two free blocks breaks, or the structure captures one of them.
    Unbonded {
        /// The bond, with both faces.
        bond: FreeBond,
        /// Number of blocks in the group of each at the end of the tick. 1 if it is alone or
        /// anchored.
        sizes: [u32; 2],
    },
    /// A block is released, and its open faces are switched off.
    Released {
        /// The number of the block.
        body: u32,
        /// Former role of the block.
        role: RoleId,
        /// Role of the block that released it.
        by: RoleId,
    },
    /// A message is sent to a neighbour. Resent messages count again.
    Sent {
        /// Sender of the message.
        from: Body,
        /// Receiver of the message.
        to: Body,
        /// Content of the message.
        said: MessageContent,
    },
    /// The plate counts a report.
    Reported {
        /// Role that sent the report.
        by: RoleId,
    },
}

/// Content of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageContent {
    /// Report: a branch of the phase is complete.
    Report(RoleId),
    /// Request: the block in this role asks its parent for release.
    Ask(RoleId),
    /// A block has been anchored in this role.
    Anchored(RoleId),
    /// The block in this role has been released.
    Released(RoleId),
}

impl From<Payload> for MessageContent {
    fn from(payload: Payload) -> MessageContent {
        match payload {
            Payload::Report(by) => MessageContent::Report(by.role),
            Payload::Ask(role) => MessageContent::Ask(role),
            Payload::Tell(News::Anchored(role)) => MessageContent::Anchored(role),
            Payload::Tell(News::Released(role)) => MessageContent::Released(role),
        }
    }
}

/// Log of events. `None` if there is no observer.
#[derive(Debug, Default)]
pub(crate) struct Log(Option<Vec<ObservedEvent>>);

impl Log {
    /// Returns an empty log that records events.
    pub fn kept() -> Log {
        Log(Some(Vec::new()))
    }

    /// Returns whether events are recorded.
    pub fn is_kept(&self) -> bool {
        self.0.is_some()
    }

    /// Records an event.
    pub fn note(&mut self, event: impl FnOnce() -> ObservedEvent) {
        if let Some(events) = &mut self.0 {
            events.push(event());
        }
    }

    /// Returns and removes all recorded events.
    pub fn take(&mut self) -> Vec<ObservedEvent> {
        self.0.as_mut().map(std::mem::take).unwrap_or_default()
    }
}

/// Internal observer, called at every tick.
pub(crate) trait StepObserver<W>: State {
    /// Receives the world and the structure's events since the last call.
    fn observe(&mut self, world: &W, log: Vec<ObservedEvent>);
}

/// Observer that does nothing.
impl<W> StepObserver<W> for () {
    fn observe(&mut self, _world: &W, _log: Vec<ObservedEvent>) {}
}

/// Adapter from runs to an [`Observer`]. Tracks which blocks are within reach of faces, and bonds
/// of free blocks.
pub(crate) struct EventObservation<'o, O> {
    observer: &'o mut O,
    /// Block, owner of the face, face and tick of entry, sorted.
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

impl<A: Arena, O: Observer> StepObserver<A> for EventObservation<'_, O> {
    fn observe(&mut self, arena: &A, log: Vec<ObservedEvent>) {
        let mut inside: Vec<_> = (arena.in_reach().into_iter())
            .filter_map(|(site, body, entered)| {
                let (of, face) = in_structure(arena, site)?;
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
fn changes(before: &[FreeBond], now: &[FreeBond], arena: &impl Arena) -> Vec<ObservedEvent> {
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
    let gone = before.iter().filter(|bond| missing_in(now, bond));
    let gone = gone.map(|&bond| ObservedEvent::Unbonded {
        bond,
        sizes: bond.bodies.map(size),
    });
    let new = now.iter().filter(|bond| missing_in(before, bond));
    let new = new.map(|&bond| ObservedEvent::Bonded {
        bond,
        size: size(bond.bodies[0]),
    });
    gone.chain(new).collect()
}
