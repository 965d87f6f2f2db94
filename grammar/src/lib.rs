//! Text to syntax tree, and back.
mod face;

pub use face::Face;
