//! Model `shuffle`: no physics. Each tick, one random open face captures a block.
//!
//! It has the geometry of the structure only. It tests protocols under many orders of events; its
//! times are meaningless.
mod groups;
mod shuffle_world;
mod unplanned_faces;

pub use shuffle_world::ShuffleWorld;
