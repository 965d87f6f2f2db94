//! Model `shuffle`: no physics. Each tick, one random open face captures a block.
//!
//! Only the structure has a geometry. The model tests protocols under many orders of events; its
//! times are meaningless.
mod groups;
mod shuffle_world;
mod unplanned_faces;

pub use shuffle_world::ShuffleWorld;
