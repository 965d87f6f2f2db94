//! State machine of all blocks together.
mod block;
mod block_slot;
mod environment;
mod index;
mod inline_vec;
mod message;
mod retreat;
mod routing;
mod slots;
mod structure;

pub use block::{ActiveFace, StructureBlock};
pub use environment::{Environment, PlannedCapture, Recalled};
pub use message::{Message, Payload, Recipient, Reporter};
pub use structure::Structure;
