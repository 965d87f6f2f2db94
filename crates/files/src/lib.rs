//! Reads regular files within size limits, and writes files atomically.
pub mod address;
pub mod atomic;
pub mod bound;
pub mod budget;
pub mod checksum;
pub mod csv;
pub mod disk;
pub mod process;
pub mod programs;
mod regular;
pub mod shell;

pub use disk::File;
pub(crate) use regular::read_stream;
pub use regular::{open, open_own, read, read_file};
