//! The page with its sections in reading order.
mod common;
mod completion;
mod document;
mod maps;
mod origin;
mod parts;
mod program;
mod summary;
mod sweeps;
mod trades;
mod warnings;

pub(super) use document::page;
pub(super) use parts::{Parts, detailed};
