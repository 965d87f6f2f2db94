//! Work of each command for any [`Host`](crate::host::Host): programs, ensembles, shards, pages.
//!
//! The command line and the Python package call these functions with the same options. The
//! resulting folders are identical.
pub mod calibration;
pub mod chosen_run;
pub mod claims;
pub mod codes;
pub mod ensemble;
pub mod estimate;
pub mod export;
pub mod fit;
pub mod forecast;
pub mod import;
mod in_memory;
pub mod jani;
pub mod json;
pub mod optimize;
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
pub mod stored_source;
pub mod summary;
pub mod sweep;
pub mod trade;
mod watch;

pub use stochc_text::duration as time;
