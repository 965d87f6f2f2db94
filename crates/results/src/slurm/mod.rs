//! Sharded ensemble on a cluster with Slurm. One job array runs the missing shards, and a dependent
//! job merges them.
//!
//! | file | content |
//! |---|---|
//! | `slurm/shards.sh`, `slurm/merge.sh` | scripts of the jobs |
//! | `slurm/12_3.log` | output of task 3 of job array 12, if it failed |
//! | `slurm/merge_13.log` | output of merge job 13, if it failed |
//! | `slurm/.lock` | locked by the process that submits |
//!
//! The name of the jobs identifies the results folder. There is no list of submitted jobs: existing
//! shards and jobs that Slurm lists determine the shards to submit. This module reads and writes
//! text; the command starts processes.
mod array;
mod ensemble;
mod limits;
mod queue;
mod script;

pub use array::{indices, tasks};
pub use ensemble::{FoundShards, Opened, SlurmEnsemble};
pub use limits::SlurmLimits;
pub use queue::{FORMAT, Queue, SlurmJob, job_number};
pub use script::{merge_script, shards_script};
