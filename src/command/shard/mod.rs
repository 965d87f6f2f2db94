//! `stochc shard`: ensembles that are split so that several machines can run them.
mod merge;
mod new;
mod run;
mod status;
mod submit;

use clap::{Args, Subcommand};

use crate::exit::{Exit, Failure};

/// Arguments of `shard`.
#[derive(Debug, Args)]
pub struct ShardArguments {
    #[command(subcommand)]
    command: ShardCommand,
}

/// The subcommands of `shard`.
#[derive(Debug, Subcommand)]
enum ShardCommand {
    /// Split an ensemble into shards
    New(Box<new::NewArguments>),
    /// Simulate the runs of one shard
    Run(run::RunArguments),
    /// List the shards of an ensemble and their states
    Status(status::StatusArguments),
    /// Merge the finished shards into one results folder
    Merge(merge::MergeArguments),
    /// Submit the missing shards to Slurm, with a job that merges them
    Submit(submit::SubmitArguments),
}

pub fn run(options: &ShardArguments) -> Result<Exit, Failure> {
    match &options.command {
        ShardCommand::New(options) => new::run(options),
        ShardCommand::Run(options) => run::run(options),
        ShardCommand::Status(options) => status::run(options),
        ShardCommand::Merge(options) => merge::run(options),
        ShardCommand::Submit(options) => submit::run(options),
    }
}
