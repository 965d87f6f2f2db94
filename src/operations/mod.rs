//! What commands do, for any [`Host`](crate::host::Host): programs of files, ensembles, pieces, pages.
//!
//! The command line reads options and prints; other programs give the same values and get the same folders, byte for byte.
pub mod chosen_run;
pub mod codes;
pub mod ensemble;
pub mod estimate;
pub mod export;
pub mod fit;
pub mod forecast;
mod in_memory;
pub mod json;
pub mod kept_text;
pub mod plan;
pub mod precision;
pub mod programs;
pub mod rates;
mod recordings;
pub mod replay;
pub mod report;
pub mod results;
pub mod runs;
pub mod shard;
pub mod summary;
pub mod sweep;
pub mod trade;
mod watch;

pub use stochc_text::duration as time;
