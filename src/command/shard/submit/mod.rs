//! `stochc shard submit`.
mod arguments;
mod jobs;
mod slurm;
mod submission;

pub use arguments::SubmitArguments;
pub use submission::run;
