//! Maps of the positions of blocks over all runs of a program: before their capture, close to the
//! structure, and at open faces.
//!
//! All values are ratios of sums over runs, by cell of the lattice. Their intervals come from a
//! bootstrap over runs.
mod collection;
mod places;
mod slice;
mod structure_membership;
mod tally;

pub(crate) use self::structure_membership::AGES;
pub use collection::RecordingReader;
pub(crate) use collection::maps;
pub(crate) use slice::{Maps, Slice, SliceMap};
