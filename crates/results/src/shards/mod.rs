//! Shards of an ensemble, which can be run anywhere and merged.
//!
//! | file | content |
//! |---|---|
//! | `shards.json` | split into shards |
//! | `shards/7.jsonl` | complete shard 7: a line that identifies it, then a line for each run, in order |
//! | `shards/7.part-*` | runs of shard 7, by a process that is running or was killed |
//! | `shards/7.draft-*` | shard 7 while it is written |
//!
//! A process that runs a shard writes its own file and renames it when it is complete. It locks
//! nothing. Two processes with the same shard write the same bytes. The result of [`merge`] is the
//! same, byte for byte, as for an ensemble that was never split. Its journal has the lines of all
//! shards in order, as a single thread would write them.
mod error;
mod merge;
mod shard;
mod split;
mod status;

pub use error::ShardError;
pub use merge::merge;
pub use shard::Shard;
pub(crate) use split::Split;
pub use split::{Prepared, prepare};
pub use status::{ShardState, ShardStatus, status};

pub(crate) use split::same_build;
pub(crate) use status::health;

/// Largest number of shards. Each shard is a file.
pub const MAX_SHARDS: u64 = 100_000;
