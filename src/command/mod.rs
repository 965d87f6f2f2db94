//! One module for each subcommand.
pub mod check;
pub mod compile;
mod exhaustive;
pub mod explain;
pub mod results;
pub mod simulate;
mod terminal;
