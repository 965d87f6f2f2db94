//! One module for each subcommand.
pub mod check;
pub mod compile;
pub mod explain;
pub mod levels;
pub mod results;
pub mod simulate;
mod terminal;
