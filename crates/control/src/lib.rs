//! Distributed control of a structure, without physics, time or chance.
//!
//! Every anchored block executes its own part of the event tables. A block sees only its own faces
//! and its messages. Messages travel hop by hop along parents and children. A [`Structure`] is the
//! state machine of all blocks together, a plain value. An [`Environment`] carries out its
//! decisions: the runtime by the clock of a world, [`explore`] in every order of events.
mod body;
mod channel;
pub mod explore;
mod lattice;
mod machine;
mod orientation;

pub use body::{BlockFace, Body, Docking};
pub use channel::Channels;
pub use lattice::{Lattice, LatticePose};
pub use machine::{
    ActiveFace, Environment, Message, Payload, PlannedCapture, Recalled, Recipient, Reporter,
    Structure, StructureBlock,
};
pub use orientation::Orientation;

/// Digest of this crate's sources. Two builds with equal digests compute equal results.
pub const SOURCES: &str = env!("STOCHC_SOURCES");
