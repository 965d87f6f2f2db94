//! Looking on while a run goes: where every block is, and what the structure does.
use std::collections::BTreeMap;

use stochc_ir::state::{State, StateError, StateReader, StateWriter};
use stochc_ir::table::{News, PhaseId, RoleId};
use stochc_ir::{Cell, Face};
use stochc_protocol::{Body, Payload};

use crate::world::view::in_structure;
use crate::world::{Arena, FreeBond};

/// Looks on while a run goes. It cannot change anything.
pub trait Observer {
    /// Called once for every tick, the first and the last included, when all that the tick brings
    /// has been done.
    ///
    /// `arena` is at that [tick](crate::world::World::tick); `events` are what happened since the
    /// last call, in their order: all of them at that tick.
    fn look(&mut self, arena: &impl Arena, events: &[ObservedEvent]);

    /// Writes down how far it is, for [`Observer::restore`]: see [`State::save`].
    ///
    /// # Errors
    /// Those of [`State::save`].
    fn save(&self, to: &mut StateWriter<'_>) -> Result<(), StateError> {
        State::save(&Unknown, to)
    }

    /// Goes on from there.
    ///
    /// # Errors
    /// Those of [`State::restore`].
    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        State::restore(&mut Unknown, from)
    }
}

/// Somebody who does not say how far it is.
struct Unknown;

impl State for Unknown {}

/// What happens in a structure. Faces are in the structure's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObservedEvent {
    /// A phase begins.
    Phase(PhaseId),
    /// A block switches a face on.
    Magnetized {
        /// Whose face.
        body: Body,
        /// Its role.
        by: RoleId,
        /// Which face.
        face: Face,
        /// The role for the block that docks there.
        child: RoleId,
        /// Where that block will sit.
        cell: Cell,
    },
    /// A free block comes into the reach of a face that is on.
    Entered {
        /// The number of the free block.
        body: u32,
        /// Whose face.
        of: Body,
        /// Which face.
        face: Face,
    },
    /// A free block leaves the reach of a face, or the face is switched off or takes another block.
    Left {
        /// The number of the free block.
        body: u32,
        /// Whose face.
        of: Body,
        /// Which face.
        face: Face,
    },
    /// A block is anchored.
    Captured {
        /// The number of the block.
        body: u32,
        /// The block that holds it now.
        on: Body,
        /// By which face.
        face: Face,
        /// The role that it takes.
        role: RoleId,
        /// Where it sits.
        cell: Cell,
    },
    /// A block has docked where none is expected, and is rejected at once.
    Unplanned {
        /// The number of the block.
        body: u32,
        /// The block on which it docked.
        on: Body,
        /// On which face.
        face: Face,
        /// The role of that block.
        by: RoleId,
    },
    /// Two free blocks bond.
    Bonded {
        /// Which, and by which faces.
        bond: FreeBond,
        /// The blocks of their group, as of the end of the tick.
        size: u32,
    },
    /// A bond between two free blocks is torn, or a structure takes one of them.
    Unbonded {
        /// Between whom it was, and by which faces.
        bond: FreeBond,
        /// The blocks of the group of each, as of the end of the tick; 1: it is alone, or anchored.
        sizes: [u32; 2],
    },
    /// A block is let go, and with it the faces that it had on.
    Released {
        /// The number of the block.
        body: u32,
        /// The role that it had.
        role: RoleId,
        /// The role that let it go.
        by: RoleId,
    },
    /// A message goes from a block to a neighbour; sent again, it goes again.
    Sent {
        /// From.
        from: Body,
        /// To.
        to: Body,
        /// What it says.
        said: MessageContent,
    },
    /// The plate counts a report.
    Reported {
        /// The role that made it.
        by: RoleId,
    },
}

/// What a message says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageContent {
    /// A branch of the phase is done, reports the block in this role.
    Report(RoleId),
    /// The block in this role asks its parent to be let go.
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

/// Where the control writes down what happens; `None`: nobody looks on.
#[derive(Debug, Default)]
pub(crate) struct Log(Option<Vec<ObservedEvent>>);

impl Log {
    /// A log that somebody reads.
    pub fn kept() -> Log {
        Log(Some(Vec::new()))
    }

    /// Whether somebody reads it.
    pub fn is_kept(&self) -> bool {
        self.0.is_some()
    }

    /// Writes an event down.
    pub fn note(&mut self, event: impl FnOnce() -> ObservedEvent) {
        if let Some(events) = &mut self.0 {
            events.push(event());
        }
    }

    /// Takes out all that has been written down.
    pub fn take(&mut self) -> Vec<ObservedEvent> {
        self.0.as_mut().map(std::mem::take).unwrap_or_default()
    }
}

/// Is shown a run, tick by tick.
pub(crate) trait StepObserver<W>: State {
    /// `log` is what the structure has done since the last time.
    fn observe(&mut self, world: &W, log: Vec<ObservedEvent>);
}

/// Nobody looks on.
impl<W> StepObserver<W> for () {
    fn observe(&mut self, _world: &W, _log: Vec<ObservedEvent>) {}
}

/// Shows an [`Observer`] a run, and keeps in mind who is in the reach of which face, and who is bonded to whom.
pub(crate) struct EventObservation<'o, O> {
    observer: &'o mut O,
    /// The block, the face's owner, the face, and the tick of the entry; sorted.
    inside: Vec<(u32, Body, Face, u64)>,
    /// Sorted.
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
        // What the world did in the step comes before what the structure made of it.
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

/// What has become of the bonds between free blocks: first those that are gone, then those that are new.
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
