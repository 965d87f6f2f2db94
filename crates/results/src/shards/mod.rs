//! An ensemble in pieces, which are made anywhere and put together again.
//!
//! | file | what |
//! |---|---|
//! | `shards.json` | into how many pieces it is cut |
//! | `shards/7.jsonl` | piece 7, whole: a line that says what it is, and one for each of its runs, in the order of the cut |
//! | `shards/7.part-*` | runs of piece 7 that a process has made which is under way, or was killed |
//! | `shards/7.draft-*` | piece 7 while it is written |
//!
//! Whoever makes a piece creates files of its own, gives the whole one its name, and locks nothing: of two who make the
//! same piece both write the same. [`merge`] makes the folder of an ensemble that was never cut, to the byte: its
//! journal is the lines of all pieces, one after the other, which is the order in which one thread makes them.
mod cut;
mod error;
mod merge;
mod piece;
mod status;

pub(crate) use cut::Cut;
pub use cut::{Prepared, prepare};
pub use error::ShardError;
pub use merge::merge;
pub use piece::Piece;
pub use status::{PieceState, ShardStatus, status};

pub(crate) use cut::same_build;
pub(crate) use status::health;

/// Pieces of an ensemble, at most: each is a file.
pub const MAX_SHARDS: u64 = 100_000;
