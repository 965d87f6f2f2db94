//! One module for each subcommand.
pub mod check;
pub mod compile;
pub mod explain;
pub mod fmt;
pub mod lsp;
pub mod results;
pub mod simulate;
mod terminal;
