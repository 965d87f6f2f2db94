//! Syntax tree to dependency graph, proofs and event tables. Pure: no IO, clock or chance.
mod cell;
pub mod scene;
pub mod table;

pub use cell::Cell;
pub use stochc_grammar::Face;
