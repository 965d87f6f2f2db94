//! One module for each subcommand.
pub mod check;
mod chosen;
pub mod compile;
pub mod completions;
pub mod explain;
pub mod export;
pub mod fmt;
pub mod levels;
pub mod lsp;
pub mod man;
pub mod replay;
pub mod report;
pub mod results;
pub mod simulate;
mod terminal;
pub mod trade;
mod unresolved;
