//! Shards of an ensemble, which can be run anywhere and merged.
//!
//! | file | content |
//! |---|---|
//! | `shards.json` | split into shards |
//! | `shards/7.jsonl` | complete shard 7: a line that identifies it, and one for each of its runs in order |
//! | `shards/7.part-*` | runs of shard 7 by a process that is running or was killed |
//! | `shards/7.draft-*` | shard 7 while it is written |
//!
//! A process that runs a shard creates files of its own, renames the complete one, and locks
//! nothing. Two processes with the same shard write the same bytes. [`merge`] makes the folder of
//! an ensemble that was never split, byte for byte. Its journal has the lines of all shards in
//! order, which is the order of a single thread.
mod cut;
mod error;
mod merge;
mod shard;
mod status;

pub(crate) use cut::Cut;
pub use cut::{Prepared, prepare};
pub use error::ShardError;
pub use merge::merge;
pub use shard::Shard;
pub use status::{ShardState, ShardStatus, status};

pub(crate) use cut::same_build;
pub(crate) use status::health;

/// Largest number of shards. Each is a file.
pub const MAX_SHARDS: u64 = 100_000;
