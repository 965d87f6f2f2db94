//! The distributed control of a structure, without physics, time or chance.
//!
//! Every anchored block runs its own part of the event tables. It sees only itself: what docked on its
//! faces and what it was told. What crosses from one block to another crosses as a message, hop by hop
//! along parents and children. A [`Structure`] is the machine of all blocks together, a plain value, and an
//! [`Environment`] is what it asks of whoever drives it: the runtime by the clock of a world, [`explore`]
//! in every order of events.
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

/// A digest of this crate's sources: two builds with one digest compute the same.
pub const SOURCES: &str = env!("STOCHC_SOURCES");
