//! One module for each subcommand.
pub mod check;
pub mod compile;
pub mod explain;
mod terminal;

pub use terminal::{print, warn};
